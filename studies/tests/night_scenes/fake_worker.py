# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Stands in for night_scenes.worker: writes tiny EXR files, or fails as it is told.

FAKE_WORKER: "good"; "fails N": frame N is an error; "dies N": the process ends there;
"short N": that file lacks its end; "waits": one frame, then it hangs in a part;
"garbles N": no JSON for frame N; "starts not": as where bpy is missing."""

import json
import os
import struct
import sys
import time


def tiny_exr(width, height):
    """Return the bytes of a black half float EXR of one channel, not compressed."""

    def attribute(name, kind, value):
        return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2)
    header += attribute(
        "channels", "chlist", b"Y\0" + struct.pack("<4i", 1, 0, 1, 1) + b"\0"
    )
    header += attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window)
    header += attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    size = 2 * width
    start = len(header) + 8 * height
    table = [start + y * (8 + size) for y in range(height)]
    lines = [struct.pack("<ii", y, size) + bytes(size) for y in range(height)]
    return header + struct.pack(f"<{height}Q", *table) + b"".join(lines)


def main():
    """Answer requests as night_scenes.worker does."""
    mode, _, number = os.environ.get("FAKE_WORKER", "good").rpartition(" ")
    mode = mode or number
    if (mode, number) == ("starts", "not"):
        print(json.dumps({"index": None, "error": "No module named 'bpy'"}))
        return
    for count, line in enumerate(sys.stdin):
        asked = json.loads(line)
        is_the_one = number == str(asked["index"])
        if mode == "dies" and is_the_one:
            sys.exit(7)
        if mode == "garbles" and is_the_one:
            print("Blender says hello", flush=True)
            continue
        data = tiny_exr(asked["width"], round(asked["width"] * 9 / 16))
        waits = mode == "waits" and count == 1
        if waits or (mode == "short" and is_the_one):
            data = data[:-5]
        with open(asked["path"], "wb") as file:
            file.write(data)
        if waits:
            time.sleep(600)
        error = "Error: planted" if mode == "fails" and is_the_one else None
        answer = {"index": asked["index"], "error": error, "seconds": 0.1}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
