"""All diagnostic codes, with their pages: those of specifications, of analysis and of models."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from functools import cache
from importlib import resources

from rvmon.analysis import findings
from rvmon.diagnostics import Severity
from rvmon.errors import UnknownNameError
from rvmon.language.rules import Rule, names, requirements, syntax, types
from rvmon.models import RULES as MODELS

_FAMILIES = (syntax, names, types, requirements, findings)
_WARNINGS = ("TA010",)


@cache
def every_rule() -> Mapping[str, Rule]:
    """Every rule by its code, in order of codes."""
    defined = (vars(family).values() for family in _FAMILIES)
    rules = [rule for family in defined for rule in family if isinstance(rule, Rule)]
    rules += [
        Rule(code, name, Severity.WARNING if code in _WARNINGS else Severity.ERROR)
        for code, name in MODELS.items()
    ]
    return {rule.code: rule for rule in sorted(rules, key=lambda rule: rule.code)}


def page_of(code: str) -> str:
    """The page of a code or name as Markdown; names of specifications precede those of models.

    Raises:
        UnknownNameError: there is no such diagnostic.
    """
    rules = every_rule()
    named = {rules[known].name: rules[known] for known in sorted(rules, reverse=True)}
    rule = rules.get(code.upper()) or named.get(code.lower())
    if rule is None:
        alike = "\n".join(f"  {one.code}  {one.name}" for one in _alike(code, rules))
        end = "`rvmon explain codes` lists all"
        raise UnknownNameError(f"error: no diagnostic `{code}`; similar ones are\n{alike}\n{end}")
    return every_page()[rule.code]


@cache
def every_page() -> Mapping[str, str]:
    """The page of every code as Markdown; the folder `pages` has a section per code."""
    folder = resources.files("rvmon.analysis") / "pages"
    text = "\n".join(file.read_text("utf-8") for file in folder.iterdir())
    pages = re.split(r"^(?=# (?:RV|TA)\d{3} )", text, flags=re.MULTILINE)[1:]
    return {page[2:7]: page.rstrip("\n") + "\n" for page in pages}


def code_list() -> str:
    """All codes with their names, one per line."""
    return "".join(f"{rule.code}  {rule.name}\n" for rule in every_rule().values())


def _alike(code: str, rules: Mapping[str, Rule]) -> list[Rule]:
    """The three rules with the nearest numbers, or with the most similar names."""
    family, digits = code[:2].upper(), code[2:]
    if family in ("RV", "TA") and digits.isdecimal():
        number = int(digits[:9])
        family_rules = [known for known in rules if known.startswith(family)]
        near = sorted(family_rules, key=lambda known: abs(int(known[2:]) - number))
        return [rules[known] for known in sorted(near[:3])]
    named = {rule.name: rule for rule in rules.values()}
    return [named[name] for name in difflib.get_close_matches(code.lower(), named, 3, 0.0)]
