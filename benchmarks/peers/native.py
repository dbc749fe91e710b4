"""reelay's C++ monitor without Python, built from the headers of its source package.

Needs g++ and Boost's headers (apt-get install g++ libboost-dev). Where something is missing there
is no native reelay, with the reason.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.peers.environment import HOME, Environment

SOURCE = Path(__file__).with_name("reelay_native")
BINARY = HOME / "reelay_native"
LETTERS = "pqrs"


@dataclass(frozen=True, slots=True)
class Native:
    """The binary, or why there is none."""

    binary: Path | None
    reason: str = ""


def build(environment: Environment) -> Native:
    """Build the binary unless it is there."""
    source = SOURCE / "monitor.cpp"
    if BINARY.exists() and BINARY.stat().st_mtime > source.stat().st_mtime:
        return Native(BINARY)
    if shutil.which("g++") is None:
        return Native(None, "no g++")
    with tempfile.TemporaryDirectory(dir=HOME) as folder:
        include = _headers(environment, Path(folder))
        if include is None:
            return Native(None, "the source package of reelay cannot be fetched")
        command = ["g++", "-O3", "-march=native", "-DNDEBUG", "-std=c++17", "-w"]
        command += ["-I", str(SOURCE), "-I", str(include), str(source), "-o", str(BINARY)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        errors = [line for line in done.stderr.splitlines() if "error" in line]
        # Without the place where it was unpacked.
        return Native(None, (errors or ["g++ failed"])[0].rpartition("fatal error: ")[2])
    return Native(BINARY)


def _headers(environment: Environment, folder: Path) -> Path | None:
    """Unpack the source package; pip does so before it finds that it cannot build it."""
    pin = f"reelay=={environment.versions.get('reelay', '')}"
    command = [str(environment.python), "-m", "pip", "download", "--quiet", "--no-clean"]
    command += ["--no-deps", "--no-build-isolation", "--no-binary", "reelay", pin]
    where = {**os.environ, "TMPDIR": str(folder)}
    subprocess.run(command, cwd=folder, env=where, capture_output=True, check=False)
    return next(iter(folder.glob("pip-download-*/reelay_*/include")), None)


def packed(columns: Mapping[str, Sequence[bool | float]]) -> bytes:
    """One byte per row: bit i is the column of `LETTERS[i]`."""
    rows = bytearray(len(next(iter(columns.values()))))
    for name, column in columns.items():
        bit = 1 << LETTERS.index(name)
        for row, value in enumerate(column):
            if value:
                rows[row] |= bit
    return bytes(rows)
