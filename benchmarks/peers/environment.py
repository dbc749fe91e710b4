"""The environment of the peers, created once beside the benchmarks from the package index.

It also contains reelay's C++ monitor, built from the headers of its source package. Building needs
g++ and Boost's headers (apt-get install g++ libboost-dev).
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
HOME = HERE.parent / ".env"
REQUIREMENTS = HERE / "requirements.txt"
SOURCE = HERE / "reelay_native"
BINARY = HOME / "reelay_native"
LETTERS = "pqrs"
"""The columns that the C++ monitor supports."""


@dataclass(frozen=True, slots=True)
class Environment:
    """The peers that were installed, and those that were not."""

    python: Path  # the interpreter of the environment
    versions: dict[str, str]  # of each package that installed, by name
    missing: dict[str, str]  # for each package that did not install, the reason in one line
    reelay: Path | None = None  # the C++ monitor; `None`: see `missing`


def prepare() -> Environment:
    """Create the environment if it is missing or the pins have changed; return its content."""
    stamp = HOME / "peers.json"
    pins = [line for line in REQUIREMENTS.read_text().splitlines() if line and line[0] != "#"]
    python = HOME / "bin" / "python"
    found = json.loads(stamp.read_text()) if stamp.exists() else {}
    if found.get("pins") != pins:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", str(HOME)], check=True)
        found = {"pins": pins, "versions": {}, "missing": {}}
        for pin in pins:
            name, _, wanted = pin.partition("==")
            reason = _install(python, pin)
            found["missing" if reason else "versions"][name] = reason or wanted
        stamp.write_text(json.dumps(found))
    versions, missing = found["versions"], found["missing"]
    reason = _build_reelay(python, versions.get("reelay", ""))
    if reason:
        missing["reelay C++"] = reason
    return Environment(python, versions, missing, None if reason else BINARY)


def _install(python: Path, pin: str) -> str:
    """Install a package; return the error, or an empty text."""
    command = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", pin]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
    return (errors or done.stderr.splitlines() or ["pip failed"])[-1] if done.returncode else ""


def _build_reelay(python: Path, version: str) -> str:
    """Build reelay's C++ monitor if needed; return the error, or an empty text."""
    source = SOURCE / "monitor.cpp"
    if BINARY.exists() and BINARY.stat().st_mtime > source.stat().st_mtime:
        return ""
    if shutil.which("g++") is None:
        return "no g++"
    with tempfile.TemporaryDirectory(dir=HOME) as folder:
        # pip unpacks the source package before it finds that it cannot build it.
        command = [str(python), "-m", "pip", "download", "--quiet", "--no-clean", "--no-deps"]
        command += ["--no-build-isolation", "--no-binary", "reelay", f"reelay=={version}"]
        where = {**os.environ, "TMPDIR": folder}
        subprocess.run(command, cwd=folder, env=where, capture_output=True, check=False)
        include = next(Path(folder).glob("pip-download-*/reelay_*/include"), None)
        if include is None:
            return "the source package of reelay cannot be fetched"
        command = ["g++", "-O3", "-march=native", "-DNDEBUG", "-std=c++17", "-w"]
        command += ["-I", str(SOURCE), "-I", str(include), str(source), "-o", str(BINARY)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    errors = [line for line in done.stderr.splitlines() if "error" in line] or ["g++ failed"]
    # Drop the path of the temporary folder.
    return errors[0].rpartition("fatal error: ")[2] if done.returncode else ""


def packed(columns: Mapping[str, Sequence[bool | float]]) -> bytes:
    """Rows for the C++ monitor, one byte each: bit i is the column of `LETTERS[i]`."""
    bits = [np.array(one, np.uint8) << LETTERS.index(name) for name, one in columns.items()]
    found: bytes = np.bitwise_or.reduce(bits).tobytes()
    return found
