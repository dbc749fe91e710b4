"""How a finished trace is to be read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict

from rvmon.trace.schema import Schema


class SchemaArguments(TypedDict, total=False):
    """The arguments of `Spec.reading`; it says what they mean."""

    time: str | None
    columns: Mapping[str, str] | None
    nan: str | None
    no_update: Any
    binding: str | Path | None
    clock: str | None


class ReadingArguments(SchemaArguments, total=False):
    """The arguments that `Spec.evaluate` and its kin have in common; it says what they mean."""

    sources: Iterable[str] | None
    allow_missing: bool | Iterable[str]


@dataclass(frozen=True, slots=True)
class Reading:
    """What `Spec.evaluate` and its kin are given about a trace.

    Attributes:
        schema: the declared names, and how the trace gives them.
        sources: the signals and events that can arrive; `None`: those that the trace has.
        allowed: the names that a trace in columns may lack though requirements read them; whether
            all.
    """

    schema: Schema
    sources: frozenset[str] | None = None
    allowed: bool | tuple[str, ...] = False
