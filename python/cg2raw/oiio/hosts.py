# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Every OpenImageIO on this machine: each oiiotool, each Python that can import it."""

import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from cg2raw.interrupts import scratch_folder
from cg2raw.oiio.plugin_file import plugin_api_of, version_of

SECONDS = 60  # patience with any program that is asked
# Environment variables with plugin folders, in the order of the search. Measured on
# 2.4.7 and 3.2.2: 2.x has no OPENIMAGEIO_PLUGIN_PATH, 3.x prefers the obsolete name.
SEARCH_2 = ("OIIO_LIBRARY_PATH", "LD_LIBRARY_PATH")
SEARCH_3 = ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH")

ASK_PYTHON = "import OpenImageIO as o; print(o.VERSION_STRING)"
WRITE_WITH_PYTHON = """
import sys, OpenImageIO as o
image = o.ImageBuf(o.ImageSpec(16, 16, 3, "float"))
o.ImageBufAlgo.fill(image, (0.2, 0.4, 0.6))
image.specmod().attribute("dng:sensor", sys.argv[2])
image.specmod().attribute("dng:illuminant", "D65")
if not image.write(sys.argv[1]):
    sys.exit(image.geterror() or o.geterror())
"""
READ_WITH_PYTHON = """
import sys, OpenImageIO as o
image = o.ImageInput.open(sys.argv[1])
print(image.format_name() if image else "none")
"""


@dataclass
class Host:
    """One OpenImageIO that may load the plugin."""

    kind: str  # "oiiotool" or "python"
    path: str
    version: str
    search: list[tuple[str, str]] = field(
        init=False
    )  # (variable, folder) in the order of the search

    def __post_init__(self) -> None:
        names = SEARCH_2 if version_of(self.version) < (2, 6) else SEARCH_3
        self.search = [
            (name, folder)
            for name in names
            for folder in os.environ.get(name, "").split(":")
            if folder
        ]

    @property
    def variable(self) -> str:
        """Return the environment variable by which this OpenImageIO should be told."""
        return "OIIO_LIBRARY_PATH" if version_of(self.version) < (2, 6) else SEARCH_3[1]

    @property
    def plugin_api(self) -> int | None:
        """Return the plugin API that this OpenImageIO accepts, None if not known."""
        return plugin_api_of(self.version)

    def write_command(self, target: str, sensor: str) -> list[str]:
        """Return the command by which this host writes a 16x16 DNG."""
        if self.kind == "python":
            return [self.path, "-c", WRITE_WITH_PYTHON, target, sensor]
        return [
            self.path,
            "--pattern",
            "constant:color=0.2,0.4,0.6",
            "16x16",
            "3",
            "--attrib",
            "dng:sensor",
            sensor,
            "--attrib",
            "dng:illuminant",
            "D65",
            "-o",
            target,
        ]

    def read_command(self, source: str) -> list[str]:
        """Return the command whose last word is the format that reads @source."""
        if self.kind == "python":
            return [self.path, "-c", READ_WITH_PYTHON, source]
        return [self.path, "--info", source]


def programs(name: str) -> list[str]:
    """Return each executable @name beside this interpreter, on PATH and in /usr/bin."""
    folders = [os.path.dirname(sys.executable), *os.get_exec_path(), "/usr/bin"]
    # The folder is resolved, the program not: .venv/bin/python is not /usr/bin/python3.
    paths = [os.path.join(os.path.realpath(folder), name) for folder in folders]
    return [path for path in dict.fromkeys(paths) if os.access(path, os.X_OK)]


def ask(
    command: list[str], **environment: str
) -> subprocess.CompletedProcess[str] | None:
    """Run @command; return the finished process, None if it cannot run or hangs."""
    try:
        return subprocess.run(
            command,
            capture_output=True,
            timeout=SECONDS,
            text=True,
            errors="replace",
            stdin=subprocess.DEVNULL,
            env={**os.environ, **environment},
        )
    except (OSError, subprocess.TimeoutExpired):
        return None


def find_hosts() -> list[Host]:
    """Return all Hosts of this machine."""
    tools, pythons = programs("oiiotool"), programs("python3")
    questions = [("oiiotool", path, [path, "--version"]) for path in tools]
    questions += [("python", path, [path, "-c", ASK_PYTHON]) for path in pythons]
    hosts = []
    for kind, path, command in questions:
        answer = ask(command)
        version = answer and re.match(r"(?:OpenImageIO )?([\d.]+)", answer.stdout)
        if answer and answer.returncode == 0 and version:
            hosts.append(Host(kind, path, version[1]))
    return hosts


@dataclass
class Trial:
    """What came of writing a 16x16 DNG."""

    wrote: bool
    message: str  # of the host, when it did not
    loader: str  # what the dynamic loader reported (glibc's LD_DEBUG=files)


def try_to_write(host: Host, sensor: str) -> Trial:
    """Let @host write a DNG into a temporary folder; return the Trial."""
    with scratch_folder("cg2raw-doctor-") as folder:
        target = Path(folder, "trial.dng")
        done = ask(
            host.write_command(str(target), sensor),
            LD_DEBUG="files",
            LD_DEBUG_OUTPUT=str(Path(folder, "loader")),
        )
        wrote = target.is_file() and target.read_bytes()[:4] in (b"II*\0", b"MM\0*")
        loader = "".join(
            path.read_text(errors="replace")
            for path in sorted(Path(folder).glob("loader*"))
        )
    if done is None:
        return Trial(False, f"does not run, or not within {SECONDS} s", loader)
    lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
    # oiiotool repeats the command line after its message.
    lines = (
        lines[: lines.index("Full command line was:")]
        if ("Full command line was:" in lines)
        else lines
    )
    message = " ".join(lines) or "said nothing, but what it wrote is no DNG"
    return Trial(wrote and done.returncode == 0, message, loader)


def reader_of(host: Host, source: str) -> str:
    """Return the name of the format by which @host reads the file @source; empty if it
    reads it not at all."""
    done = ask(host.read_command(source))
    words = done.stdout.split() if done and done.returncode == 0 else []
    return "" if not words or words[-1] == "none" else words[-1]
