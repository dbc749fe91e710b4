"""What was seen under the names of a recording, and what they can be declared as."""

from __future__ import annotations

import re
from collections.abc import Mapping

from rvmon.readers.values import FALSE_WORDS, TRUE_WORDS
from rvmon.starter.column import Shape, Shapes
from rvmon.trace.schema import Kind

MOST_LABELS = 16
"""A text column with more values than this is left out."""

_NUMBER = re.compile(
    r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE
)
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)


class Seen:
    """What was seen under one name; a CSV cell 0 or 1 is a bit: number or truth value."""

    def __init__(self) -> None:
        self.kinds: set[Kind] = set()
        self.bits = False
        self.labels: dict[str, None] = {}
        self.fields: dict[str, Seen] = {}
        self.payloads = 0
        self.count = 0
        self.other = False

    def add(self, value: object) -> None:
        """Take a JSON value that is neither null nor an object."""
        self.count += 1
        match value:
            case bool():
                self.kinds.add(Kind.BOOL)
            case int():
                self.kinds.add(Kind.INT)
            case float():
                self.kinds.add(Kind.REAL)
            case str():
                self.kinds.add(Kind.LABEL)
                self._label(value)
            case _:
                self.other = True

    def add_text(self, cell: str) -> None:
        """Take a CSV cell that is not empty."""
        self.count += 1
        if cell in TRUE_WORDS or cell in FALSE_WORDS:
            if cell in "01":
                self.bits = True
            else:
                self.kinds.add(Kind.BOOL)
        elif _WHOLE.fullmatch(cell):
            self.kinds.add(Kind.INT)
        elif _NUMBER.fullmatch(cell):
            self.kinds.add(Kind.REAL)
        else:
            self.kinds.add(Kind.LABEL)
        self._label(cell)

    def _label(self, text: str) -> None:
        if len(self.labels) <= MOST_LABELS:
            self.labels[text] = None

    def add_payload(self, payload: Mapping[str, object]) -> None:
        """Take an object."""
        self.count += 1
        self.payloads += 1
        for key, value in payload.items():
            if value is not None:
                self.fields.setdefault(key, Seen()).add(value)


def shapes_seen(seen: Mapping[str, Seen]) -> Shapes:
    """What names can be declared as."""
    declared: dict[str, Shape] = {}
    left_out: dict[str, str] = {}
    for name, entry in seen.items():
        shape = _shape(entry)
        if "`" in name or not name.strip() or not name.isprintable():
            left_out[name] = "its name cannot be written"
        elif isinstance(shape, str):
            left_out[name] = shape
        else:
            declared[name] = shape
    return Shapes(declared, left_out)


def _shape(seen: Seen) -> Shape | str:
    """The shape, or why there is none.

    What would compile and mislead is left out with a reason: a signal has one kind in the language,
    so values of two kinds would make each sample of the rarer one an error.
    """
    if seen.payloads:
        if seen.kinds - {Kind.BOOL} or seen.other:
            return "objects and other values"
        kinds = {name: _shape(entry) for name, entry in seen.fields.items()}
        return Shape(
            None,
            fields={
                name: shape.kind
                for name, shape in kinds.items()
                if isinstance(shape, Shape) and shape.kind not in (None, Kind.LABEL)
                if name.isidentifier()
            },
        )
    if seen.other:
        return "lists"
    if not seen.kinds:
        return Shape(Kind.BOOL) if seen.bits else "no value in the recording"
    if seen.kinds == {Kind.BOOL}:
        return Shape(Kind.BOOL)
    if seen.kinds <= {Kind.INT, Kind.REAL}:
        return Shape(Kind.REAL if Kind.REAL in seen.kinds else Kind.INT)
    if seen.kinds != {Kind.LABEL} or seen.bits:  # 0 and 1 among text may be labels, or truths
        return "numbers and text"
    if len(seen.labels) > MOST_LABELS:
        return f"text with more than {MOST_LABELS} values"
    if any("`" in label or not label.strip() or not label.isprintable() for label in seen.labels):
        return "text that cannot be written as labels"
    return Shape(Kind.LABEL, labels=tuple(seen.labels))
