"""Networks as they stood, from the letters that the core kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from struct import Struct

from rvmon.dataflow.network import Network
from rvmon.dataflow.time_decisions import Moment
from rvmon.formula.core import Constant, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.explained.network import NetworkRuns

_IN_WORD = 32


@dataclass(frozen=True, slots=True)
class Letters:
    """Truths of propositions at positions, in pieces.

    Attributes:
        pieces: of words: a position, then its truths, and so on.
    """

    pieces: tuple[bytes, ...]

    def read(self, count: int) -> Iterator[tuple[int, tuple[int, ...]]]:
        """The positions, with the truths of so many propositions."""
        stride = Struct(f"={1 + -(-count // _IN_WORD)}q")
        for piece in self.pieces:
            for position, *words in stride.iter_unpack(piece):
                yield (
                    position,
                    tuple(
                        words[place // _IN_WORD] >> 2 * (place % _IN_WORD) & 3
                        for place in range(count)
                    ),
                )


def _truth(sense: Sense, value: int, *, better: bool) -> bool:
    """Whether a leaf is true, the unknown taken for the better or for the worse."""
    if value == UNKNOWN:
        return better and sense is not Sense.KNOWN_FALSE
    return value == (TRUE if sense is Sense.TRUE else FALSE)


class _Replay:
    """A network that is given the letters from a position on.

    Args:
        compiled: the requirement.
        gap: ticks between two positions; `None` if only samples are positions.
        letters: of the judge.
        position: what is asked for.
        better: whether the unknown is taken for the better.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        gap: int | None,
        letters: Letters,
        position: int,
        *,
        better: bool,
    ) -> None:
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
        self.network = Network(plan, gap)
        self._position = position
        if noted and not plan.looks_back:
            # What came before the position does not matter; a letter that stays does till there.
            first = max((i for i, (t, _) in enumerate(noted) if t <= position), default=0)
            t, stays = noted[first]
            noted = [(t if gap is None else max(t, position), stays), *noted[first + 1 :]]
        if noted and position < noted[0][0]:
            t, stays = noted[0]
            step = gap or 1
            self.network.begin_at(t // step, position // step, stays)
        self._noted = noted

    def last_before(self, t: int) -> int:
        """The last instant before another at which there was a letter, or just that before it."""
        return max((at for at, _ in self._noted if at < t), default=t - 1)

    def grow(self, stamp: int) -> None:
        """Let time come to a stamp; letters behind it are not known yet."""
        known = (stamp - 1) // 2
        given = 0
        for t, letter in self._noted:
            if t > known:
                break
            self.network.note(t, letter)
            given += 1
        del self._noted[:given]
        self.network.grow(stamp, self._position)


def at_decision(
    compiled: CompiledRequirement,
    gap: int | None,
    letters: Letters | None,
    position: int,
    triggered: int,
    verdict: bool,
    t: int,
) -> Network | None:
    """The network that decided, as it stood then.

    Args:
        compiled: the requirement.
        gap: ticks between two positions; `None` if only samples are positions.
        letters: by which it judged; `None`: they are not known.
        position: the instant of the position whose value was waited for, ticks.
        triggered: the instant of the trigger; behind the position if that was the end of the trace.
        verdict: the decision: what fails is decided by the run for the better.
        t: its instant.
    """
    if letters is None:
        return None
    replay = _Replay(compiled, gap, letters, position, better=not verdict)
    if t == position:
        # It was known as the attempt began, perhaps before that: since the letter before.
        replay.grow(2 * replay.last_before(t) + 1)
        replay.grow(2 * t + 1)
        if triggered > position:
            replay.grow(2 * triggered)
        return replay.network
    # What became known by then is no news at the decision.
    replay.grow(2 * t - 1)
    replay.grow(2 * t)
    if replay.network.truth(position) is None:
        replay.grow(2 * t + 1)
    return replay.network


def at_moment(
    compiled: CompiledRequirement,
    gap: int | None,
    letters: Letters | None,
    position: int,
    now: int,
    count: int,
) -> NetworkRuns:
    """The networks of an open attempt at a stamp.

    Args:
        compiled: as for `at_decision`.
        gap: see there.
        letters: see there.
        position: see there.
        now: the stamp.
        count: how many attempts are open.
    """
    if letters is None:
        return NetworkRuns(None, None, count, gap)
    moments = []
    for better in (False, True):
        replay = _Replay(compiled, gap, letters, position, better=better)
        replay.grow(now)
        moments.append(Moment(replay.network, now))
    return NetworkRuns(moments[0], moments[1], count, gap)
