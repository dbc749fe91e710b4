"""Hypothesis strategies for random specifications and traces that shrink.

They need `hypothesis`, which rvmon does not install.
"""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import note
from hypothesis import strategies as st

from rvmon.language.checked.formula import Formula
from rvmon.language.checked.specification import CheckedSpec
from rvmon.testing.generate.formula import formula
from rvmon.testing.generate.numbers import Shape
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace, show_case

_ANY_SPEC = Profile()
_ANY_TRACE = TraceProfile()
_ANY_FORMULA = Shape()


class _Drawn:
    """An `Rng` that draws from Hypothesis."""

    def __init__(self, draw: Callable[[st.SearchStrategy[int]], int]) -> None:
        self._draw = draw

    def randint(self, a: int, b: int, /) -> int:
        """An integer from `a` to `b`."""
        return self._draw(st.integers(a, b))


@st.composite
def formulas(draw: st.DrawFn, shape: Shape = _ANY_FORMULA, *, depth: int = 3) -> Formula:
    """Formulas over the test vocabulary.

    Args:
        draw: given by Hypothesis.
        shape: the limits of the formulas.
        depth: the greatest nesting of operators.
    """
    return formula(_Drawn(draw), shape, draw(st.integers(0, depth)))


@st.composite
def specs(draw: st.DrawFn, profile: Profile = _ANY_SPEC) -> CheckedSpec:
    """Specifications over the test vocabulary, with bounds of a few ticks.

    Args:
        draw: given by Hypothesis.
        profile: the limits of the specifications.
    """
    return random_spec(_Drawn(draw), profile)


@st.composite
def traces(draw: st.DrawFn, spec: CheckedSpec, profile: TraceProfile = _ANY_TRACE) -> Case:
    """Traces for a given specification, biased towards its bounds and thresholds.

    Args:
        draw: given by Hypothesis.
        spec: the checked specification (`Spec.checked`); for the oracle, its bounds should be a few
            ticks.
        profile: the limits of the traces.
    """
    return _noted(random_trace(_Drawn(draw), spec, profile))


@st.composite
def cases(
    draw: st.DrawFn, profile: Profile = _ANY_SPEC, trace_profile: TraceProfile = _ANY_TRACE
) -> Case:
    """Specifications, each with a trace.

    Args:
        draw: given by Hypothesis.
        profile: the limits of the specifications.
        trace_profile: the limits of the traces.
    """
    rng = _Drawn(draw)
    return _noted(random_trace(rng, random_spec(rng, profile), trace_profile))


def _noted(case: Case) -> Case:
    """The case itself, which a failing test shows as text."""
    note(show_case(case))
    return case
