"""Build wheel and sdist into `dist`, check them, and install and import each extra by itself.

The package `ziglang` compiles the native core for the systems of `TARGETS`; it is not run there.

    python .ci/release.py [--only EXTRA …] [--no-pythons]

Prints the disk space and the import time of each installation, and what was not tried. Uploads
nothing. The exit code is 1 if anything failed.
"""

from __future__ import annotations

import argparse
import platform
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from rvmon.native import sources as core_sources

ROOT = Path(__file__).parents[1]
DIST = ROOT / "dist"
PYTHONS = ("3.11", "3.12", "3.13")
DOORS = {
    "": "rvmon rvmon.core rvmon.cli rvmon.live rvmon.testing.oracle",
    "cdv": "rvmon.cdv coverage",
    "handover": "handover.cli handover.driver pymunk",
    "arrow": "rvmon.recordings.parquet pyarrow.parquet",
    "ros": "rvmon.recordings.messages.ros rosbags.highlevel",
    "mcap": "rvmon.recordings.messages.mcap mcap.reader",
    "dds": "rvmon.adapters.dds cyclonedds",
    "gym": "rvmon.adapters.gym gymnasium",
    "lsp": "rvmon.cli.lsp.server pygls",
    "dask": "rvmon.execute.on_dask distributed",
    "mqtt": "rvmon.adapters paho.mqtt.client",
    "zstd": "rvmon.recordings.places",
    "remote": "rvmon.recordings.places fsspec",
    "s3": "rvmon.recordings.places s3fs",
}
"""Modules that must import if only this extra is installed; `""` is rvmon without extras."""

TARGETS = ("x86_64-windows", "aarch64-macos", "aarch64-linux", "wasm32-wasi")
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")
REPEATS = 5
IMPORT = "import time; began = time.process_time(); {}; print(1000 * (time.process_time() - began))"


class ReleaseError(Exception):
    """A step failed; the text is its command and last output."""


def main() -> int:
    """Build, check, install, and print the results."""
    parser = argparse.ArgumentParser(description="Build and check a release; upload nothing.")
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="EXTRA",
        help="`core` or names of extras",
        choices=[name or "core" for name in DOORS],
    )
    parser.add_argument("--no-pythons", action="store_true", help="this Python alone")
    options = parser.parse_args()
    chosen = [name for name in DOORS if options.only is None or (name or "core") in options.only]
    failures: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        try:
            wheel = _built(Path(folder) / "tools")
            print(_compiled_elsewhere(Path(folder) / "tools"))
        except ReleaseError as error:
            print(error, file=sys.stderr)
            return 1
        print("| extra | Python | size | doors import in, CPU |\n|---|---|---|---|")
        tries = [(extra, sys.executable) for extra in chosen]
        for version in () if options.no_pythons else PYTHONS:
            if sys.version.startswith(f"{version}."):
                continue
            found = shutil.which(f"python{version}")
            if found and _starts(found):
                tries.append(("", found))
            else:
                print(f"| core | {version}: not tried, no such interpreter here | – | – |")
        for extra, python in tries:
            try:
                print(_installed(wheel, extra, python, Path(folder) / "tried"), flush=True)
            except ReleaseError as error:
                failures.append(f"{extra or 'core'}, {python}: {error}")
    print(f"Tried on {platform.system()} {platform.machine()} alone; other systems are untested.")
    print("\n".join(failures), file=sys.stderr)
    return int(bool(failures))


def _built(tools: Path) -> Path:
    """Build sdist and wheel (from the sdist), check both, and return the wheel."""
    shutil.rmtree(DIST, ignore_errors=True)
    python = _environment(sys.executable, tools)
    _run([python, "-m", "pip", "install", "-q", "build>=1,<2", "twine>=6,<7"])
    _run([python, "-m", "build", "--outdir", DIST, ROOT])
    (wheel,), (sdist,) = DIST.glob("*.whl"), DIST.glob("*.tar.gz")
    _run([python, "-m", "twine", "check", "--strict", wheel, sdist])
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    if tops != {"rvmon", "handover"} or "handover/specs/handover.rv" not in names:
        raise ReleaseError(f"the wheel holds {sorted(tops)}, or lacks handover/specs")
    if "-cp311-abi3-" not in wheel.name or "rvmon/native/_core.abi3.so" not in names:
        raise ReleaseError(f"{wheel.name} holds no native core for all versions of Python")
    with tarfile.open(sdist) as archive:
        folders = {name.split("/")[1] for name in archive.getnames() if "/" in name}
    lacking = {"src", "specs", "tests", "benchmarks", "docs", "examples", "Makefile"} - folders
    if lacking:
        raise ReleaseError(f"the sdist lacks what tests need: {sorted(lacking)}")
    for path in (wheel, sdist):
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB")
    return wheel


def _compiled_elsewhere(tools: Path) -> str:
    """Compile the core, without the Python binding, for other systems; return a line about it."""
    python = tools / "bin" / "python"
    _run([python, "-m", "pip", "install", "-q", "ziglang>=0.13,<1"])
    sources = [Path(core_sources.FOLDER, name) for name in core_sources.core_files()]
    for target in TARGETS:
        for source in sources:
            made = tools / f"{target}-{source.stem}.o"
            flags = [*FLAGS, "-I", core_sources.FOLDER]
            line = [python, "-m", "ziglang", "cc", "-target", target, *flags, "-c", source]
            _run([*line, "-o", made])
    return f"core: {len(sources)} files of C compile for {', '.join(TARGETS)}"


def _installed(wheel: Path, extra: str, python: str, folder: Path) -> str:
    """Install the wheel with one extra into a new environment; return a row of the table."""
    alone = _environment(python, folder)
    empty = _size(folder)
    _run([alone, "-m", "pip", "install", "-q", f"{wheel}[{extra}]" if extra else wheel])
    size = _size(folder) - empty
    _run([folder / "bin" / "rvmon", "--version"])
    code = IMPORT.format(f"import {DOORS[extra].replace(' ', ', ')}")
    least = min(float(_run([alone, "-c", code])) for _ in range(REPEATS))
    version = _run([alone, "-c", "import platform; print(platform.python_version())"]).strip()
    shutil.rmtree(folder)
    return f"| {extra or 'core'} | {version} | {size / 1e6:.0f} MB | {least:.0f} ms |"


def _environment(python: str, folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    _run([python, "-m", "venv", folder])
    return folder / "bin" / "python"


def _starts(python: str) -> bool:
    try:
        _run([python, "--version"])
    except ReleaseError:
        return False
    return True


def _size(folder: Path) -> int:
    """Bytes of a folder's files, without the `.pyc` files."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".pyc")
    return sum(path.stat().st_size for path in files)


def _run(command: Sequence[str | Path]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd="/")
    if done.returncode:
        last = "\n".join((done.stdout + done.stderr).splitlines()[-8:])
        raise ReleaseError(f"{' '.join(map(str, command))}\n{last}")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
