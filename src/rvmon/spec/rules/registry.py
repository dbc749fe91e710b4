"""All rules, by code."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from rvmon.spec.rules import (
    goals,
    imports,
    names,
    properties,
    syntax,
    time,
    traps,
    triggers,
    types,
)
from rvmon.spec.rules.rule import Rule


@cache
def all_rules() -> Mapping[str, Rule]:
    """Every rule by its code, in order of codes."""
    families = (syntax, names, imports, types, time, triggers, traps, properties, goals)
    rules = sorted((rule for family in families for rule in family.RULES), key=lambda r: r.code)
    return {rule.code: rule for rule in rules}
