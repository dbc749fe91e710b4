"""All diagnostic codes, of specifications, their analysis and models, with their pages."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources

from rvmon.analysis.rules import analysis_rules
from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.errors import ModelError, SpecError, UnknownNameError
from rvmon.spec.compile import compile_text
from rvmon.spec.rules.pages import all_rules, rule_page
from rvmon.spec.rules.rule import Rule
from rvmon.timed.model.rules import RULES

_WARNINGS = ("TA010",)


@cache
def model_rules() -> Mapping[str, Rule]:
    """Every rule of models by its code, in order of codes."""
    text = resources.files("rvmon.explain").joinpath("model_codes.toml").read_text("utf-8")
    return {
        code: Rule(
            code,
            RULES[code],
            Severity.WARNING if code in _WARNINGS else Severity.ERROR,
            **{name: words.removeprefix("\n") for name, words in page.items()},
        )
        for code, page in tomllib.loads(text).items()
    }


def findings_in_model(text: str) -> tuple[Diagnostic, ...]:
    """What is found in a model as its queries are decided, or as it is held against a recording.

    Args:
        text: of the model; an empty one stands for a file that is not there.
    """
    from rvmon.timed.conformance.conform import conform
    from rvmon.timed.language.load import load_network, loads_network
    from rvmon.timed.search.verify import verify

    try:
        network = loads_network(text, name="demo.ta") if text else load_network("none/demo.ta")
        for query in network.queries:
            verify(network, query)
        if not network.queries:
            conform(network, (), observed=frozenset(), end=0, tolerance=0)
    except ModelError as error:
        return error.diagnostics
    return network.warnings


def every_rule() -> Mapping[str, Rule]:
    """Every rule by its code, in order of codes."""
    return {**all_rules(), **analysis_rules(), **model_rules()}


def findings_about(rule: Rule, text: str) -> tuple[Diagnostic, ...]:
    """What is found in a text by the pass that a rule belongs to: check, analysis, or a model's."""
    if rule.code in model_rules():
        return findings_in_model(text)
    try:
        checked, found = compile_text(text, name="demo.rv")
    except SpecError as error:
        return tuple(error.diagnostics)
    if rule.code not in analysis_rules():
        return tuple(found)
    from rvmon.explain.analysed import analyse
    from rvmon.monitor.compiled.specification import compile_spec

    return analyse(compile_spec(checked), timelines=0).findings


def page_of(code: str) -> str:
    """The page of a code as Markdown.

    Args:
        code: such as `RV012`; also the code in words, such as `unknown-signal`, of specifications
            where models have the same.

    Raises:
        UnknownNameError: there is no such code; those most alike are named.
    """
    rules = every_rule()
    named = {rules[known].name: rules[known] for known in sorted(rules, reverse=True)}
    rule = rules.get(code.upper()) or named.get(code.lower())
    if rule is None:
        raise UnknownNameError(_unknown(code, rules))
    return rule_page(rule, findings_about(rule, rule.example))


def code_list() -> str:
    """All codes with their names, a line each."""
    return "".join(f"{rule.code}  {rule.name}\n" for rule in every_rule().values())


def _unknown(code: str, rules: Mapping[str, Rule]) -> str:
    shown = [f"  {rule.code}  {rule.name}" for rule in _alike(code, rules)]
    return "\n".join(
        (f"error: no diagnostic `{code}`; alike are", *shown, "`rvmon explain codes` lists all")
    )


def _alike(code: str, rules: Mapping[str, Rule]) -> list[Rule]:
    """The three rules with the nearest numbers, or with names most alike."""
    family, digits = code[:2].upper(), code[2:]
    if family in ("RV", "TA") and digits.isdecimal():
        number = int(digits[:9])
        family_rules = [known for known in rules if known.startswith(family)]
        near = sorted(family_rules, key=lambda known: abs(int(known[2:]) - number))
        return [rules[known] for known in sorted(near[:3])]
    named = {rule.name: rule for rule in rules.values()}
    return [named[name] for name in difflib.get_close_matches(code.lower(), named, 3, 0.0)]
