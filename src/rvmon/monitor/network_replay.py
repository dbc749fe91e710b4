"""Rebuilds the state of a network at an earlier instant, from the letters the core recorded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from struct import Struct

import msgspec

from rvmon.logic.formula import Constant, Sense
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.network import Network, Noted
from rvmon.monitor.network_reasons import NetworkRuns

_IN_WORD = 32


@lru_cache(maxsize=1024)
def truths(words: tuple[int, ...], count: int) -> tuple[int, ...]:
    """Unpack truth values, two bits each; cached, as a recording has few different words."""
    return tuple(words[place // _IN_WORD] >> 2 * (place % _IN_WORD) & 3 for place in range(count))


def words_for(count: int) -> int:
    """The number of words that `count` packed truth values take."""
    return -(-count // _IN_WORD)


class Letters(msgspec.Struct, frozen=True):
    """The recorded truth values of propositions, position by position."""

    # int64 words: for each position its number, then its packed truth values, two bits each
    pieces: tuple[bytes, ...]

    def read(self, count: int) -> Iterator[tuple[int, tuple[int, ...]]]:
        """Iterate over positions, each with the truth values of `count` propositions."""
        stride = Struct(f"={1 + words_for(count)}q")
        for piece in self.pieces:
            for position, *words in stride.iter_unpack(piece):
                yield position, truths(tuple(words), count)


def _truth(sense: Sense, value: int, *, better: bool) -> bool:
    """Evaluate a leaf, with UNKNOWN read optimistically (`better`) or pessimistically."""
    if value == UNKNOWN:
        return better and sense is not Sense.KNOWN_FALSE
    return value == (TRUE if sense is Sense.TRUE else FALSE)


def _noted(
    compiled: CompiledRequirement, gap: int | None, letters: Letters, position: int, *, better: bool
) -> Noted:
    """The letters to replay; those before `position` (ticks) only if the formula looks back.

    `better`: as the optimistic run reads them.
    """
    plan, propositions = compiled.network_plan, compiled.alphabet.propositions
    place = {state: number for number, state in enumerate(propositions)}
    leaves = [core for _, core in plan.leaves]

    def letter(truths: Sequence[int]) -> tuple[bool, ...]:
        return tuple(
            core.value
            if isinstance(core, Constant)
            else _truth(core.sense, truths[place[core.proposition]], better=better)
            for core in leaves
        )

    noted = [(t, letter(truths)) for t, truths in letters.read(len(propositions))]
    if noted and not plan.looks_back:
        # Letters before the position are irrelevant, except the one still held there.
        first = max((i for i, (t, _) in enumerate(noted) if t <= position), default=0)
        t, stays = noted[first]
        noted = [(t if gap is None else max(t, position), stays), *noted[first + 1 :]]
    return noted


def at_decision(
    compiled: CompiledRequirement,
    gap: int | None,
    letters: Letters | None,
    position: int,
    triggered: int,
    verdict: bool,
    t: int,
) -> Network | None:
    """Rebuild the network that decided an attempt, as it was at the decision.

    Args:
        compiled: the requirement.
        gap: ticks between two positions; `None` if only samples are positions.
        letters: the letters recorded for the attempt; `None` if none were kept.
        position: the position whose value decides the attempt, ticks.
        triggered: the instant of the trigger, ticks; later than `position` for `upon end`.
        verdict: the decision; the optimistic run decides a failure.
        t: the instant of the decision, ticks.
    """
    if letters is None:
        return None
    noted = _noted(compiled, gap, letters, position, better=not verdict)

    def network_at(stamp: int, before: int) -> Network:
        return Network(compiled.network_plan, gap, noted, position, stamp, before)

    if triggered > position == t:  # `upon end`: triggered once the letter of its position was known
        return network_at(2 * triggered, 2 * t + 1)
    if t == position:
        # Decided at its own position: only what became known since the previous letter is fresh.
        last = max((at for at, _ in noted if at < t), default=t - 1)
        return network_at(2 * t + 1, 2 * last + 1)
    # Knowledge from before the decision's instant is not fresh: it cannot be the cause.
    network = network_at(2 * t, 2 * t - 1)
    return network_at(2 * t + 1, 2 * t) if network.truth(position) is None else network


def at_moment(
    compiled: CompiledRequirement,
    gap: int | None,
    letters: Letters | None,
    position: int,
    now: int,
    count: int,
) -> NetworkRuns:
    """Rebuild both networks of an open attempt, pessimistic and optimistic, at the stamp `now`.

    The stamp is twice the instant in ticks, plus one if its letter is known; `count` attempts of
    the requirement are open. The other arguments are those of `at_decision`.
    """
    if letters is None:
        return NetworkRuns(None, None, count, gap)
    worse, better = (
        Network(
            compiled.network_plan,
            gap,
            _noted(compiled, gap, letters, position, better=better),
            position,
            now,
        )
        for better in (False, True)
    )
    return NetworkRuns(worse, better, count, gap)
