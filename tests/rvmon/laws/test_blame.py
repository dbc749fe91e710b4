"""The part that a failure blames was false by the law."""

import pytest
from tests.tools.differential import cases_of
from tests.tools.drive import drive
from tests.tools.forms import Compiler, Maker
from tests.tools.judgement import Judgement

import rvmon
from rvmon.language.checked.formula import Formula, Unary, UnaryOp
from rvmon.language.print import format_formula
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.testing.law.attempts import Start
from rvmon.testing.law.syntax import subformulas
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import Truth
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Blame, Decision

PROFILE = Profile(depth=3, requirements=1, captures=False, for_each=False)


@pytest.mark.law
def test_the_blamed_part_was_false():
    make = Maker("c", Compiler())
    blamed = 0
    for seed in range(60):
        for case in cases_of(f"blame/{seed}", PROFILE, TraceProfile(outages=10), 4):
            judgement = Judgement(case)
            report, _ = drive(make(case), case)
            for attempt in report.attempts:
                requirement = case.spec.requirements[attempt.requirement]
                named = {
                    format_formula(formula): formula
                    for part in subformulas(requirement.consequent)
                    for formula in (Unary(UnaryOp.NOT, part), part)
                }
                blame = attempt.blame
                if attempt.decision is Decision.PREFIX and blame and blame.subformula in named:
                    blamed += 1
                    start = start_of(judgement, attempt)
                    assert was_false(start, named[blame.subformula], attempt, blame), attempt
    assert blamed > 60


def start_of(judgement: Judgement, attempt: Attempt) -> Start:
    assert attempt.verdict is Verdict.FAIL
    followed = judgement.followings[attempt.requirement].attempts
    return next(other.start for other in followed if other.number == attempt.number)


def was_false(start: Start, formula: Formula, attempt: Attempt, blame: Blame) -> bool:
    """Whether a formula was false at the start of the blamed window or where it had to hold."""
    truths = Truths(start.word, start.captured)
    bare = formula
    while isinstance(bare, Unary) and bare.op is UnaryOp.NOT:
        bare = bare.operand
    interval = getattr(bare, "interval", None)
    first, last = blame.window
    instants = {first, first - (interval.low if interval else 0)}
    if last in (None, first):
        instants |= {*blame.at, attempt.decided, attempt.decided - 1}
    positions = [
        max((i for i, letter in enumerate(start.word.letters) if letter.instant <= t), default=0)
        for t in instants
    ]
    return any(truths.state(formula, position) is Truth.FALSE for position in positions)


def test_a_released_obligation_is_not_blamed():
    """`h` at 2 releases the obligation of 0; the start of the one that fails at 10 is unknown."""
    monitor = rvmon.loads(
        "time held\nsignal p, q : bool\nevent h\n"
        "requirement R\n  whenever p then h R[3 ns, inf) q\n"
    ).monitor()
    monitor.step_ns(0, {"p": True, "q": True})
    monitor.step_ns(2, {"h": True})
    (attempt,) = monitor.step_ns(10, {"q": False})
    assert attempt.blame is not None
    assert attempt.blame.window == (10, None)


def test_a_part_false_at_the_trigger_is_not_said_to_have_become_false():
    """Whether `e` occurred is known only at 9, and `p` was false all the time."""
    monitor = rvmon.loads(
        "time sampled\nsignal p : bool\nevent e\n"
        "requirement R\n  whenever once[1 ns, 5 ns] e then p\n"
    ).monitor()
    for t, values in (1, {"p": True}), (4, {"e": None}), (5, {"p": False}), (8, {"e": True}):
        assert not monitor.step_ns(t, values)
    (attempt,) = monitor.step_ns(9, {})
    assert attempt.triggered == 5
    assert attempt.reason == "`p` was false at 8 ns; it had to be true then"
