# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Use the installed cg2raw as a newcomer would, with the OpenImageIO wheel beside it.

    python scripts/wheel_check.py [SECOND_OIIOTOOL]

Writes one DNG by cg2raw.write_dng, by OpenImageIO's ImageBuf, and by the oiiotool of
this Python (and a second one, if given); reads them by rawpy; and exits with 1 unless
all of them hold the same pixels. Run it by the Python that the wheel is installed in;
cibuildwheel and tests/packaging do.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO
import rawpy

import cg2raw

SIZE = (64, 96)
SENSOR, LIGHT, ISO, SEED = "samsung-s20fe", "D65", 800, 7
OIIOTOOL = Path(sys.executable).parent / "oiiotool"
COMMAND = Path(sys.executable).parent / "cg2raw"


def main():
    """Write, read and compare; print what was found."""
    print(f"cg2raw {cg2raw.__version__} in {Path(cg2raw.__file__).parent}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        rgb = np.random.default_rng(1).random((*SIZE, 3), np.float32)
        frame = cg2raw.Sensor(SENSOR).simulate(
            rgb, illuminant=LIGHT, iso=ISO, seed=SEED
        )
        cg2raw.write_dng("python.dng", frame)
        expected = read("python.dng")
        write_by_openimageio(rgb)
        found = {"ImageBuf.write": read("imagebuf.dng")}
        for tool in [str(OIIOTOOL), *sys.argv[1:]]:
            found[tool] = write_by_oiiotool(tool)
    for writer, raw in found.items():
        same = raw.shape == SIZE and np.array_equal(raw, expected)
        print(f"{writer}: {'the same pixels' if same else 'OTHER PIXELS'}")
        if not same:
            sys.exit(1)


def read(path):
    """Return the mosaic (height, width) uint16 that LibRaw reads of a DNG."""
    with rawpy.imread(path) as raw:
        return raw.raw_image.copy()


def write_by_openimageio(rgb):
    """Write imagebuf.dng, and scene.exr for oiiotool."""
    print(f"OpenImageIO {OpenImageIO.VERSION_STRING}:", cg2raw.register_oiio_plugin())
    image = OpenImageIO.ImageBuf(rgb)
    if not image.write("scene.exr", "float"):
        sys.exit(image.geterror())
    attributes = {"sensor": SENSOR, "illuminant": LIGHT, "iso": ISO, "seed": SEED}
    for name, value in attributes.items():
        image.specmod().attribute(f"dng:{name}", value)
    if not image.write("imagebuf.dng"):
        sys.exit(image.geterror() or OpenImageIO.geterror())


def write_by_oiiotool(tool):
    """Return the mosaic of the DNG that @tool writes with what `cg2raw env` prints."""
    script = (
        f'eval "$({COMMAND} env)" && {tool} scene.exr --attrib dng:sensor {SENSOR} '
        f"--attrib dng:illuminant {LIGHT} --attrib dng:iso {ISO} "
        f"--attrib dng:seed {SEED} -o tool.dng"
    )
    done = subprocess.run(["sh", "-c", script], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{tool}: {done.stdout}{done.stderr}")
    raw = read("tool.dng")
    os.remove("tool.dng")
    return raw


if __name__ == "__main__":
    main()
