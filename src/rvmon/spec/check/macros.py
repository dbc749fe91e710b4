"""Macros and constants that no requirement uses are checked as well."""

from __future__ import annotations

from rvmon.spec.check.expressions import Checker
from rvmon.spec.check.table import close_name
from rvmon.spec.check.values import EVERYWHERE
from rvmon.spec.names.resolved import ResolvedSpec
from rvmon.spec.rules import names as rules
from rvmon.spec.syntax.expressions import Name
from rvmon.spec.syntax.items import ConstItem, DefineItem
from rvmon.spec.syntax.walk import expressions_in


def check_unused(checker: Checker, spec: ResolvedSpec) -> None:
    """Report what is wrong in macros; those with parameters have their names looked up only."""
    for item in spec.declared.values():
        match item:
            case DefineItem(parameters=None, name=name) | ConstItem(name=name):
                checker.value(Name(name.text, name.span), EVERYWHERE)
            case DefineItem():
                _look_up(checker, item)


def _look_up(checker: Checker, item: DefineItem) -> None:
    own = {parameter.text for parameter in item.parameters or ()}
    table = checker.table
    for part in expressions_in(item.body):
        if not isinstance(part, Name) or part.text in own | table.doubtful:
            continue
        labels = {label for signal in table.signals.values() for label in signal.type.labels}
        if part.text not in labels and not checker.known(part.text, EVERYWHERE):
            close = close_name(table, part.text, tuple(own))
            checker.report(rules.unknown(part.span, part.text, close))
