"""The codes of findings about models and queries, with what is found in their examples."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.errors import ModelError
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
