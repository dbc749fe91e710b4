"""What `auto` takes for a requirement, and why: the fastest engine that does not refuse it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.monitor.compiled import refusal
from rvmon.monitor.compiled.refusal import Refusal
from rvmon.monitor.compiled.requirement import CompiledRequirement


@dataclass(frozen=True, slots=True)
class EngineChoice:
    """What `auto` takes for a requirement.

    Attributes:
        online: the engine that judges it in a stream, and in recordings sample by sample.
        recording: the engine that judges it in a recording of plain columns.
        refused: by name of a faster engine, or of `c`, why not that.
    """

    online: str
    recording: str
    refused: Mapping[str, Refusal]


def choices(requirements: Sequence[CompiledRequirement]) -> Mapping[str, EngineChoice]:
    """What `auto` takes, by id.

    Never `c`, which makes no snapshots.

    Args:
        requirements: that are judged together.
    """
    return {one.requirement.id: _choice(one, len(requirements)) for one in requirements}


def _choice(one: CompiledRequirement, count: int) -> EngineChoice:
    online, refused = _online(one, count)
    of_columns = refusal.of_columns(one)
    refusals = {"columns": of_columns, **refused}
    return EngineChoice(
        online,
        "columns" if of_columns is None else online,
        {name: reason for name, reason in refusals.items() if reason is not None},
    )


def judged_by(requirements: Sequence[CompiledRequirement]) -> str:
    """The engines that `auto` takes in a stream, as reports say them.

    Args:
        requirements: that are judged together.
    """
    found = {_online(one, len(requirements))[0] for one in requirements}
    return ", ".join(sorted(found, key=("python", "automaton", "network").index))


def _online(one: CompiledRequirement, count: int) -> tuple[str, dict[str, Refusal]]:
    """The engine, and why not a faster one."""
    many = refusal.too_many(count) if count > refusal.MOST_GENERATED else None
    of_python = refusal.of_generated(one) or many
    if of_python is None:
        return "python", {}
    of_automaton = refusal.of_automaton(one)
    if one.engine("auto") == "automaton":
        return "automaton", {"python": of_python}
    return "network", {"python": of_python, "automaton": of_automaton or of_python}
