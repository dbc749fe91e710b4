"""Compile the native code when the package is built, or in place: `python hatch_build.py`.

The extension `rvmon.native._core` consists of the binding, `src/rvmon/core/native/python`, and all
other C files of the core, compiled as one unit, which makes them faster. The files of
`src/rvmon/models/native`, compiled separately, become `rvmon.native._zones`, and those of
`src/rvmon/recordings/native` become `rvmon.native._csv`. The compiler is `$CC`, Python's own, `cc`,
`gcc` or `clang`; if none works, the build requires the package `ziglang`, which contains one.
If Python's headers are missing, the C code uses its own declarations (`python_abi.h`). `$CFLAGS`
and `$LDFLAGS` are added.
"""

from __future__ import annotations

import argparse
import importlib.machinery
import os
import platform
import runpy
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ImportError:  # run as a program, which needs only Python
    BuildHookInterface = object

PACKAGE = Path(__file__).resolve().parent / "src" / "rvmon"
CORE = PACKAGE / "core" / "native"
BESIDE = {
    "_zones": PACKAGE / "models" / "native",
    "_csv": PACKAGE / "recordings" / "native",
}
"""The other extensions and the folders of their sources."""
NATIVE = PACKAGE / "native"
SOURCES = NATIVE / "sources.py"
ZIG = "ziglang>=0.13,<1"
LIMITED_API = "0x030B0000"
"""The stable ABI of Python 3.11, so that one extension works for all later versions."""
FLAGS = (
    *("-std=c99", "-O2", "-fvisibility=hidden", "-fno-fast-math", "-ffp-contract=off"),
    "-Werror=implicit-function-declaration",
)
"""Numbers are binary64 and rounded after each operation, whatever `$CFLAGS` says. An implicitly
declared function would return half a pointer, so it is an error."""
PROBE = "#include <math.h>\n#include <stdlib.h>\nint probe(void);\nint probe(void) { return 0; }\n"


class CoreBuildHook(BuildHookInterface):
    """Puts the extension into wheels, and into the package itself for editable installations."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Additional requirements of the build: a compiler, if there is none."""
        return [] if compiler() else [ZIG]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile before the files of the wheel are collected."""
        if version == "editable":
            build_all(NATIVE)
            return
        self._made = tempfile.TemporaryDirectory()
        for made in build_all(Path(self._made.name)):
            build_data["force_include"][str(made)] = f"rvmon/native/{made.name}"
        build_data["pure_python"] = False
        build_data["tag"] = wheel_tag()

    def finalize(self, version: str, _data: dict[str, Any], _artifact: str) -> None:
        """Remove the extensions compiled for the wheel, which now contains them."""
        if version != "editable":
            self._made.cleanup()


def compiler() -> list[str]:
    """The command of a C compiler that works when tried; empty if none does.

    `$CC` is used without a trial: whoever names a compiler does not want another.
    """
    if named := os.environ.get("CC"):
        return shlex.split(named)
    for command in (sysconfig.get_config_var("CC") or "cc", "cc", "gcc", "clang"):
        if _works(shlex.split(command)):
            return shlex.split(command)
    return []


def _works(command: Sequence[str]) -> bool:
    """Whether a compiler compiles and links; Debian's gcc alone lacks the C headers."""
    if not shutil.which(command[0]):
        return False
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "probe.c").write_text(PROBE, encoding="ascii")
        line = [*command, "-fPIC", "-shared", "probe.c", "-o", "probe.so"]
        return subprocess.run(line, cwd=folder, capture_output=True, check=False).returncode == 0


def free_threaded() -> bool:
    """Whether this Python has no GIL, and with it no stable ABI."""
    return bool(sysconfig.get_config_var("Py_GIL_DISABLED"))


def file_name(module: str = "_core") -> str:
    """The file name of an extension: for the stable ABI, or for this Python if free-threaded."""
    if free_threaded():
        return module + importlib.machinery.EXTENSION_SUFFIXES[0]
    return module + (".pyd" if os.name == "nt" else ".abi3.so")


def wheel_tag() -> str:
    """The tag of a wheel with the extension: Python, ABI and platform."""
    from packaging.tags import platform_tags  # comes with hatchling

    name = next(name for name in platform_tags() if "manylinux" not in name and "musl" not in name)
    if free_threaded():
        own = f"cp{sys.version_info.major}{sys.version_info.minor}"
        return f"{own}-{own}t-{name}"
    return f"cp311-abi3-{name}"


