"""What is shown of a case can be read back: a counterexample is one's own `.rv` file."""

import pytest
from tests.tools.build import e, eventually, p, requirement, spec_of, timeline
from tests.tools.compare import differences
from tests.tools.differential import case_of
from tests.tools.law import judge

import rvmon
from rvmon.language.checked.specification import Requirement
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, show_case, show_spec
from rvmon.testing.oracle import evaluate

NOT_WRITTEN = {"RV022", "RV023", "RV025", "RV042"}
"""What random specs hold and the language refuses: `rate(x)` compared with a number that is not
per second, a division by the literal 0; beside these a warning."""


def read_back(seed: int) -> bool:
    """Whether the spec of a seed can be written in the language; if so, it has to mean the same."""
    case = case_of(f"show {seed}", Profile(), TraceProfile())
    try:
        spec = rvmon.loads(show_spec(case.spec))
    except rvmon.SpecError as error:
        unexpected = {found.code for found in error.diagnostics} - NOT_WRITTEN
        if unexpected:
            raise
        return False
    wanted, got = case.spec.requirements, spec.checked.requirements
    assert list(wanted) == list(got)
    assert [summary(found) for found in wanted.values()] == [summary(r) for r in got.values()]
    again = evaluate(spec, case.samples, end=case.end, advances=case.advances, names=case.names)
    assert differences(judge(case), again) == []
    return True


def summary(found: Requirement) -> tuple[object, ...]:
    return found.mode, found.at_end, found.pulse, found.captures, found.for_each


@pytest.mark.slow
def test_specs_are_read_back() -> None:
    read = sum(read_back(seed) for seed in range(120))
    assert read > 100


def test_a_case_is_shown_with_its_calls() -> None:
    required = requirement(eventually(p, 0, 3), upon=e)
    case = Case(spec_of(required, stale={"x": 2}), (*timeline(p="0", e="1"), 4), 9, frozenset("pe"))
    text = show_case(case)
    for line in (
        "time held",
        "signal x : real stale after 2 ns",
        "event g(k: int)",
        "  upon e",
        "  then within 3 ns p",
        "sources: e, p",
        "sample     0  {'p': False, 'e': True}",
        "advance    4",
        "finish     9",
    ):
        assert line in text.splitlines()
