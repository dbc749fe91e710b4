"""Run the tests of the native code compiled under AddressSanitizer and UBSan (gcc alone).

The extension is built in a copy of the package, so that the one that is used stays as it is; there
each block of a monitor's memory is one of its own, so that a step beyond it is seen. What Python
itself leaves unfreed at its end is not asked for; what the core should free is for its tests.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
COPY = ROOT / "out" / "sanitized"
GROWN = "void *widened("
MEMORY = "src/rvmon/core/native/memory.c"
FLAGS = "-g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all"
# All tests are run by our own declarations, too; and memory comes from where each block is watched:
# Python's pools would hide a step too far, and all of Python without them takes twice as long.
FLAGS += " -DRVMON_OWN_PYTHON_H -DPyMem_Malloc=malloc -DPyMem_Calloc=calloc"
FLAGS += " -DPyMem_Realloc=realloc -DPyMem_Free=free -DGUARDED_MOST=SIZE_MAX"


def guarded_memory() -> str:
    """The C that takes the place of the core's memory.c, which puts many blocks into one."""
    _, found, grown = (ROOT / MEMORY).read_text(encoding="utf-8").partition(GROWN)
    if not found or grown.count("\n}\n") != 2:
        raise ValueError(f"memory.c does not end with `{GROWN}…`")
    guarded = Path(__file__).with_name("guarded.c").read_text(encoding="utf-8")
    return f"{guarded}\n{found}{grown}"


def main() -> int:
    """Build, run, and hand the exit code of the tests on."""
    shutil.rmtree(COPY, ignore_errors=True)
    ignored = shutil.ignore_patterns("__pycache__", "*.so")
    shutil.copytree(ROOT / "src", COPY / "src", ignore=ignored)
    (COPY / MEMORY).write_text(guarded_memory(), encoding="utf-8")
    shutil.copy2(ROOT / "hatch_build.py", COPY)
    environment = {**os.environ, "CC": "gcc", "CFLAGS": FLAGS}
    built = [sys.executable, str(COPY / "hatch_build.py")]
    subprocess.run(built, env=environment, check=True, stdout=subprocess.DEVNULL)
    # Python is not linked with the sanitizer, so it is loaded before all else; C++'s library too,
    # whose exceptions it has to see before any other extension throws one.
    first = [_library("libasan.so"), _library("libstdc++.so")]
    environment |= {
        "LD_PRELOAD": " ".join(first),
        "ASAN_OPTIONS": "detect_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "PYTHONPATH": os.pathsep.join([str(COPY / "src"), str(ROOT)]),
    }
    # Here no block grows in place, so that memory is not what is stated.
    stated = "tests/rvmon/core/test_window_numbers.py::test_members_take_the_memory_that_is_stated"
    tests = [
        *(sys.executable, "-m", "pytest", "-n", "auto", "-m", "not compiler"),
        # Only what Python prints is held back: a finding ends the program, and must be read.
        *("--capture=sys", "--deselect", stated, "tests/rvmon/core", "tests/rvmon/models/search"),
        *sys.argv[1:],
    ]
    return subprocess.run(tests, cwd=ROOT, env=environment, check=False).returncode


def _library(name: str) -> str:
    line = ["gcc", f"-print-file-name={name}"]
    return subprocess.run(line, capture_output=True, text=True, check=True).stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
