"""A survivor as a question: is a stimulus missing, an observation, or a requirement?

Source: Voas 1992, PIE: A Dynamic Failure-Based Technique (a fault is seen if it is executed,
infects the state, and the infection propagates).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum

from rvmon.cdv.mutation.record import Difference
from rvmon.cdv.mutation.tried import Tried
from rvmon.spec.checked.reads import names_of_requirement
from rvmon.spec.checked.specification import CheckedSpec


class Missing(StrEnum):
    """What may be missing where a mutant survives."""

    REQUIREMENT = "requirement"
    OBSERVATION = "observation"
    STIMULUS = "stimulus"


TITLES = {
    Missing.REQUIREMENT: "The run differs, and no requirement fails: is a requirement missing?",
    Missing.OBSERVATION: (
        "It runs, and nothing that is recorded differs: is an observation missing, or a stimulus, "
        "or is it equivalent?"
    ),
    Missing.STIMULUS: "No test runs it: is a stimulus missing?",
}


def missing(survivor: Tried) -> Missing:
    """What may be missing where a mutant survives."""
    if not survivor.reaching:
        return Missing.STIMULUS
    return Missing.OBSERVATION if survivor.difference is None else Missing.REQUIREMENT


def readers(spec: CheckedSpec) -> dict[str, list[str]]:
    """The requirements that read a signal or event, by its name."""
    found: dict[str, list[str]] = {}
    for requirement in spec.requirements.values():
        for name in sorted(set(names_of_requirement(requirement))):
            found.setdefault(name, []).append(requirement.id)
    return found


def question(survivor: Tried, reading: Mapping[str, Sequence[str]]) -> str:
    """What a survivor asks, in a sentence.

    Args:
        survivor: a mutant that is not killed.
        reading: as `readers` gives it.

    >>> from pathlib import Path
    >>> from rvmon.cdv.mutation.mutant import Mutant
    >>> mutant = Mutant(Path("a.py"), 3, "constant", "x = 3", "x = 4", "x = 4")
    >>> question(Tried(mutant, 2, 2, (), Difference("t", 1_500_000_000, "beep", "", "True")), {})
    'in `t` the run differs at 1.5 s in `beep` (none → True), which no requirement reads'
    """
    if survivor.difference is not None:
        return _differs(survivor.difference, reading)
    if survivor.reaching == 1:
        return "one test runs it, and nothing that is recorded differs"
    if survivor.reaching:
        return f"{survivor.reaching} tests run it, and nothing that is recorded differs"
    return "no test runs it"


def _differs(found: Difference, reading: Mapping[str, Sequence[str]]) -> str:
    instant = f"{found.t_ns / 1e9:.9g} s"
    if not found.name:
        return f"in `{found.test}` the run ends at {instant}, and no requirement fails"
    values = f"{found.was or 'none'} → {found.now or 'none'}"
    text = f"in `{found.test}` the run differs at {instant} in `{found.name}` ({values}), which "
    own = reading.get(found.name, ())
    text += f"{', '.join(own)} read{'s' * (len(own) == 1)}" if own else "no requirement reads"
    if found.verdicts:
        changes = ", ".join(f"{name} {was} → {now}" for name, was, now in found.verdicts)
        text += f"; verdicts differ, but none is a failure: {changes}"
    return text
