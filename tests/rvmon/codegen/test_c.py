"""Generated C: strict compilers, sanitizers, the oracle."""

import re
import subprocess
from pathlib import Path

import pytest
from tests.tools.differential import campaign
from tests.tools.forms import Maker
from tests.tools.gcc import SANITIZED, STRICT

import rvmon
from rvmon.cli import main
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_source import c_files
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

pytestmark = pytest.mark.compiler

SPEC = """
spec everything "All that is generated"
time held
signal p, q : bool
signal x : real   stale after 2 s
signal mode : {red, green}
event e(k: int)
event f
requirement R1 "a"
  upon e.k > 2 and once[1 s, 3 s] p
  then within 3 s held(q or x > 1, 1 s)
requirement R2 "b"
  whenever (p since[0 s, 5 s] q) or held(q, 2 s)
  then within 2 s mode == green
requirement R3 "c"
  upon rise(p) or changed(x)
  then (abs(delta(x)) < 1 or rate(x) > 2 or prev(x) + 1 > max(x, 2))
    until[0 s, 4 s] (f or not known(x))
requirement R4 "d"
  upon end
  then p
requirement R5 "by a network"
  whenever p
  then F[1 s, 2 s] (q or mode == red)
requirement R6 "by one that looks back"
  upon f
  then F[0 s, 2 s] once[0 s, 2 s] (q and within 1 s p)
requirement R7 "with captured values"
  whenever p
  then within 2 s x > abs(v) + w
  let v = delta(x)
  let w = x
requirement R8 "one instance for each value"
  upon e
  then within 2 s (e.k == i + 1)
  for each i in e.k
requirement R9 "both, looking at what was before"
  upon e and once[0 s, 2 s] e.k == i - 1
  then F[0 s, 2 s] once[0 s, 2 s] x > v
  for each i in e.k
  let v = x
"""


@pytest.fixture(autouse=True)
def strict(monkeypatch):
    """A warning is an error."""
    monkeypatch.setattr("rvmon.codegen.c_build.FLAGS", STRICT)


@pytest.mark.parametrize("nodes", [32, 3])
def test_the_oracle_agrees(nodes, monkeypatch):
    """Compiled monitors judge as the law has it, however many nodes are worked out together."""
    monkeypatch.setattr("rvmon.codegen.c_nodes.GROUP", nodes)
    profile = Profile(mixed=False)
    seeds = [f"c/{number}" for number in range(8)]
    tally = campaign(Maker("c rows"), seeds, profile, TraceProfile(), each=5, online_every=0)
    assert tally.pairs >= 20
    assert not tally.disagreements, tally.disagreements[0]


def test_all_operators_compile_strictly_and_run_clean(tmp_path):
    """No warning of gcc, none of the address and undefined-behaviour sanitizers, C++ included."""
    made = c_files(rvmon.loads(SPEC).plan())
    for name, text in made.texts.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "main.cpp").write_text(
        """
        #include "everything.hpp"
        #include <cstdio>
        int main() {
            everything::Monitor m(4, [](const everything_record &r) {
                std::printf("%d %u %d\\n", (int)r.requirement, (unsigned)r.number, (int)r.verdict);
            });
            for (int i = 0; i < 400; i++) {
                everything_sample s{};
                s.signal[i % 4] = everything_YES;
                s.value[i % 4] = (i / 3) % 2;
                s.event[0] = i % 5 ? everything_NOTHING : everything_YES;
                s.field[0] = i % 7;
                s.event[1] = i % 11 ? everything_NO : everything_UNKNOWN;
                if (!m.step(300000000LL * i, s)) { return 1; }
                if (m.step(300000000LL * i, s)) { return 2; }
                if (i % 50 == 0) { m.advance(300000000LL * i + 1); }
            }
            m.finish();
            return m.next_due() > 0 && m.overflowed() ? 0 : 3;
        }
        """
    )
    objects = [f"{name.removesuffix('.c')}.o" for name in ("everything.c", *made.units)]
    for words in (
        ["gcc", *STRICT, "-O1", "-c", "everything_batch.c", *made.units],
        ["gcc", *STRICT, *SANITIZED, "-c", "everything.c", *made.units],
        ["g++", "-std=c++11", *STRICT[1:], *SANITIZED, "main.cpp", *objects, "-o", "main"],
        ["./main"],
    ):
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)  # noqa: S603
        assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) > 20


