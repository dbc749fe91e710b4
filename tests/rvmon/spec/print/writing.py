"""Specifications in random writing, and what they say."""

from __future__ import annotations

import re
from collections.abc import Hashable
from dataclasses import fields, is_dataclass
from typing import Any

from rvmon.spec.checked.formula import Binary, BinaryOp
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.generate import Rng, chance, pick

_SYNONYMS = {
    "not": ("not", "!"),
    "and": ("and", "&", "&&"),
    "or": ("or", "|", "||"),
    "->": ("->", "implies"),
    "<->": ("<->", "iff"),
    "eventually": ("eventually", "F"),
    "always": ("always", "G"),
    "next": ("next", "X"),
    "previous": ("previous", "Y"),
    "once": ("once", "O"),
    "historically": ("historically", "H"),
    "until": ("until", "U"),
    "unless": ("unless", "W", "weak until"),
    "since": ("since", "S"),
    "==": ("==", "="),
}
_WORD = re.compile(
    r"for each|at end|ignore NaN|stale after|\d[\d.]*(?: (?:[numk]?s|min|h)\b)?"
    r"|[\w.]+|<->|->|==|!=|<=|>=|[^\w\s]|\s+"
)
_CHAINED = (BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR, BinaryOp.IFF)


def scribbled(text: str, rng: Rng) -> str:
    """The same specification with synonyms, other spaces, and comments wherever they may stand."""
    lines = []
    for line in text.split("\n"):
        words = []
        for word in _WORD.findall(line.strip()):
            if not word.isspace():
                words.append(pick(rng, _SYNONYMS.get(word, (word,))))
            elif chance(rng, 2):
                words.append(pick(rng, (" # note\n   ", "\n  # own line\n ", "\n ")))
            else:
                words.append(pick(rng, (" ", "  ", "\t")))
        indent = "" if not line.startswith(" ") else "   "
        lines.append(indent + "".join(words) + ("  # remark" if chance(rng, 10) else ""))
        if chance(rng, 10):
            lines.append(pick(rng, ("", "# above", "  # below", "\n\n")))
    return "\n".join(lines)


def meaning(spec: CheckedSpec) -> Hashable:
    """What a specification says: equal for two that differ only in places and brackets."""
    return (
        (spec.time, spec.period),
        tuple((s.name, s.type, s.ignores_nan, s.stale_after) for s in spec.signals.values()),
        tuple((e.name, tuple(e.fields.items())) for e in spec.events.values()),
        tuple(_bare(requirement) for requirement in spec.requirements.values()),
    )


def _bare(node: Any) -> Hashable:
    """A node without its place; a chain of an associative connective as a flat tuple."""
    match node:
        case Binary(op=op) if op in _CHAINED:
            return (op, *_operands(node, op))
        case tuple():
            return tuple(map(_bare, node))
        case _ if is_dataclass(node):
            kept = (f.name for f in fields(node) if f.name not in ("span", "unit"))
            return (type(node).__name__, *(_bare(getattr(node, name)) for name in kept))
        case _:
            hashable: Hashable = node
            return hashable


def _operands(node: Any, op: BinaryOp) -> tuple[Hashable, ...]:
    if isinstance(node, Binary) and node.op is op:
        return (*_operands(node.left, op), *_operands(node.right, op))
    return (_bare(node),)
