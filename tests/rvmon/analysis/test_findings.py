"""The claims of an analysis hold on every run tried."""

import math
import random
import tracemalloc

import pytest
from tests.tools import build
from tests.tools.each import each

import rvmon
from rvmon.analysis.example import Budget
from rvmon.analysis.shortest_examples import analyse, shortest_examples
from rvmon.analysis.vacuity import possible
from rvmon.cli import main
from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace, show_spec
from rvmon.testing.oracle import evaluate

SPEC = """
event a, b, c
signal p, q : bool
signal x : real
requirement R1 upon a then within 1 s b
requirement R2 upon a then for 2 s not b
requirement R3 upon a then within 3 s b
requirement R4 upon c then always[2 s, 3 s] p
requirement R5 upon b then for 1 s not p
requirement R6 upon c then within 2 s (p or q)
requirement R7 always not q
requirement R8 upon c then for 3 s not p
requirement R9 upon x > 3 and x < 2 then within 1 s q
requirement R10 upon a then within 1 s (x > 3 or x <= 4)
requirement R11 upon a then within 1 s (x > 4 and x < 2)
requirement R12 upon b and p then within 1 s c
requirement R13 upon b and not p then for 1 s not c
"""


def analysis_of(text):
    """The analysis of a specification's text without a time limit."""
    return analyse(compile_spec(rvmon.loads(text).checked), seconds=math.inf)


@pytest.fixture(scope="module")
def analysed():
    return analysis_of(SPEC)


@pytest.mark.slow
def test_known_answers(analysed):
    """Contradictions, conflicts with runs that trigger them, and redundant requirements."""
    found = analysed.examination
    sets = {conflict.ids: conflict.offsets for conflict in found.conflicts}
    assert sets == {
        ("R1", "R2"): (0, 0),
        ("R4", "R5"): (0, 10**9),
        ("R4", "R8"): (0, 0),
        ("R6", "R7", "R8"): (0, 0, 0),
    }
    assert {(one.implied, one.by) for one in found.implications} == {
        ("R3", ("R1",)),
        ("R6", ("R4",)),
    }
    assert found.possible["R9"].trigger is False
    assert found.possible["R10"].fail is False
    assert found.possible["R11"].pass_ is False
    assert not found.undecided
    told = {conflict.ids: example for conflict, example in analysed.timelines}
    assert [*told] == [("R1", "R2"), ("R4", "R8"), ("R6", "R7", "R8")]
    for ids, example in told.items():
        triggers = {one.requirement: one.triggered for one in example.attempts}
        assert tuple(triggers[name] - triggers[ids[0]] for name in ids) == sets[ids]


@each(
    ("time", "required", "passes"),
    [
        ("held", "for 1 s v", False),  # v ends, and the obligation at its last instant fails
        ("held", "for 1 s w", True),
        ("held", "within 1 s not v", True),
        ("sampled every 100 ms", "for 1 s v", False),
        ("sampled every 1 s", "for 900 ms v", True),  # nothing is required between positions
        ("sampled", "for 1 s v", True),  # two samples may be that far apart
    ],
)
def test_a_clock_that_is_started_at_every_position(time, required, passes):
    """The time between positions matters for the possible verdicts of an episode."""
    text = f"time {time}\nsignal v, w : bool\nrequirement R\n  whenever v\n  then {required}\n"
    assert analysis_of(text).examination.possible["R"].pass_ is passes


@pytest.mark.law
@pytest.mark.parametrize("model", list(TimeModel))
def test_what_cannot_be_is_never_seen(model):
    rng = random.Random(model.value)
    claims = 0
    for _ in range(60):
        spec = random_spec(rng, Profile(time=model, requirements=1, depth=3, numbers=False))
        [one] = compile_spec(spec).requirements.values()
        can = possible(spec, one.obligation.trigger, one.automaton, one.requirement.at_end)
        ruled_out = {"P"} if can.pass_ is False else set()
        ruled_out |= {"F"} if can.fail is False else set()
        claims += len(ruled_out)
        for _ in range(15 if ruled_out else 0):
            case = random_trace(rng, spec, TraceProfile())
            report = evaluate(spec, case.samples, advances=case.advances, end=case.end)
            seen = {attempt.verdict.value for attempt in report.attempts}
            assert not seen & ruled_out, (show_spec(spec), case)
    assert claims > 1


