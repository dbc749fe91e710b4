"""Which bins of coverpoints and crosses a trace hits, from the definition: position by position."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from rvmon.spec.checked.formula import Formula
from rvmon.spec.checked.goals import Bin
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.law.kleene import Truth, conjunction
from rvmon.testing.law.pulse import is_pulse
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import Word

Found = dict[tuple[str, ...], tuple[int, int]]
"""By combination of bins, how often it was hit and when first."""


def hits_on(spec: CheckedSpec, word: Word) -> dict[str, Found]:
    """What a word hits, by the name of the coverpoint or cross; what hits nothing is left out.

    Args:
        spec: has the coverpoints and crosses.
        word: the trace, position by position.
    """
    found = {
        point.name: _hits(word, [point.bins], point.upon) for point in spec.coverpoints.values()
    }
    for cross in spec.crosses.values():
        axes = [spec.coverpoints[name].bins for name in cross.points]
        found[cross.name] = _hits(word, axes, cross.upon)
    return {name: own for name, own in found.items() if own}


def _hits(word: Word, axes: Sequence[Sequence[Bin]], upon: Formula | None) -> Found:
    found: Found = {}
    for bins in product(*axes):
        truths = [
            conjunction([_truth(word, bin_.formula, k) for bin_ in bins])
            for k in range(len(word.letters))
        ]
        if upon is not None:
            instants = [k for k in _starts(word, upon) if truths[k] is Truth.TRUE]
        elif any(is_pulse(bin_.formula) for bin_ in bins):
            instants = [k for k, truth in enumerate(truths) if truth is Truth.TRUE]
        else:
            instants = [*_stretches(truths)]
        if instants:
            name = tuple(bin_.name for bin_ in bins)
            found[name] = (len(instants), word.letters[instants[0]].instant)
    return found


def _truth(word: Word, formula: Formula, k: int) -> Truth:
    """As of a trigger: what is not born is false."""
    found = Truths(word, {}).state(formula, k)
    return Truth.FALSE if found is Truth.UNBORN else found


def _starts(word: Word, upon: Formula) -> list[int]:
    """Where an attempt `upon` it would surely start."""
    truths = [_truth(word, upon, k) for k in range(len(word.letters))]
    return [
        k
        for k, truth in enumerate(truths)
        if truth is Truth.TRUE and (is_pulse(upon) or k == 0 or truths[k - 1] is Truth.FALSE)
    ]


def _stretches(truths: Sequence[Truth]) -> list[int]:
    """Where it is true, and was false since it last was, or was never true."""
    found = []
    for k, truth in enumerate(truths):
        if truth is not Truth.TRUE:
            continue
        earlier = [j for j in range(k) if truths[j] is Truth.TRUE]
        if not earlier or any(truths[j] is Truth.FALSE for j in range(earlier[-1], k)):
            found.append(k)
    return found
