"""Ways to stay inside a formula for ever: by idling, by a deadlock, by going round.

Zones are coarsened up to bisimulation and distinguished exactly, since a loop of larger zones need
not be a loop of runs.

Source: Alur, Courcoubetis, Dill, Model-Checking in Dense Real-Time, 1993 (runs and loops); Bouyer,
Fahrenberg, Larsen, Markey, Ouaknine, Worrell, Model Checking Real-Time Systems, 2018, section 4.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rvmon.timed.runs.paths import stride_path
from rvmon.timed.runs.run import Ending
from rvmon.timed.search.loops import time_passes
from rvmon.timed.search.meter import Meter
from rvmon.timed.zones.dbm import Zone, cut
from rvmon.timed.zones.deadlock import Deadlocks, blurred, is_time_bounded
from rvmon.timed.zones.federation import before, negated, subtract_all, universe
from rvmon.timed.zones.stay import Crossing, Inside, Stand, StaySite, Stride


@dataclass(frozen=True, slots=True)
class Escape:
    """A way to stay inside for ever.

    Attributes:
        start: the site where it starts.
        strides: the moves from there, each with the site behind.
        crossings: after the last move.
        ending: what comes then.
        loop: number of strides before the loop, if it goes round.
    """

    start: StaySite
    strides: tuple[tuple[Stride, StaySite], ...]
    crossings: tuple[Crossing, ...]
    ending: Ending
    loop: int | None = None

    def until(self, count: int) -> Escape:
        """The way up to some number of strides."""
        return Escape(self.start, self.strides[:count], (), self.ending)


_Key = tuple[StaySite, tuple[float, ...]]


@dataclass(slots=True)
class _Frame:
    """A symbolic state on the way that is being looked at, and how the way comes to it."""

    link: tuple[Stride, StaySite] | None
    stand: Stand
    key: _Key
    onward: Iterator[tuple[Stride, Stand]]


class Staying:
    """A search for ways to stay inside; several starts share what is known to have none.

    Args:
        inside: the network as such runs see it.
        meter: counts the symbolic states.
        proper_only: whether a way counts only if time passes on it without bound.

    Attributes:
        met_improper: whether a way was passed by because time stops on it.
    """

    def __init__(self, inside: Inside, meter: Meter, *, proper_only: bool) -> None:
        self.met_improper = False
        self._inside = inside
        self._dim = inside.space.dim
        self._deadlocks = Deadlocks(inside.space)
        self._meter = meter
        self._proper_only = proper_only
        self._done: set[_Key] = set()
        self._keys: dict[_Key, _Key] = {}

    def find(self, start: Stand) -> Escape | None:
        """Search depth first from a stand for a way that counts."""
        way: list[_Frame] = []
        depth: dict[_Key, int] = {}
        escape = self._arrive(None, start, way, depth)
        while escape is None and way and not self._meter.stopped:
            step = next(way[-1].onward, None)
            if step is None:
                frame = way.pop()
                self._done.add(frame.key)
                del depth[frame.key]
            else:
                stride, stand = step
                escape = self._arrive((stride, stand.site), stand, way, depth)
        return escape

    def _arrive(
        self,
        link: tuple[Stride, StaySite] | None,
        stand: Stand,
        way: list[_Frame],
        depth: dict[_Key, int],
    ) -> Escape | None:
        key = self._key(stand)
        if key in self._done:
            return None
        here = Stand(stand.site, list(key[1]))
        frame = _Frame(link, here, key, self._inside.strides(here))
        if key in depth:
            return self._loop([*way, frame], depth[key])
        if not self._meter.count(len(way)):
            return None
        depth[key] = len(way)
        way.append(frame)
        return self._end(way)

    def _key(self, stand: Stand) -> _Key:
        """The symbolic state coarsened; many ways lead to equal ones."""
        met = (stand.site, tuple(stand.zone))
        key = self._keys.get(met)
        if key is None:
            zone = blurred(stand.site.state, stand.zone, self._dim)
            key = self._keys[met] = (stand.site, tuple(zone))
        return key

    def _loop(self, way: list[_Frame], first: int) -> Escape | None:
        """The loop whose first and last symbolic states are equal."""
        strides = _strides(way)
        head = way[first].stand
        steps = [step.timed for step in stride_path(head.site, strides[first:])]
        if time_passes(steps, head.zone, self._dim):
            return Escape(way[0].stand.site, strides, (), Ending.LOOP, first)
        return self._improper(Escape(way[0].stand.site, strides, (), Ending.ZENO_LOOP, first))

    def _end(self, way: list[_Frame]) -> Escape | None:
        """A way to stay in the last symbolic state without a further move."""
        start, improper = way[0].stand.site, None
        for here in self._inside.stands(way[-1].stand):
            site, crossings = here.site, here.crossings
            if not is_time_bounded(site.state) and not any(x == 0 for x, _, _ in site.constraint):
                return Escape(start, _strides(way), crossings, Ending.IDLE)
            if improper is None and self.stuck(site, here.zone):
                improper = Escape(start, _strides(way), crossings, Ending.TIME_LOCK)
        return None if improper is None else self._improper(improper)

    def _improper(self, escape: Escape) -> Escape | None:
        self.met_improper = True
        return None if self._proper_only else escape

    def stuck(self, site: StaySite, zone: Zone) -> list[Zone]:
        """The valuations from which no edge can be taken and time stops before the piece ends."""
        dim, state = self._dim, site.state
        stuck = self._deadlocks.dead(state, zone)
        if not stuck or not state.delays:
            return stuck
        leaving: list[Zone] = []
        invariant = [(0, clock, bound) for clock, bound in state.invariant]
        for x, y, bound in site.constraint:
            if x == 0:
                beyond = universe(self._dim)
                if cut(beyond, dim, [*invariant, (y, x, negated(bound))]):
                    leaving.append(before(beyond, dim))
        return subtract_all(stuck, leaving, dim)


def _strides(way: list[_Frame]) -> tuple[tuple[Stride, StaySite], ...]:
    return tuple(frame.link for frame in way if frame.link is not None)
