"""The report of mutants: scores, questions, equivalent and held-out mutants."""

from pathlib import Path

import pytest
from tests.tools.each import each

from rvmon.cdv.mutation.baseline import Difference
from rvmon.cdv.mutation.python_mutants import HELD_OUT, Mutant
from rvmon.cdv.mutation.report import MutationReport, SuiteTried, mutation_page, print_mutation
from rvmon.cdv.mutation.survivors import Finding, How, Tried, equivalents, readers
from rvmon.cdv.tables import to_json
from rvmon.errors import RvmonError
from rvmon.report.printer import text_of
from rvmon.session import loads

SPEC = loads("event go, stop\nrequirement R1\n  upon go\n  then within 3 s stop\n").checked

KILLED = Finding("t", How.REQUIREMENT, ("R1",))


def mutant(number, before="a < b", after="a <= b"):
    return Mutant(Path("m.py"), number, "comparison", before, after, "", "f", number)


MUTANTS = [mutant(number) for number in range(1, 20)]
SHOWN = [one for one in MUTANTS if one.third != HELD_OUT]
HIDDEN = [one for one in MUTANTS if one.third == HELD_OUT]


def report(*tried, equivalent=(), shows=False):
    suite = SuiteTried(3, {}, tried)
    known = {one.identity: "it cannot matter" for one in equivalent}
    return MutationReport("c", "robot", {"s": suite}, known, readers(SPEC), shows_held_out=shows)


def as_text(found, **how):
    """The report on a terminal without colours."""
    return text_of(lambda printer: print_mutation(found, printer, **how))


@pytest.mark.parametrize(
    ("tried", "asked"),
    [
        (Tried(SHOWN[0], 0), "no test runs it"),
        (Tried(SHOWN[0], 2, 2), "2 tests run it, and nothing that is recorded differs"),
        (
            Tried(SHOWN[0], 2, 2, (), Difference("t", 10**9, "stop", "True", "")),
            "in `t` the run differs at 1 s in `stop` (True → none), which R1 reads",
        ),
        (
            Tried(SHOWN[0], 2, 2, (), Difference("t", 5, "go", "", "True", (("R1", "P", "I"),))),
            "which R1 reads; verdicts differ, but none is a failure: R1 P → I",
        ),
        (
            Tried(SHOWN[0], 2, 2, (), Difference("t", 10**9, "", "", "")),
            "in `t` the run ends at 1 s, and no requirement fails",
        ),
    ],
)
def test_questions(tried, asked):
    text = as_text(report(tried))
    assert f"m.py:{tried.mutant.line}" in text
    assert "- a < b" in text
    assert "+ a <= b" in text
    assert asked in text
    assert "a &lt;= b" in mutation_page(report(tried))


def test_what_is_held_out_is_counted_and_not_shown():
    alive = [Tried(one, 2, 2) for one in MUTANTS]
    hidden = report(*alive)
    shown = report(*alive, shows=True)
    assert hidden.scores("s") == shown.scores("s")
    assert hidden.scores("s")[HELD_OUT].mutants == len(HIDDEN)
    for form in (as_text, mutation_page, lambda one: to_json(one.document()).decode()):
        for one in HIDDEN:
            assert f"{one.identity}<" not in form(hidden).replace("\n", "<").replace('"', "<")
            assert one.identity in form(shown)


def test_what_kills_stands_beside_each_mutant():
    found = report(Tried(SHOWN[0], 1, 1, (KILLED,)), Tried(HIDDEN[0], 1, 1, (KILLED,)))
    line = f"{SHOWN[0].identity}  a < b => a <= b  requirement (R1) in t"
    text = as_text(found)
    assert line.split() in [one.split() for one in text.splitlines()]
    assert HIDDEN[0].identity not in text
    assert SHOWN[0].identity not in as_text(found, most=3)
    assert "requirement (R1) in t" in mutation_page(found)


def test_an_equivalent_mutant_that_is_killed_or_changes_a_run_is_a_contradiction():
    """It counts in the score; one that survives does not."""
    found = report(Tried(SHOWN[0], 1, 1), Tried(SHOWN[1], 1, 1, (KILLED,)), equivalent=SHOWN[:2])
    assert found.survivors("s") == {}
    assert found.contradictions() == [
        f"{SHOWN[1].identity} is declared equivalent, and requirement (R1) in t kills it"
    ]
    assert found.scores("s")["all"].rest == 1
    differs = Difference("t", 10**9, "stop", "True", "")
    (told,) = report(Tried(SHOWN[0], 1, 1, (), differs), equivalent=SHOWN[:1]).contradictions()
    assert told.endswith("in `t` the run differs at 1 s in `stop` (True → none), which R1 reads")


ENTRY = """
[boundary]
because = "they differ"
mutants."m:f:comparison:1" = "a < b => a <= b"
"""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "equivalent.toml"


def test_equivalents_are_read(path):
    path.write_text(ENTRY)
    assert equivalents(path, MUTANTS) == {"m:f:comparison:1": "they differ"}


@each(
    ("text", "message"),
    [
        ("[", "not TOML"),
        (ENTRY.replace("because", "why"), "`boundary` must have an argument"),
        (ENTRY.replace("they differ", " "), "must have an argument"),
        (f"{ENTRY}\nelse = 1", "must have an argument"),
        (ENTRY.replace(":1", ":99"), "no mutant `m:f:comparison:99`"),
        (ENTRY.replace("a <= b", "a > b"), "is now another change, a < b => a <= b"),
        ("boundary = 3", "must have an argument"),
    ],
)
def test_equivalents_that_are_wrong_are_refused(path, text, message):
    path.write_text(text)
    with pytest.raises(RvmonError, match=message):
        equivalents(path, MUTANTS)
