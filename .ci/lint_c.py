"""Compile all C of the extensions, by gcc, by clang, and for 32 bits.

    python .ci/lint_c.py [WARNING …]

Sources that use Python's C API are compiled twice: with Python's headers, and with rvmon's own
declarations. A missing compiler is reported and skipped; in CI (`$CI`) it is an error.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src" / "rvmon"
FOLDERS = [PACKAGE / room / "native" for room in ("core", "models", "recordings")]
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")  # some warnings appear only with optimisation
TRIAL = "#include <stdint.h>\n#include <stdlib.h>\nint main(void) { return 0; }\n"
COMPILERS = {"gcc": "gcc", "clang": "clang", "gcc -m32 -msse2 -mfpmath=sse": "gcc-multilib"}
"""Each compiler and the Debian package that provides it."""


def main(warnings: list[str]) -> int:
    """Compile everything and print the errors; the exit code is 1 if there are any."""
    lines: list[list[str]] = []
    missing: list[str] = []
    for command, package in COMPILERS.items():
        if not _compiles(command):
            missing.append(f"C is not checked with `{command}`: no such compiler ({package})")
            continue
        start = [*command.split(), *FLAGS, *warnings, "-c"]
        for folder in FOLDERS:
            for source in sorted(folder.rglob("*.c")):
                ways = _ways(source, command)
                lines += [[*start, f"-I{folder}", str(source), *way] for way in ways]
    with ThreadPoolExecutor(os.cpu_count() or 1) as threads:
        failures = [text for text in threads.map(_complaint, lines) if text]
    print(*missing, *failures, sep="\n", end="\n" if missing or failures else "")
    return int(bool(failures or (missing and os.environ.get("CI"))))


def _ways(source: Path, command: str) -> list[list[str]]:
    """The options with which a source is compiled, one list per compilation."""
    if "PyObject" not in source.read_text(encoding="utf-8"):
        return [[]]
    include = sysconfig.get_path("include")
    own = ["-DRVMON_OWN_PYTHON_H"]
    if "-m32" in command or not Path(include, "Python.h").exists():
        return [own]
    free_threaded = sysconfig.get_config_var("Py_GIL_DISABLED")
    return [own, ["-isystem", include, *([] if free_threaded else ["-DPy_LIMITED_API=0x030B0000"])]]


def _compiles(command: str) -> bool:
    """Whether the compiler is installed, with headers and libraries for its target."""
    with tempfile.TemporaryDirectory() as folder:
        trial = Path(folder, "trial.c")
        trial.write_text(TRIAL, encoding="ascii")
        try:
            line = [*command.split(), str(trial), "-o", str(Path(folder, "trial"))]
            return subprocess.run(line, capture_output=True, check=False).returncode == 0
        except FileNotFoundError:
            return False


def _complaint(line: list[str]) -> str:
    done = subprocess.run([*line, "-o", os.devnull], capture_output=True, text=True, check=False)
    return f"{shlex.join(line)}\n{done.stderr}" if done.returncode else ""


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
