"""`rvmon compile`: a specification as code that runs elsewhere, or as automata."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.options import add_const, add_only, asked_ids, constants_of
from rvmon.cli.output import say, warn
from rvmon.diagnostics.shown import shown_json, shown_line
from rvmon.errors import RvmonError
from rvmon.monitor.compiled.costs import CompileReport
from rvmon.report.terminal import plain_table
from rvmon.spec.print.printer import format_duration
from rvmon.writing import write_whole

if TYPE_CHECKING:
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.session import Spec

_AUTOMATA = ("dot", "json", "hoa", "costs")


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "compile",
        description="Write a monitor that needs nothing of rvmon: C99 (the core that judges, the "
        "plan that it judges by, a header for C++) that runs in one block of memory. Or the "
        "automata: dot for Graphviz, json, hoa (the least LTL3 monitors of requirements without "
        "windows of time). Or costs: a line per requirement with its monitor and what open "
        "attempts cost.",
        epilog="examples: rvmon compile examples/base.rv --to c -o monitor/; rvmon compile "
        "examples/base.rv --to dot --only B1 | dot -Tsvg -o b1.svg",
    )
    parser.add_argument("spec", metavar="SPEC", help="a .rv file")
    parser.add_argument("--to", choices=("c", "dot", "json", "hoa", "costs"), required=True)
    parser.add_argument(
        "-o", "--output", metavar="PATH", help="a folder (c), else a file (default: print it)"
    )
    add_only(parser)
    add_const(parser)


def run(arguments: argparse.Namespace) -> int:
    """Generate and write, and return the exit code."""
    from rvmon.session import load

    spec = load(arguments.spec, const=constants_of(arguments.const))
    ids = asked_ids(arguments, spec)
    if arguments.to in _AUTOMATA:
        if not spec.requirements:
            raise RvmonError(f"error: {arguments.spec} has no requirement: it has no automaton")
        _write_or_print(_automata(spec, ids, arguments.to), arguments.output)
        return 0
    if not spec.requirements:
        raise RvmonError("the specification has no requirements: there is nothing to compile")
    if arguments.output is None:
        raise RvmonError("C is several files: name a folder with -o DIR")
    folder = Path(arguments.output)
    if folder.exists() and not folder.is_dir():
        raise RvmonError(f"cannot write to {folder}: C is several files: name a folder with -o DIR")
    from rvmon.export.c_files import c_files
    from rvmon.monitor import compile_spec
    from rvmon.monitor.compiled.code_plan import plan_alone

    texts = c_files(plan_alone(compile_spec(spec.checked), ids))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            write_whole(folder / name, text)
            say(str(folder / name))
    except OSError as error:
        raise RvmonError(f"cannot write to {folder}: {error.strerror}") from None
    return 0


def _automata(spec: Spec, ids: Sequence[str] | None, form: str) -> str:
    """The automata of requirements, one after the other."""
    from rvmon.monitor import compile_spec

    compiled = compile_spec(spec.checked)
    chosen = [one for name, one in compiled.requirements.items() if ids is None or name in ids]
    if form == "costs":
        from rvmon.monitor.compiled.costs import compile_report

        return costs_text({one.requirement.id: compile_report(one) for one in chosen})
    if form == "hoa":
        return _hoa_texts(chosen)
    if form == "json":
        import msgspec

        from rvmon.export.hoa import automaton_json

        found = [automaton_json(one, spec.checked) for one in chosen]
        return shown_json(msgspec.json.format(msgspec.json.encode(found), indent=1).decode()) + "\n"
    from rvmon.explain.graph import graph_dot, graph_of

    texts = []
    for one in chosen:
        if one.automaton is None:
            raise RvmonError(f"error: {one.requirement.id} has no automaton: {one.refusal}")
        graph = graph_of(one, one.automaton, spec.checked)
        texts.append(graph_dot(graph, one.requirement.id))
    return "".join(texts)


def _hoa_texts(chosen: Sequence[CompiledRequirement]) -> str:
    """The automata that can be written; of the others it is said why they are left out.

    Raises:
        RvmonError: there is none; the message says why of the first.
    """
    from rvmon.export.hoa import hoa

    texts, faults = [], []
    for one in chosen:
        try:
            texts.append(hoa(one))
        except RvmonError as error:
            faults.append(error)
    if not texts:
        raise faults[0]
    for fault in faults:
        warn(f"left out: {str(fault).removeprefix('error: ')}")
    return "".join(texts)


def _write_or_print(text: str, output: str | None) -> None:
    if output is None:
        sys.stdout.write(text)
        return
    try:
        write_whole(output, text)
    except OSError as error:
        raise RvmonError(f"cannot write {output}: {error.strerror}") from None


_HEAD = ("", "judged by", "locations", "clocks", "letters", "decided within", "open attempts")


def costs_text(reports: Mapping[str, CompileReport]) -> str:
    """A line per requirement: what judges it, its size, what an open attempt costs."""
    return plain_table([_HEAD, *(_row(name, report) for name, report in reports.items())])


def _row(name: str, report: CompileReport) -> tuple[str, ...]:
    name = shown_line(name)
    reach = "any time" if report.horizon is None else format_duration(report.horizon)
    letters = f"{report.letters:,}"
    if not report.locations:
        return name, report.judge, "–", "–", letters, reach, f"in one network: {report.why}"
    sizes = (f"{report.locations}", f"{report.clocks}", letters, reach)
    return name, report.judge, *sizes, _open(report)


def _open(report: CompileReport) -> str:
    """How open attempts are kept, and what a change or a due time costs."""
    if report.horizon == 0:
        return "none: decided at once"
    if not report.in_runs:
        return "one by one: a step for each that is open"
    steps = "1 step" if report.steps == 1 else f"at most {report.steps} steps"
    return f"in runs: {report.bytes_per_attempt} bytes each, {steps} for all together"
