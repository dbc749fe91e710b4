"""Constants whose value is given from outside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rvmon.diagnostics.span import Source
from rvmon.spec.rules import names as rules
from rvmon.spec.rules.findings import Findings
from rvmon.spec.syntax.expressions import Expression
from rvmon.spec.syntax.items import ConstItem, Item, ParsedSpec
from rvmon.spec.syntax.parse import parse_expression


def overridden(
    files: Sequence[ParsedSpec], constants: Mapping[str, str], findings: Findings
) -> list[ParsedSpec]:
    """The files with the values of some constants replaced."""
    values: dict[str, Expression] = {}
    known = [item.name.text for file in files for item in file.items if isinstance(item, ConstItem)]
    for name, text in constants.items():
        if name not in known:
            findings.add(rules.unknown_constant(name, known))
            continue
        value, wrong = parse_expression(Source(f"<constant {name}>", text))
        findings.extend(wrong)
        if value is not None:
            values[name] = value
    return [_with_values(file, values) for file in files]


def _with_values(file: ParsedSpec, values: Mapping[str, Expression]) -> ParsedSpec:
    def item_with_value(item: Item) -> Item:
        if isinstance(item, ConstItem) and item.name.text in values:
            return replace(item, value=values[item.name.text])
        return item

    return replace(file, items=tuple(map(item_with_value, file.items)))