FULL = """
#include "s.c"
#include <stdio.h>
static s_monitor m;
static s_attempt attempts[2];
static void hear_of(void *user, const s_record *r) {
    (void)user;
    printf("%d%d ", r->requirement, r->verdict);
}
int main(void) {
    static const double x[] = {1, 1, 5, 1, 1};
    int i;
    s_init(&m, attempts, 2, hear_of, NULL);
    for (i = 0; i < 5; i++) {
        s_sample sample = {0};
        sample.signal[0] = s_YES;
        sample.value[0] = x[i];
        sample.event[0] = s_YES;
        if (!s_step(&m, i * INT64_C(3600000000000), &sample)) { return 1; }
    }
    printf("%d", s_overflowed(&m));
    return 0;
}
"""


def test_where_no_attempt_has_room_an_episode_goes_on_without(tmp_path):
    """It is not looked for room at each nanosecond of the hours that follow the failure."""
    spec = rvmon.loads(
        "spec s\nsignal x : real\nevent e\n"
        "requirement R1\n  always x <= 3\nrequirement R2\n  upon e then eventually x > 9\n"
    )
    for name, text in c_files(spec.plan()).texts.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "main.c").write_text(FULL)
    subprocess.run(["gcc", "main.c", "-o", "main"], cwd=tmp_path, check=True)  # noqa: S607
    done = subprocess.run(  # noqa: S603
        [tmp_path / "main"], capture_output=True, text=True, check=True, timeout=20
    )
    assert done.stdout == "00 1"


def test_the_source_allocates_nothing_and_needs_little():
    """No heap, no recursion into libc: only freestanding headers and string.h."""
    made = c_files(rvmon.loads(SPEC).plan())
    text = made.texts["everything.c"] + made.texts["everything.h"]
    included = {line.split()[1] for line in text.splitlines() if line.startswith("#include")}
    assert included == {
        *("<stdbool.h>", "<stddef.h>", "<stdint.h>", "<string.h>", '"everything.h"')
    }
    assert not any(word in text for word in ("malloc", "free(", "printf"))


def test_the_command_writes_a_folder(tmp_path, capsys):
    """`rvmon compile --to c` writes header, source and C++ wrapper, and names them."""
    (tmp_path / "s.rv").write_text(SPEC)
    assert main(["compile", str(tmp_path / "s.rv"), "--to", "c", "-o", str(tmp_path / "out")]) == 0
    listed = {Path(line).name for line in capsys.readouterr().out.split()}
    assert {"everything.h", "everything.c", "everything.hpp"} <= listed
    assert main(["compile", str(tmp_path / "s.rv"), "--to", "c"]) == 2


def named(name: str) -> rvmon.Spec:
    """The specification of everything, of another name."""
    return rvmon.loads(SPEC.replace("spec everything", f"spec `{name}`"))


@pytest.mark.parametrize("name", ["n", "print", "reach", "step", "string", "switch", "rule"])
def test_no_name_of_a_spec_collides(name, tmp_path):
    """What a specification is called does not matter to the compiler."""
    spec = named(name)
    made = c_files(spec.plan())
    for file, text in made.texts.items():
        (tmp_path / file).write_text(text)
    words = ["g++", "-std=c++11", *STRICT[1:], "-I.", "-fsyntax-only", "-x", "c++"]
    done = subprocess.run([*words, f"{made.prefix}.hpp"], cwd=tmp_path, check=False)  # noqa: S603
    assert done.returncode == 0
    trace = [(0.0, {"p": True, "mode": "red"}), (1.0, {"p": False})]
    by_c, by_python = (spec.evaluate(trace, engine=one, only=["R2"]) for one in ("c", "auto"))
    assert by_c.verdicts == by_python.verdicts


def test_names_within_the_c_are_no_names_of_another_spec():
    """No name in the sources is one that the header would give to a specification called so."""
    plan = named("zz").plan()
    bare = re.sub(r"/\*.*?\*/", "", "\n".join(c_files(plan).texts.values()), flags=re.DOTALL)
    found = set(re.findall(r"[A-Za-z]\w*", bare))
    for mark in ("zz", "ZZ"):
        # What is but the mark is pasted to a number.
        given = {name[2:] for name in found if name.startswith(f"{mark}_") and name != f"{mark}_"}
        assert len(given) > 30
        for name in found - {mark + end for end in given} - {f"{mark}_"}:
            heads = {name.removesuffix(end) for end in given if name.endswith(end)}
            for head in heads:
                if head == (head.upper() if mark == "ZZ" else head.lower()):
                    assert Names(named(head.lower()).plan()).prefix != head.lower(), name


def test_nothing_is_compiled_of_no_requirement(tmp_path, capsys):
    """A specification without requirements is refused before the C compiler sees it."""
    path = tmp_path / "none.rv"
    path.write_text("spec none\nsignal p : bool\n")
    assert main(["compile", str(path), "--to", "c", "-o", str(tmp_path / "made")]) == 2
    told = capsys.readouterr().err
    assert "the specification has no requirements: there is nothing to compile" in told
