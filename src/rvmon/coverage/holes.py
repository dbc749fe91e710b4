"""Explains holes: the item in words, why it may be open, the nearest test, what would close it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from operator import eq

from msgspec import Struct

from rvmon.coverage import PAIRS, STATES, TRANSITIONS, Group, Hits, Model, Subject, count_of
from rvmon.coverage.requirements import AT, JUST_BEFORE, PASSED, TRIGGERED, locations_of

Goal = tuple[str, str]  # an item of the model, by its group and name

_ARROW = " → "
_PART = re.compile(r"(?:^| × )(?:`([^`]*)`|([^`×]*?))(?= × |$)")


def nearest_tests(
    goals: Iterable[Goal], tests: Sequence[tuple[str, Hits]], model: Model
) -> dict[Goal, str]:
    """The test that came nearest to each item (the first of equals); absent if none came near."""
    names = {}
    for goal in goals:
        near, name = max(
            ((nearness(goal, hits, model), name) for name, hits in tests),
            key=lambda one: one[0],
            default=(0.0, ""),
        )
        if near:
            names[goal] = name
    return names


def nearness(goal: Goal, hits: Hits, model: Model) -> float:
    """The share of the preconditions of an item that a test met, from 0 to 1.

    For a combination of bins, this is the largest share of bins in common with a combination that
    was hit; for a transition, whether its source was reached; for a statement or branch, how near
    to its line the test came; for anything else, the share of its group that was hit.
    """
    group = model.groups[goal[0]]
    seen = hits.get(group.name, {})
    match group.subject:
        case Subject.CROSS:
            return _most_in_common(cross_parts(goal[1]), seen) / max(1, len(group.axes))
        case Subject.TRANSITIONS:
            return _near_transition(goal, hits)
        case Subject.STATEMENTS | Subject.BRANCHES:
            return _near_code(goal, hits)
        case _:
            return len(seen) / max(1, len(group.items))


def cross_parts(name: str) -> list[str]:
    """The bins in the name of a combination; inverse of `combination`.

    >>> cross_parts("yes × `a × b`")
    ['yes', 'a × b']
    """
    return [quoted or plain for quoted, plain in _PART.findall(name)]


def _most_in_common(bins: Sequence[str], seen: Iterable[str]) -> int:
    """The most bins that a combination shares with any of those in `seen`."""
    met = (sum(map(eq, bins, cross_parts(name))) for name in seen)
    return max(met, default=0)


def _near_transition(goal: Goal, hits: Hits) -> float:
    """Nearness to a transition: whether its source was reached; to a pair: how much was taken."""
    names = goal[1].split(_ARROW)
    way = names[:-1]
    if goal[0].startswith("`"):  # an automaton's edge: its locations are a group of their own
        places = hits.get(goal[0].replace(" edges", " locations"), {})
        return float(way[-1] in places)
    if len(way) == 1:
        return float(way[0] in hits.get(STATES, {}))
    gone = hits.get(TRANSITIONS, {})
    first, second = (_ARROW.join(pair) for pair in pairwise(names))
    met = (first in gone) + (second in gone)
    # Self-transitions of the middle state separate the two, so fewer of them are nearer.
    again = gone.get(_ARROW.join((names[1], names[1])))
    return (met + 1 / (1 + (again.count if again else 0))) / 3


def _near_code(goal: Goal, hits: Hits) -> float:
    """Nearness to a line: 1 if it ran (a branch), else by the distance from the last that ran."""
    block = goal[0].partition(" of ")[2]
    lines = {int(line) for line in hits.get(f"statements of {block}", {})}
    line = int(goal[1].partition(_ARROW)[0])
    if line in lines:
        return 1.0
    # Always below 1, as the line itself did not run.
    before = [one for one in lines if one < line]
    return 0.9 / (1 + line - max(before)) if before else 0.0


_DECIDES = " decides"


class Hole(Struct, frozen=True):
    """An uncovered item in words."""

    what: str  # the item
    why: str  # why it is not covered, as far as the hits of all tests show
    needs: str  # what would cover it
    nearest: str = ""  # the nearest test; "" if none came near

    def __str__(self) -> str:
        near = f" Nearest: {self.nearest}." if self.nearest else ""
        why = f"{self.why[0].upper()}{self.why[1:]}"
        return f"{self.what}. {why}; needs {self.needs}.{near}"


def hole_of(goal: Goal, model: Model, hits: Hits, nearest: str = "") -> Hole:
    """Explain a hole, an item with fewer hits than its goal, from the hits of all tests together.

    >>> from rvmon.coverage import Item, group_of, model_of
    >>> from rvmon.coverage import Hit
    >>> ways = group_of("transitions", Subject.TRANSITIONS, [Item("up → down")])
    >>> states = group_of("states", Subject.STATES, [Item("up"), Item("down")])
    >>> hits = {"states": {"up": Hit(3)}}
    >>> print(hole_of(("transitions", "up → down"), model_of([states, ways]), hits, "lift-2"))
    `up` is followed by `down`. `up` was entered 3 times, but left another way; needs a run in \
