"""The core in C alone: what it says of recorded cases, on this machine and on a smaller one."""

import subprocess
from pathlib import Path

import pytest
from benchmarks.core_mutants import CORE, REPLAY, Trial, c_mutants, draw, recorded, sources

from benchmarks import core_mutants

pytestmark = pytest.mark.compiler

CASES = 60
C = """\
/* if (a < 1) { */
#define LIMIT (1 < 2)
static bool judge(int a, int b)
{
    bool found = false;
    if ((a < b) && !ready(a)) {
        found = a == b - 1;
        note(a);
    }
    return found;
}
"""

FLAGS = ("-std=c99", "-O0", "-ffp-contract=off", "-w", f"-I{CORE}")


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of recorded cases, of which the law and the core say the same."""
    path = tmp_path_factory.mktemp("recorded") / "cases"
    path.write_bytes(recorded(CASES, "replay"))
    return path


def said(folder: Path, cases: Path, *compiler: str) -> list[str]:
    """What the core says when it is compiled so; one line of each case.

    Raises:
        CalledProcessError: it does not compile, or crashes.
    """
    program, core = folder / "replay", folder / "core.c"
    core.write_text("".join(f'#include "{path}"\n' for path in sources()))
    words = [*compiler, *FLAGS, str(core), str(REPLAY), "-lm", "-o", str(program)]
    subprocess.run(words, check=True, capture_output=True)  # noqa: S603
    words = [str(program), str(cases)]
    done = subprocess.run(words, check=True, capture_output=True, text=True)  # noqa: S603
    return done.stdout.splitlines()


MACHINES = ("clang", "gcc -m32 -msse2 -mfpmath=sse", "gcc")


def test_machines_say_the_same(cases: Path, tmp_path: Path) -> None:
    """Two of those that are here, of 64 and of 32 bits if they can be, in any block of memory."""
    told: list[list[str]] = []
    for compiler in MACHINES:
        try:
            told.append(said(tmp_path, cases, *compiler.split()))
        except (FileNotFoundError, subprocess.CalledProcessError) as error:
            missing = getattr(error, "stderr", b"gnu/stubs")  # gcc may lack its 32 bits
            if b"gnu/stubs" not in missing and b"libgcc" not in missing:
                raise
        if len(told) == 2:
            break
    one, other = told
    assert one == other
    assert len(one) > CASES / 2
    wrong = [line for line in one if len(line.split()) > 2]
    assert not wrong, "a letter of core_replay.c tells what should never be"


def test_mutants_are_seen(cases: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Most small changes of the core are told from it by some dozens of cases."""
    monkeypatch.setattr(core_mutants, "FLAGS", FLAGS)
    path = CORE / "formulas" / "graph.c"
    trial = Trial(tmp_path, cases.read_bytes(), [path])
    (mutant,) = draw(c_mutants(path), count=1, seed=1)
    assert trial.outcome(mutant) == "killed"


def test_c_changes(tmp_path):
    """Operators, constants and statements are changed; comments and directives are not."""
    path = tmp_path / "m.c"
    path.write_text(C, encoding="utf-8")
    found = list(c_mutants(path))
    changes = {(one.line, one.kind) for one in found}
    assert changes == {
        (5, "constant"),
        (6, "and/or"),
        (6, "comparison"),
        (6, "dropped not"),
        (6, "negated condition"),
        (7, "comparison"),
        (7, "constant"),
        (7, "dropped statement"),
        (7, "off by one"),
        (8, "dropped statement"),
    }
    assert all(one.source.count("\n") == C.count("\n") for one in found)
