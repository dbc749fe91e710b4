"""Checked specifications as text, in canonical and in random writing, and what they say."""

from __future__ import annotations

import re
from collections.abc import Hashable
from dataclasses import fields, is_dataclass
from typing import Any

from rvmon.spec.checked.formula import Binary, BinaryOp
from rvmon.spec.checked.specification import CheckedSpec, Event, Requirement, Signal
from rvmon.spec.print.printer import format_duration, format_formula, format_numeric
from rvmon.testing.generate.choices import Rng, chance, pick
from rvmon.trace.schema import Kind

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


def spec_text(spec: CheckedSpec) -> str:
    """A specification that holds no goals and properties, as text of the language."""
    period = f" {format_duration(spec.period)}" if spec.period else ""
    lines = [f"spec {spec.name}", f"time {spec.time}{period}"]
    lines += map(_signal, spec.signals.values())
    lines += map(_event, spec.events.values())
    for requirement in spec.requirements.values():
        lines += _requirement(requirement)
    return "\n".join(lines) + "\n"


def _signal(signal: Signal) -> str:
    type_ = signal.type
    shown = "{" + ", ".join(type_.labels) + "}" if type_.kind is Kind.LABEL else str(type_.kind)
    unit = f" [{type_.unit}]" if type_.unit else ""
    stale = f" stale after {format_duration(signal.stale_after)}" if signal.stale_after else ""
    ignoring = " ignore NaN" if signal.ignores_nan else ""
    return f"signal {signal.name} : {shown}{unit}{ignoring}{stale}"


def _event(event: Event) -> str:
    listed = ", ".join(f"{name}: {type_.kind}" for name, type_ in event.fields.items())
    return f"event {event.name}" + (f"({listed})" if listed else "")


def _requirement(requirement: Requirement) -> list[str]:
    lines = [
        f'requirement {requirement.id} "{requirement.text}"',
        f"  {requirement.mode} {format_formula(requirement.trigger)}",
        f"  then {format_formula(requirement.consequent)}",
    ]
    if requirement.for_each:
        each = requirement.for_each
        lines.append(f"  for each {each.name} in {format_numeric(each.value)}")
    lines += [f"  let {let.name} = {format_numeric(let.value)}" for let in requirement.captures]
    lines += [f"  {requirement.run_share}"] if requirement.run_share else []
    return [*lines, f"  at end: {requirement.at_end}"]


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
