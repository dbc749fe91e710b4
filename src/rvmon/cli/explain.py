"""`rvmon explain`: explain a requirement, the difference of two, or a diagnostic code."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.options import constants_of
from rvmon.cli.output import say
from rvmon.errors import RvmonError

if TYPE_CHECKING:
    from rvmon.monitor.compiled_spec import CompiledSpec
    from rvmon.session import Spec

_CODE = re.compile(r"(RV|TA)\d+|codes|[a-z]+(-[a-z]+)+", re.IGNORECASE)
"""Matches the code of a diagnostic, its name in words, or `codes` for the list of all."""


def run_explain(arguments: argparse.Namespace) -> int:
    """Print the explanation, and return the exit code."""
    if not Path(arguments.subject).exists() and _CODE.fullmatch(arguments.subject):
        from rvmon.analysis.diagnostic_codes import code_list, page_of

        code = arguments.subject
        say(code_list() if code == "codes" else page_of(code), end="")
        return 0
    from rvmon.monitor.compiled_spec import compile_spec
    from rvmon.session import load

    spec = load(arguments.subject, const=constants_of(arguments.const))
    ids = _ids(arguments.ids, spec)
    compiled = compile_spec(spec.checked)
    _print(compiled, ids, difference=len(arguments.ids) == 2, runs=arguments.runs)
    return 0


def _ids(named: list[str], spec: Spec) -> list[str]:
    from rvmon.language.checked.names_read import requirement_ids

    requirement_ids(spec.checked, named)
    if len(named) > 2 or (len(named) == 2 and named[0] == named[1]):
        raise RvmonError("error: expected one requirement, or two different ones to compare")
    if not spec.requirements:
        raise RvmonError("error: the specification has no requirement to explain")
    return named or list(spec.requirements)


def _print(compiled: CompiledSpec, ids: list[str], *, difference: bool, runs: int) -> None:
    from rvmon.analysis.example import Budget
    from rvmon.report.explain_text import difference_explained, explained
    from rvmon.report.printer import Printer

    printer = Printer()
    budget = Budget(runs=runs)
    if difference:
        for line in difference_explained(compiled, ids[0], ids[1], budget):
            printer.line(*line)
        return
    for number, name in enumerate(ids):
        if number:
            printer.line()
        for line in explained(compiled, name, budget):
            printer.line(*line)
