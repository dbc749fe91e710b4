"""A program made by `rvmon build`, for the tests of what it judges and what it refuses."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.tools.gcc import SANITIZED, STRICT

from rvmon.cli import main

SPEC = """
spec watch "A cell"
time held
signal open_door : bool
signal arm.speed : real [m/s]  stale after 700 ms
signal parts : int
signal mode : {idle, "at work", stopped}
event pick(id: int, force: real)
event halt
requirement R1 "a"
  upon halt
  then within 300 ms arm.speed < 0.1 m/s
requirement R2 "b"
  whenever mode == idle
  then within 1 s not open_door
requirement R3 "c"
  upon pick.force > 4.5 or pick.id == 3
  then within 1 s (halt or parts >= 2)
requirement R4 "d"
  always once[0 s, 2 s] known(arm.speed)
"""


@dataclass(frozen=True, slots=True)
class Program:
    """A specification and the program made of it."""

    spec: Path
    binary: Path

    def judge(self, *paths: str, stdin: str | None = None) -> subprocess.CompletedProcess[str]:
        """Run it on recordings, which may lack columns."""
        # It leaves by `exit` where a recording is wrong: memory in use then is not lost.
        env = os.environ | {"ASAN_OPTIONS": "detect_leaks=0"}
        words = [self.binary, "--allow-missing", *paths]
        return subprocess.run(  # noqa: S603
            words, capture_output=True, text=True, check=False, input=stdin, env=env
        )


def without_stale(text: str) -> str:
    """The specification for which samples that say nothing new change nothing."""
    return text.replace("stale after 700 ms", "")


def ignoring(text: str) -> str:
    """The specification to which NaN and null of numbers say nothing."""
    return text.replace("stale after 700 ms", "ignore NaN stale after 700 ms")


SMALL = ("-DBLOCK=100",)
"""Has a program read by blocks that hold a line or two: most recordings then have several."""


@pytest.fixture(
    scope="package",
    params=[(str, ()), (without_stale, ()), (ignoring, SMALL), (without_stale, SMALL)],
    ids=["stale", "steady", "ignoring", "blocks"],
)
def program(request, tmp_path_factory) -> Program:
    """A program, compiled without a warning."""
    folder = tmp_path_factory.mktemp("build")
    spec = folder / "watch.rv"
    changed, more = request.param
    spec.write_text(changed(SPEC.replace('"at work"', "working")))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rvmon.codegen.c_build.FLAGS", (*STRICT, *SANITIZED, *more))
        assert main(["build", str(spec), "-o", str(folder / "watch")]) == 0
    return Program(spec, folder / "watch")