def build(folder: Path) -> Path:
    """Compile the core into a folder and return the extension; an older one is replaced atomically.

    Raises:
        SystemExit: the compiler failed; the text is its message.
    """
    with tempfile.TemporaryDirectory(dir=folder, prefix=".build-") as made:
        unit = Path(made, "unit.c")
        unit.write_text(_unit(), encoding="utf-8")
        binding = sorted(f"python/{source.name}" for source in (CORE / "python").glob("*.c"))
        return _extension(folder / file_name(), CORE, [*binding, str(unit)], Path(made))


def build_all(folder: Path) -> list[Path]:
    """Compile the core and the other extensions into a folder, in the same way."""
    return [build(folder), *(_build_beside(folder, name) for name in BESIDE)]


def _build_beside(folder: Path, module: str) -> Path:
    home = BESIDE[module]
    with tempfile.TemporaryDirectory(dir=folder, prefix=".build-") as made:
        sources = sorted(source.name for source in home.glob("*.c"))
        return _extension(folder / file_name(module), home, sources, Path(made))


def _extension(target: Path, home: Path, sources: Sequence[str], made: Path) -> Path:
    """Compile sources (relative to `home`) into the folder `made`, and link them to `target`."""
    command = compiler() or [sys.executable, "-m", "ziglang", "cc", "-g0"]  # its default is -g
    flags = [*shlex.split(os.environ.get("CFLAGS", "")), *FLAGS, *_flags_of_python(home)]
    flags += _machine()
    objects = [str(made / f"{Path(source).stem}.o") for source in sources]
    lines = [
        [*command, *flags, "-I.", "-c", source, "-o", object_]
        for source, object_ in zip(sources, objects, strict=True)
    ]
    with ThreadPoolExecutor(os.cpu_count() or 1) as threads:
        list(threads.map(lambda line: _run(line, home), lines))
    linked = made / target.name
    _run([*command, *flags, *_link(), *objects, "-o", str(linked), "-lm", *_link_last()], home)
    os.replace(linked, target)  # atomic: running programs keep the old file
    return target


def _flags_of_python(home: Path) -> list[str]:
    """Flags for Python's headers and for the ABI."""
    include = {sysconfig.get_path("include"), sysconfig.get_path("platinclude")}
    flags = [f'-DRVMON_SOURCE_HASH="{_source_hash(home)}"']
    if any(Path(folder, "Python.h").exists() for folder in include):
        flags += [part for folder in sorted(include) for part in ("-isystem", folder)]
    elif free_threaded():
        sys.exit(
            "rvmon: a free-threaded Python has no stable ABI: its headers (Python.h) are needed"
        )
    else:
        flags.append("-DRVMON_OWN_PYTHON_H")
    return flags if free_threaded() else [*flags, f"-DPy_LIMITED_API={LIMITED_API}"]


def _source_hash(home: Path) -> str:
    """The checksum as at import, without importing the package: its dependencies may be missing."""
    return str(runpy.run_path(str(SOURCES))["source_hash"](str(home)))


def _unit() -> str:
    """The sources of the core as one unit; compiler messages still name the files."""
    return str(runpy.run_path(str(SOURCES))["core_source"]("core.h", str(CORE), lines=True))


def _machine() -> list[str]:
    """Flags for the machine: 32-bit x86 must not compute with 80 bits, as it does by default."""
    flags = [] if os.name == "nt" else ["-fPIC"]
    if sys.maxsize < 2**32 and platform.machine().lower() in {"i386", "i586", "i686", "x86_64"}:
        flags += ["-msse2", "-mfpmath=sse"]
    return flags


def _link() -> list[str]:
    """Flags that link an extension; symbols of Python are resolved when it is loaded."""
    mac = ["-bundle", "-undefined", "dynamic_lookup"]
    return mac if sys.platform == "darwin" else ["-shared"]


def _link_last() -> list[str]:
    """Libraries and `$LDFLAGS`; on Windows, symbols of Python must be resolved when linking."""
    flags = shlex.split(os.environ.get("LDFLAGS", ""))
    if os.name != "nt":
        return flags
    library = "python3t" if free_threaded() else "python3"
    return [*flags, f"-L{Path(sys.base_prefix, 'libs')}", f"-l{library}"]


def _run(line: Sequence[str], home: Path) -> None:
    done = subprocess.run(line, cwd=home, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"rvmon: the native core did not compile\n{shlex.join(line)}\n{done.stderr}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Compile the native core.")
    parser.add_argument("--into", type=Path, default=NATIVE, metavar="FOLDER", help="else in place")
    into = parser.parse_args().into
    print(*build_all(into), sep="\n")
