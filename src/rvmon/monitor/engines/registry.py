"""Which engines there are, and what all of them do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from rvmon.errors import UnknownNameError

if TYPE_CHECKING:
    from rvmon.monitor.compiled.refusal import Refusal
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.monitor.online.monitor import Monitor
    from rvmon.readers.source import Source
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report

_HOMES = {
    "auto": "auto",
    "columns": "columns",
    "python": "python",
    "automaton": "tables",
    "progression": "tables",
    "network": "tables",
    "c": "c",
}
"""By name of the engine the module of this package that has it: it is imported when asked for."""

ENGINES = tuple(_HOMES)


@dataclass(frozen=True, slots=True)
class Asked:
    """What is wanted of an engine.

    Attributes:
        only: ids of the requirements; `None`: all.
        settle: when a sample is taken for complete: `now`, or by the `next` stamp.
        sources: the signals and events that can arrive; `None`: all.
        keep: so many records of each verdict are kept per requirement; `None`: all.
        decided: called with the attempts as they are decided, where samples are judged one by one.
    """

    only: tuple[str, ...] | None = None
    settle: str = "now"
    sources: frozenset[str] | None = None
    keep: int | None = None
    decided: Callable[[Sequence[Attempt]], object] = len


class Engine(Protocol):
    """What judges requirements."""

    @property
    def name(self) -> str:
        """By which a caller asks for it."""

    def refuses(self, requirement: CompiledRequirement) -> Refusal | None:
        """Why it does not judge a requirement; `None` if it does."""

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """What judges a stream.

        Raises:
            RvmonError: it cannot judge a requirement, or do what is asked.
        """

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """Judge a recording.

        Raises:
            RvmonError: it cannot judge a requirement, or such a recording.
            TraceError: the recording cannot be read.
        """


def engine_named(name: str) -> Engine:
    """The engine of a name.

    Raises:
        UnknownNameError: there is none; those that there are are named.
    """
    if name not in _HOMES:
        raise UnknownNameError(f"no engine `{name}`: there are {', '.join(ENGINES)}")
    found: Mapping[str, Engine] = import_module(f"rvmon.monitor.engines.{_HOMES[name]}").ENGINES
    return found[name]
