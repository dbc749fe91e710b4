"""A finding about a text: what, where, why, and what fixes it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from rvmon.diagnostics.span import Span


class Severity(StrEnum):
    """How much a finding weighs: an error stops the compilation, a warning does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Label:
    """A place with an optional remark that stands beside its underline."""

    span: Span
    text: str = ""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    Attributes:
        code: stable identifier with its page in the documentation, such as `RV012`.
        name: the code in words, such as `unknown-signal`.
        severity: error or warning.
        message: one sentence: what is wrong.
        spans: the places, the offending one first; empty if the whole file is meant.
        help: what fixes it; empty if nothing is known to.
    """

    code: str
    name: str
    severity: Severity
    message: str
    spans: tuple[Label, ...] = ()
    help: str = ""
