"""Run the tests of the native code under AddressSanitizer and UBSan (only with gcc).

The extensions are built in a copy of the package, so the installed ones stay unchanged. In the copy
each block of a monitor's memory is allocated separately, so that accesses beyond it are detected.
Leaks are not checked: Python itself leaves memory unfreed, and tests check what the core frees.
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
# The tests also cover our own declarations of the C API. Memory comes from malloc, which guards
# each block; Python's pools would hide an overrun.
FLAGS += " -DRVMON_OWN_PYTHON_H -DPyMem_Malloc=malloc -DPyMem_Calloc=calloc"
FLAGS += " -DPyMem_Realloc=realloc -DPyMem_Free=free -DGUARDED_MOST=SIZE_MAX"

CSV = ("csv_batch", "csv_dialect", "csv_text", "doors", "stamps")
TESTS = {
    "pymalloc": ("core", "models/search"),
    "malloc": ("native", *(f"recordings/test_{name}.py" for name in CSV), "recordings/starter"),
}
"""Folders and files of tests by the allocator of Python. The text of a CSV file is a Python object,
so its reader is tested without pools. The others would take twice as long without."""


def guarded_memory() -> str:
    """The C code that replaces the core's memory.c, which puts many blocks into one chunk."""
    _, found, grown = (ROOT / MEMORY).read_text(encoding="utf-8").partition(GROWN)
    if not found or grown.count("\n}\n") != 2:
        raise ValueError(f"memory.c does not end with `{GROWN}…`")
    guarded = Path(__file__).with_name("guarded.c").read_text(encoding="utf-8")
    return f"{guarded}\n{found}{grown}"


def main() -> int:
    """Build the extension and run the tests; return their exit code."""
    shutil.rmtree(COPY, ignore_errors=True)
    ignored = shutil.ignore_patterns("__pycache__", "*.so")
    shutil.copytree(ROOT / "src", COPY / "src", ignore=ignored)
    (COPY / MEMORY).write_text(guarded_memory(), encoding="utf-8")
    shutil.copy2(ROOT / "hatch_build.py", COPY)
    environment = {**os.environ, "CC": "gcc", "CFLAGS": FLAGS}
    built = [sys.executable, str(COPY / "hatch_build.py")]
    subprocess.run(built, env=environment, check=True, stdout=subprocess.DEVNULL)
    # Python is not linked with the sanitizer, so the sanitizer has to be loaded first. The C++
    # library too: the sanitizer must intercept its exceptions before any extension throws one.
    first = [_library("libasan.so"), _library("libstdc++.so")]
    environment |= {
        "LD_PRELOAD": " ".join(first),
        "ASAN_OPTIONS": "detect_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "PYTHONPATH": os.pathsep.join([str(COPY / "src"), str(ROOT)]),
    }
    tests = [
        # Guarded blocks never grow in place, so more memory is taken than documented.
        *(sys.executable, "-m", "pytest", "-n", "auto", "-m", "not (compiler or allocator)"),
        # Capture only what Python prints: a sanitizer report ends the process and must be visible.
        *("--capture=sys", *sys.argv[1:]),
    ]
    code = 0
    for allocator, own in TESTS.items():
        line = [*tests, *(f"tests/rvmon/{name}" for name in own)]
        environment["PYTHONMALLOC"] = allocator
        code |= subprocess.run(line, cwd=ROOT, env=environment, check=False).returncode
    return code


def _library(name: str) -> str:
    line = ["gcc", f"-print-file-name={name}"]
    return subprocess.run(line, capture_output=True, text=True, check=True).stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