CONFLICTS = {
    "of four, and none with a member too many": (
        """
requirement R1 upon a then within 2 s (p or q or r)
requirement R2 upon a then for 3 s not p
requirement R3 upon a then for 3 s not q
requirement R4 upon a then for 3 s not r
requirement R5 upon a then within 3 s b
""",
        (("R1", "R2", "R3", "R4"), (0, 0, 0, 0)),
        "R1, R2, R3 and R4 cannot all hold",
    ),
    "with itself when it is triggered again": (
        "requirement R1 upon a then (always[2 s, 3 s] p) and (for 1 s not p)\n",
        (("R1", "R1"), (0, 10**9)),
        "cannot hold once it is triggered again, 1 s later",
    ),
    "wherever the inner window begins": (
        """
requirement R1 upon a then within 500 ms for 1 s p
requirement R2 upon a then eventually[600 ms, 1 s] not p
requirement R3 upon a then eventually[600 ms, 1200 ms] not p
""",
        (("R1", "R2"), (0, 0)),
        "",
    ),
    "only because of a third that holds at all times": (
        """
requirement R1 upon a then always[2 s, 3 s] p
requirement R2 upon b then for 1 s q
requirement R3 always not (p and q)
""",
        (("R1", "R2", "R3"), (0, 10**9, 0)),
        "",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CONFLICTS)
def test_the_least_conflict_is_found_and_its_timeline_triggers_it(name):
    text, expected, told = CONFLICTS[name]
    analysis = analysis_of("event a, b\nsignal p, q, r : bool\n" + text)
    (conflict,) = analysis.examination.conflicts
    assert (conflict.ids, conflict.offsets) == expected
    assert told in analysis.findings[0].message
    if conflict.ids[0] == conflict.ids[-1]:
        ((_, example),) = analysis.timelines
        assert [attempt.triggered for attempt in example.attempts] == [0, 10**9]


@pytest.mark.parametrize(
    ("text", "implied"),
    [
        (
            "requirement R1\n upon a\n then within 2 s (p or q)\n"
            "requirement R2\n upon a\n then for 2 s not q\n"
            "requirement R3\n upon a\n then within 3 s p\n",
            {("R3", ("R1", "R2"))},
        ),
        (
            "requirement R1\n upon a\n then within 2 s b\n"
            "requirement R2\n upon a and p\n then within 3 s b\n",
            {("R2", ("R1",))},
        ),
        (
            "requirement R1\n upon a and p\n then within 2 s b\n"
            "requirement R2\n upon a\n then within 3 s b\n",
            set(),
        ),
        (
            "requirement R1\n always not p\nrequirement R2\n upon a\n then for 1 s not p\n",
            {("R2", ("R1",))},
        ),
    ],
)
def test_implications(text, implied):
    """By several requirements, by a wider trigger, by an invariant; not by a narrower trigger."""
    found = analysis_of("event a, b\nsignal p, q : bool\n" + text).examination.implications
    assert {(one.implied, one.by) for one in found} == implied


@pytest.mark.law
@pytest.mark.parametrize("seed", range(2))
def test_claims_about_random_specs_are_not_refuted(seed):
    rng = random.Random(seed)
    claims = 0
    for _ in range(40):
        spec = _random_responses(rng)
        compiled = compile_spec(spec)
        found = analyse(compiled, seconds=math.inf, timelines=0).examination
        for conflict in found.conflicts:
            claims += 1
            chosen = [compiled.requirements[name] for name in dict.fromkeys(conflict.ids)]
            budget = Budget(runs=150, samples=3, step=1)
            goal = _all_met(conflict)
            tried = shortest_examples(compiled, chosen, goal, ["met"], budget)
            for example in tried.examples.values():
                verdicts = evaluate(spec, example.samples, end=example.end).verdicts
                pytest.fail(f"{show_spec(spec)}\n{conflict}\n{example}\n{verdicts}")
        for one in found.implications:
            claims += 1
            chosen = [compiled.requirements[name] for name in (*one.by, one.implied)]
            budget = Budget(runs=150, samples=3, step=1)
            goal = _fails_alone(one)
            tried = shortest_examples(compiled, chosen, goal, ["alone"], budget)
            assert not tried.examples, (show_spec(spec), one, tried.examples)
    assert claims > 5


def _random_responses(rng):
    """Three random requirements over two signals and two events, with windows of a few ticks."""
    literals = [build.p, build.q, build.f, build.no(build.p), build.no(build.q), build.no(build.f)]
    triggers = [build.e, build.f, build.two(build.e, "and", build.p), build.start]

    def required():
        low = rng.choice([0, 0, 0, 1, 2])
        high = low + rng.randint(0, 3)
        operator = rng.choice([build.eventually, build.always, build.always])
        if rng.random() < 0.2:
            inner = build.always if operator is build.eventually else build.eventually
            return operator(inner(rng.choice(literals), 0, rng.randint(1, 2)), low, high)
        if rng.random() < 0.25:
            return build.two(rng.choice(literals), "U", rng.choice(literals), low, high)
        return operator(rng.choice(literals), low, high)

    return build.spec_of(
        *(
            build.requirement(required(), upon=rng.choice(triggers), name=f"R{number}")
            for number in (1, 2, 3)
        )
    )


def _all_met(conflict):
    """A goal of a search: a run on which all attempts triggered as in the conflict pass."""

    def goal(example):
        passed = {
            name: {
                a.triggered
                for a in example.attempts
                if a.requirement == name and a.verdict.value == "P"
            }
            for name in conflict.ids
        }
        pairs = list(zip(conflict.ids, conflict.offsets, strict=True))
        for first in passed[conflict.ids[0]]:
            if all(first + offset in passed[name] for name, offset in pairs):
                return "met"
        return None

    return goal


def _fails_alone(one):
    """A goal of a search: a run on which the implied requirement fails and the others pass."""

    def goal(example):
        verdicts = {(a.requirement, a.triggered): a.verdict.value for a in example.attempts}
        for (name, triggered), verdict in verdicts.items():
            failed = name == one.implied and verdict == "F"
            if failed and all(verdicts.get((by, triggered)) == "P" for by in one.by):
                return "alone"
        return None

    return goal


@pytest.mark.slow
def test_check_analyse(tmp_path, says):
    path = tmp_path / "a.rv"
    path.write_text(SPEC)
    patient = ["check", str(path), "--analyse", "--seconds", "9999"]
    shown = says(0, *patient)
    assert "RV073 conflict]: R1 and R2 cannot both hold" in shown.err
    assert f"{path}:5:1" in shown.err
    assert "After this, one of R1, R2 fails, whatever comes:" in shown.out
    assert all(len(line) <= 80 for line in shown.out.splitlines())
    assert main([*patient, "--strict"]) == 1
    assert "not decided" in says(0, "check", path, "--analyse", "--seconds", "0").out


def test_help_fits_the_requirement(tmp_path, says):
    """It proposes no deadline if there is one, and no narrower trigger if there is none."""
    path = tmp_path / "a.rv"
    path.write_text(
        "signal v : real\nevent go\nrequirement TAUT\n"
        " upon go then within 1 s (v > 1 or v <= 1)\n"
        "requirement SLOW\n always v < 1\nrequirement FAST\n always v > 2\n"
    )
    shown = says(0, "check", path, "--analyse", "--seconds", "9999").err
    assert "RV071" in shown
    assert "give it a deadline" not in shown
    assert "RV073" in shown
    assert "narrow one of the triggers" not in shown


@pytest.mark.parametrize("policy", ["strict", "strong", "fail"])
def test_a_policy_under_which_nothing_passes(policy):
    """Attempts held to the end stay open, or fail: the message names the policy."""
    text = f"signal p : bool\nrequirement R\n  always p\n  at end: {policy}\n"
    (finding,) = analysis_of(text).findings
    assert finding.code == "RV072"
    assert f"`at end: {policy}` lets nothing pass" in finding.help


@pytest.mark.slow
def test_combinations_of_many_requirements_stay_within_the_budget():
    """Two hundred requirements have a million triples, which are not held in memory at once."""
    text = "spec s\nsignal x : real\nevent e\n" + "".join(
        f"requirement R{n}\n  upon e\n  then within {n + 1} ms x > {n}\n" for n in range(200)
    )
    compiled = compile_spec(rvmon.loads(text).checked)
    tracemalloc.start()
    try:
        found = analyse(compiled, seconds=0, timelines=0).examination
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert found.whole_sets == 2
    assert most < 100_000_000
