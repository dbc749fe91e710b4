"""The pages of diagnostic codes, taken apart: an example, what is said of it, the same fixed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.analysis.diagnostic_codes import every_page
from rvmon.analysis.shortest_examples import analyse
from rvmon.diagnostics import Diagnostic, render_full
from rvmon.errors import ModelError, SpecError
from rvmon.language.compile import compile_text
from rvmon.models.conform import conform
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.verify import verify
from rvmon.monitor.compiled_spec import compile_spec

_FORM = re.compile(
    r"# (?P<code>\w+) (?P<name>[\w-]+)\n\n\*(?P<severity>\w+)\* · (?P<what>[^\n]+(?:\n[^\n]+)*)\n\n"
    r"(?P<why>[^\n]+(?:\n[^\n]+)*)\n\n## Example\n\n```(?:rv|ta)\n(?P<example>.*?)```\n\n"
    r"```text\n(?P<message>.*?)\n```\n\n## Instead\n\n```(?:rv|ta)\n(?P<instead>.*?)```\n",
    re.DOTALL,
)
_MOST = 5
"""Of more findings the first and the last are shown."""


@dataclass(frozen=True)
class Page:
    """The page of a code; `text` is all of it."""

    text: str
    code: str
    name: str
    severity: str
    what: str
    why: str
    example: str
    message: str
    instead: str


def page(code: str) -> Page:
    """The page of a code; an assertion says that it has another form."""
    text = every_page()[code]
    found = _FORM.fullmatch(text)
    assert found, f"the page of {code} has not the form of its neighbours"
    parts = found.groupdict()
    parts |= {name: parts[name].removeprefix("\n") for name in ("example", "instead")}
    return Page(text, **parts)


def findings_about(code: str, text: str) -> Sequence[Diagnostic]:
    """What is found in a text by the pass that a code belongs to: check, analysis, a model's."""
    if code.startswith("TA"):
        return _findings_in_model(text)
    try:
        checked, found = compile_text(text, name="demo.rv")
    except SpecError as error:
        return tuple(error.diagnostics)
    if not code.startswith("RV07"):
        return tuple(found)
    return analyse(compile_spec(checked), timelines=0).findings


def _findings_in_model(text: str) -> Sequence[Diagnostic]:
    """As its queries are decided; without any, as it is held against an empty recording."""
    try:
        network = loads_network(text, name="demo.ta") if text else load_network("none/demo.ta")
        for query in network.queries:
            verify(network, query)
        if not network.queries:
            conform(network, (), observed=frozenset(), end=0, tolerance=0)
    except ModelError as error:
        return error.diagnostics
    return network.warnings


def message_about(found: Sequence[Diagnostic]) -> str:
    """What is written about an example; of a long list the beginning and the end."""
    if len(found) <= _MOST:
        return render_full(found)
    return f"{render_full(found[:1])}\n\n…\n\n{render_full(found[-1:])}"