which `down` follows `up`. Nearest: lift-2.
    """
    group = model.groups[goal[0]]
    item = group.items[goal[1]]
    count = count_of(hits, *goal)
    if count:
        what = item.text or f"`{item.name}` of `{group.name}`"
        return Hole(what, f"hit {count} times of {item.goal}", "more tests like those", nearest)
    words: tuple[str, str, str]
    if group.name.startswith("`"):
        words = _of_automaton(group, item.name, item.text, hits)
    else:
        match group.subject:
            case Subject.CROSS:
                words = _of_cross(group, item.name, model, hits)
            case Subject.STATEMENTS | Subject.BRANCHES:
                words = _of_code(group, item.name, item.text, hits)
            case Subject.REQUIREMENT:
                words = _of_requirement(group, item.name, hits)
            case Subject.TRANSITIONS if group.name in (TRANSITIONS, PAIRS):
                words = _of_transition(item.name.split(_ARROW), hits)
            case Subject.STATES if group.name == STATES:
                words = (f"state `{item.name}`", "it was never entered", "a run that enters it")
            case _:
                what = f"`{item.text}`" if item.text else f"`{item.name}`"
                words = (what, "no run has shown it", "a run that shows it")
    return Hole(*words, nearest)


def _of_cross(group: Group, name: str, model: Model, hits: Hits) -> tuple[str, str, str]:
    bins = cross_parts(name)
    named = [*zip(group.axes, bins, strict=True)]
    never = [
        f"{axis} {bin_}"
        for axis, bin_ in named
        if axis in model.groups and not count_of(hits, axis, bin_)
    ]
    most = _most_in_common(bins, hits.get(group.name, {}))
    why = f"no run has shown {' or '.join(never)}"
    if not never:
        why = f"each was seen, but at most {most} of {len(bins)} at once"
    together = ", ".join(f"{axis} {bin_}" for axis, bin_ in named)
    return f"at one instant {together}", why, "a run with all of them at once"


def _of_transition(states: Sequence[str], hits: Hits) -> tuple[str, str, str]:
    what = ", then ".join(f"`{one}` is followed by `{other}`" for one, other in pairwise(states))
    for source, target in pairwise(states):
        if len(states) > 2 and count_of(hits, TRANSITIONS, _ARROW.join((source, target))):
            continue
        entered = count_of(hits, STATES, source)
        why = f"`{source}` was entered {_times(entered)}, but left another way"
        if not entered:
            why = f"`{source}` was never entered"
        return what, why, f"a run in which `{target}` follows `{source}`"
    return what, "both were seen, but never one right after the other", "a run with both in a row"


def _of_code(group: Group, name: str, text: str, hits: Hits) -> tuple[str, str, str]:
    block = group.name.partition(" of ")[2]
    first, _, last = name.partition(_ARROW)
    ran = sorted(map(int, hits.get(f"statements of {block}", {})))
    if last:
        what = f"`{block}`, line {first}: `{text}`"
        if int(first) in ran:
            return what, f"line {first} ran, but took another way", "a run that takes this one"
        return what, f"line {first} never ran", "a run that reaches it"
    what = f"`{block}`, line {first}: `{text}`"
    before = [line for line in ran if line < int(first)]
    if not before:
        return what, "nothing of the block before it ran", f"a run that enters `{block}`"
    why = f"line {before[-1]} before it ran, but did not lead there"
    return what, why, f"a run that continues from line {before[-1]} to it"


def _of_requirement(group: Group, name: str, hits: Hits) -> tuple[str, str, str]:
    what = f"{group.name}, “{group.title}”: " if group.title else f"{group.name}: "
    triggered = count_of(hits, group.name, TRIGGERED)
    if name == TRIGGERED:
        return f"{what}it is triggered", "its trigger never occurred", "a run in which it occurs"
    if name == PASSED:
        what += "it passes"
        needs = "a run in which it is triggered and passes"
    elif name in (JUST_BEFORE, AT):
        what += f"the response comes {name}"
        needs = "a response as late as allowed"
    else:
        part = name.removesuffix(_DECIDES)
        what += f"{part} makes the difference"
        needs = (
            f"a run that would have another verdict, or another decision instant, without {part}"
        )
    if not triggered:
        return what, "it was never triggered", needs
    return what, f"it was triggered {_times(triggered)}, but never like this", needs


def _of_automaton(group: Group, name: str, text: str, hits: Hits) -> tuple[str, str, str]:
    requirement = group.name.split("`")[1]
    of = f"{requirement}, “{group.title}”" if group.title else requirement
    if group.subject is Subject.STATES:
        required = f", where it still requires: {text}" if text else ""
        why, needs = "no attempt was there", "a run in which an attempt gets there"
        return f"{of}: location {name} of its automaton{required}", why, needs
    source = name.partition(_ARROW)[0]
    was_there = count_of(hits, locations_of(requirement), source)
    attempts = "1 attempt was" if was_there == 1 else f"{was_there:,} attempts were"
    why = f"{attempts} in {source}, but took another way"
    if not was_there:
        why = f"no attempt was in {source}"
    upon = f", upon: {text}" if text else ""
    return f"{of}: step {name} of its automaton{upon}", why, "a run that takes it"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count:,} times"
