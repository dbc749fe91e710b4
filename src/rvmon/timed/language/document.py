"""A whole model as written."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.diagnostics import Source, Span
from rvmon.timed.language.automaton_syntax import Instance, QueryText, Template
from rvmon.timed.language.syntax import Declared, Expression, Name


@dataclass(frozen=True, slots=True)
class SignalText:
    """`signal name = value`: what a specification calls something of the model."""

    name: str
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Document:
    """A whole model as written.

    Attributes:
        unit: ticks of one unit of the model's time; `None` if it says nothing.
        system: the automata and templates that run, each with its priority; `None`: all that are
            there.
        open_ints: whether `int` without a range is allowed, as UPPAAL's 16 bits.
    """

    source: Source
    name: str
    title: str
    unit: int | None
    declarations: tuple[Declared, ...]
    templates: tuple[Template, ...]
    instances: tuple[Instance, ...]
    system: tuple[tuple[Name, int], ...] | None
    queries: tuple[QueryText, ...]
    signals: tuple[SignalText, ...] = ()
    open_ints: bool = False
