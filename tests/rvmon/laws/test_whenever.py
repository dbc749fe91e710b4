"""`whenever θ then ψ` with a known θ is `upon θ then ψ W !θ`."""

from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from msgspec import structs
from tests.rvmon.laws.tried import ONE, TRIED, judge, known_from_the_first
from tests.tools.build import always, end, no, p, requirement, two
from tests.tools.compare import Outcome, outcomes

from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Compare, Formula, SignalAtom
from rvmon.language.checked.specification import CheckedSpec, Mode
from rvmon.logic.state_formula import signals_of
from rvmon.testing.generate import signals
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.testing.law.attempts import is_pulse
from rvmon.testing.strategies import specs, traces
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report

pytestmark = pytest.mark.law


@TRIED
@given(specs(ONE), st.data())
def test_whenever_with_a_known_level_is_weak_until(spec: CheckedSpec, data: st.DataObject) -> None:
    [first] = spec.requirements.values()
    level = p if is_pulse(first.trigger) or data.draw(st.booleans()) else first.trigger
    assume(level != end)
    assume(not _asks_updates(first.consequent))
    whenever = replace(first, trigger=level, pulse=False, mode=Mode.WHENEVER)
    weak = two(first.consequent, "W", no(level))
    upon = replace(whenever, mode=Mode.UPON, consequent=weak)
    # Every signal has a value from the first sample on, and none is ever lost.
    spec = structs.replace(spec, signals=signals())
    case = known_from_the_first(data.draw(traces(spec, TraceProfile(unknowns=False))))
    # Even so, a trigger that reads payloads or `prev` may be unknown.
    told = [
        replace(case, spec=structs.replace(spec, requirements={r.id: r})) for r in (whenever, upon)
    ]
    assume(_known(told[0]))
    assert up_to_failure(judge(told[0])) == up_to_failure(judge(told[1]))


def up_to_failure(report: Report) -> list[Outcome]:
    """The attempts up to the first failure, after which a `whenever` episode continues."""
    found = sorted(outcomes(report).values(), key=lambda attempt: attempt.triggered)
    failed = [place for place, attempt in enumerate(found) if attempt.verdict is Verdict.FAIL]
    return found[: failed[0] + 1] if failed else found


def _asks_updates(formula: Formula) -> bool:
    """Whether it reads `prev` or the like, which count in favour while they have no value yet."""
    atoms = [part for part in subformulas(formula) if isinstance(part, SignalAtom | Compare)]
    return any(any(signals_of(atom).values()) for atom in atoms)


def _known(case: Case) -> bool:
    """Whether the trigger θ has a value everywhere, that is, `θ or not θ` holds throughout."""
    [required] = case.spec.requirements.values()
    asked = requirement(always(two(required.trigger, "or", no(required.trigger))))
    spec = structs.replace(case.spec, requirements={asked.id: asked})
    return all(a.decided is not None for a in judge(replace(case, spec=spec)).attempts)
