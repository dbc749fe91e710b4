"""What a run was not given: names that were lost for a while, samples that came too late."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rvmon import native
from rvmon.monitor.core.planned import PlannedCore
from rvmon.monitor.inputs.intake import Intake, Turn
from rvmon.spec.checked.selection import sources_asked
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.time import TIME_LIMIT, whole_ticks

ANY = "samples"
"""What input health is said of where it is not known what was lost."""

_UNREAD = ""
"""For names that no requirement reads: in sampled time what is lost of them is a position."""


_MOST_TOLD = 1_000
"""With more entries of input health, reasons that were not heard of are told as one."""


class Losses:
    """Has names of a run lost and found, and keeps what is said of it (SEMANTICS 1 and 6).

    Args:
        checked: the specification.
        planned: the plan of its requirements.
        core: the run.
        intake: holds samples back; `None`: nothing does.
    """

    def __init__(
        self,
        checked: CheckedSpec,
        planned: PlannedCore,
        core: native.Monitor,
        intake: Intake | None,
    ) -> None:
        self._checked = checked
        self._planned = planned
        self._core = core
        self._intake = intake
        self._lost: set[str] = set()
        self._missed: set[str] = set()
        self._stretches: Counter[str] = Counter()
        self._seen: dict[tuple[HealthKind, str, str], tuple[int, int]] = {}

    @property
    def awaits_sample(self) -> bool:
        """Whether what was missed ends with the next sample."""
        return bool(self._missed)

    def lose(
        self, names: Iterable[str] | None, since: int, until: int | None, why: str
    ) -> Sequence[Turn]:
        """What is to be done so that names are lost; see `rvmon.monitor.core.feed.FedMonitor`."""
        some = self._named(names)
        self._note(HealthKind.DROPPED, None if names is None else some, since, why)
        if until is None:
            some, self._lost = some - self._lost, self._lost | some
        return self._stretch(some, since, until)

    def find(self, names: Iterable[str] | None, at: int) -> Sequence[Turn]:
        """What is to be done so that they are lost no more behind an instant."""
        some = self._named(names) & self._lost
        self._lost -= some
        return self._end(some, at)

    def miss(self, names: Iterable[str] | None, since: int | None, why: str) -> Sequence[Turn]:
        """What is to be done as a sample was lost behind `since`; `None`: before all others."""
        some = self._named(names)
        if since is None:
            self.come_late(names, 0, why)
            return ()
        self._note(HealthKind.DROPPED, None if names is None else some, since, why)
        some, self._missed = some - self._missed, self._missed | some
        return self._stretch(some, since + (self._intake is None), None)

    def end_missed(self, t: int) -> Sequence[Turn]:
        """What is to be done before the next sample, which is at `t`."""
        some, self._missed = self._missed, set()
        return self._end(some, t - (self._intake is None))

    def come_late(self, names: Iterable[str] | None, t: int, why: str) -> None:
        """A sample with such names came behind what was judged, or (`None`) may have."""
        some = None if names is None else self._named(names)
        self._note(HealthKind.LATE, some, t, why)
        self._core.late(None if some is None else self._numbers(some), t)

    def turn(self, one: Turn) -> None:
        """Have the core lose or find names; all before was judged."""
        was = {name for name in one.names if self._stretches[name]}
        self._stretches.update(dict.fromkeys(one.names, 1 if one.lost else -1))
        some = {name for name in one.names if bool(self._stretches[name]) is not (name in was)}
        tell = self._core.lose if one.lost else self._core.found
        if _UNREAD in some:
            tell([], one.t)
        if numbers := self._numbers(some):
            tell(numbers, one.t)

    def _stretch(self, names: set[str], since: int, until: int | None) -> Sequence[Turn]:
        """From when to when they are lost, as far as that is not judged yet."""
        if not names:
            return ()
        delay, floor = self._delay_and_floor()
        since = since - delay
        if since < floor:
            self._core.late(self._numbers(names), since)
            if until is not None and until + delay < floor:
                return ()
        made = [Turn(max(since, floor), tuple(sorted(names)), lost=True)]
        return made if until is None else [*made, *self._end(names, until)]

    def _end(self, names: set[str], at: int) -> Sequence[Turn]:
        if not names:
            return ()
        delay, floor = self._delay_and_floor()
        return [Turn(max(at + delay, floor), tuple(sorted(names)), lost=False)]

    def _delay_and_floor(self) -> tuple[int, int]:
        """By how much stretches are wider, and the first instant that is not judged yet."""
        if self._intake is not None:
            return self._intake.delay, self._intake.floor
        _, last, reached = self._core.times()
        behind = -TIME_LIMIT if last is None else last + 1
        return 0, behind if reached is None else max(behind, reached)

    def _named(self, names: Iterable[str] | None) -> set[str]:
        """Names as far as a requirement reads them; `_UNREAD` if none does.

        Raises:
            UnknownNameError: one is not declared.
        """
        known = self._planned.numbers.keys()
        asked = sources_asked(self._checked, names)
        return {*known} if asked is None else {*(asked & known)} or {_UNREAD}

    def known(self, names: Iterable[Any]) -> set[str]:
        """Names that are lost in a snapshot; it raises `KeyError` if one cannot be."""
        return {name for name in names if name == _UNREAD or self._planned.numbers[name] >= 0}

    def _numbers(self, names: Iterable[str]) -> list[int]:
        return [self._planned.numbers[name] for name in names if name != _UNREAD]

    def _note(self, kind: HealthKind, names: Iterable[str] | None, t: int, why: str) -> None:
        if len(self._seen) >= _MOST_TOLD and not any(why == known for _, _, known in self._seen):
            why = "for other reasons"
        for name in (ANY,) if names is None else sorted({*names} - {_UNREAD}):
            count, first = self._seen.get((kind, name, why), (0, t))
            self._seen[kind, name, why] = (count + 1, min(first, t))

    def health(self) -> list[Health]:
        """What was lost, and why."""
        readers = {ANY: tuple(self._planned.packed.ids), **self._planned.readers}
        return [
            Health(kind, name, count, first, readers.get(name, ()), why)
            for (kind, name, why), (count, first) in self._seen.items()
        ]

    def state(self) -> Mapping[str, Any]:
        """What is lost, as JSON has it."""
        return {
            "lost": sorted(self._lost),
            "missed": sorted(self._missed),
            "stretches": +self._stretches,
            "seen": [[*key, *found] for key, found in self._seen.items()],
        }

    def take_up(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state` gave."""
        self._lost, self._missed = self.known(state["lost"]), self.known(state["missed"])
        for name in self.known(state["stretches"]):
            self._stretches[name] = whole_ticks(state["stretches"][name])
        for kind, name, why, count, first in state["seen"]:
            key = (HealthKind(kind), str(name), str(why))
            self._seen[key] = (whole_ticks(count), whole_ticks(first))
