"""`rvmon check` and `format`: errors in specifications, and their canonical layout."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from rvmon.cli.options import constants_of
from rvmon.cli.output import busy, rendered, say, say_json, warn
from rvmon.diagnostics import Diagnostic, coloured, render_concise, render_json, wants_colour
from rvmon.errors import SpecError
from rvmon.files import write_whole
from rvmon.language.checked.classify import windows_of
from rvmon.language.checked.formula import WindowValue
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.compiled_cache import compile_cached
from rvmon.language.print import format_duration, format_window
from rvmon.texts import cannot_read, counted, text_of_file, text_of_input


def run_check(arguments: argparse.Namespace) -> int:
    """Check specifications, print the diagnostics, and return the exit code."""
    constants = constants_of(arguments.const)
    findings: list[Diagnostic] = []
    remarks: list[str] = []
    unreadable = broken = 0
    for name in arguments.specs:
        try:
            text = text_of_input() if name == "-" else text_of_file(name)
        except (OSError, UnicodeDecodeError) as error:
            warn(f"error: {cannot_read(name, error)}")
            unreadable += 1
            continue
        checked, reported = _checked(text, name, constants)
        findings += reported
        broken += checked is None
        remarks += [] if checked is None else memory_lines(checked)
        if arguments.binding is not None and checked is not None:
            remarks += _bound(arguments.binding, checked)
        if arguments.analyse and checked is not None:
            with busy(f"analysing {name}"):
                more, remark = _analysed(checked, arguments.seconds)
            findings += more
            remarks += remark
    findings = list(dict.fromkeys(findings))  # several specifications may import the same file
    _show(arguments.format, findings)
    if arguments.format == "text":
        if remarks:
            say("\n".join(["", *remarks] if findings else remarks))
        if findings or not (unreadable or broken):
            say(_summary(len(arguments.specs) - unreadable, findings))
    if unreadable or broken:
        return 2
    return int(arguments.strict and bool(findings))


def _checked(
    text: str, name: str, constants: Mapping[str, str]
) -> tuple[CheckedSpec | None, Sequence[Diagnostic]]:
    """The specification, `None` if it has errors, and its diagnostics."""
    directory = None if name == "-" else Path(name).parent
    shown = "<stdin>" if name == "-" else name
    try:
        return compile_cached(text, name=shown, constants=constants, directory=directory)
    except SpecError as error:
        return None, error.diagnostics


def _analysed(checked: CheckedSpec, seconds: float) -> tuple[Sequence[Diagnostic], list[str]]:
    """The diagnostics of an analysis, and lines with timelines and undecided questions."""
    from rvmon.analysis.shortest_examples import analyse
    from rvmon.monitor.compiled_spec import compile_spec
    from rvmon.report.explain_text import analysis_lines

    analysis = analyse(compile_spec(checked), seconds=seconds)
    return analysis.findings, analysis_lines(analysis, checked)


def _bound(path: str, checked: CheckedSpec) -> list[str]:
    """Remarks on a binding: names that it does not bind, and signals fed by the same field."""
    from rvmon.recordings.binding import load_binding

    bounds = load_binding(path, checked).bounds
    free = [name for name in (*checked.signals, *checked.events) if name not in bounds]
    remarks = [f"{path} does not bind {', '.join(free)}"] if free else []
    fed: dict[tuple[str, str], list[str]] = {}
    for name in checked.signals:
        if (bound := bounds.get(name)) is not None:
            fed.setdefault((bound.topic, str(bound.value)), []).append(name)
    return remarks + [
        f"{path} feeds {' and '.join(names)} with the same field: {value} of {topic}"
        for (topic, value), names in fed.items()
        if len(names) > 1
    ]


def _show(form: str, findings: list[Diagnostic]) -> None:
    match form:
        case "json":
            say_json(render_json(findings))
        case "concise" if findings:
            warn(render_concise(findings))
        case "text" if findings:
            text = rendered(findings)
            # Written directly: `rendered` has already escaped all text that is not ours.
            sys.stderr.write(f"{coloured(text) if wants_colour(sys.stderr) else text}\n")


def _summary(files: int, findings: list[Diagnostic]) -> str:
    errors = sum(finding.severity == "error" for finding in findings)
    counts = ((errors, "error"), (len(findings) - errors, "warning"))
    listed = ", ".join(counted(count, noun) for count, noun in counts if count)
    return f"{counted(files, 'file')}: {listed or 'nothing to report'}"


def memory_lines(spec: CheckedSpec) -> list[str]:
    r"""The memory of each requirement's windows in bytes, a line per window and one for the sum.

    >>> import rvmon
    >>> text = "event e\nrequirement R\n  always count(e, 5 s) <= 3\n"
    >>> memory_lines(rvmon.loads(text).checked)
    ['memory: R keeps count(e, 5 s) in 128 bytes, and up to 64 a member in the last 5 s']
    """
    return [line for requirement in spec.requirements.values() for line in _lines(requirement)]


def _lines(requirement: Requirement) -> Iterator[str]:
    windows = {
        format_window(window): window
        for window in windows_of(requirement.trigger, requirement.consequent)
    }
    again = ""
    if requirement.for_each is not None:
        again = f", separately for each {requirement.for_each.name}"
    elif requirement.captures:
        again = ", separately for each open attempt"
    for text, window in windows.items():
        yield f"memory: {requirement.id} keeps {text} in {_of(window)}{again}"
    if len(windows) > 1:
        fixed = sum(_fixed(window) for window in windows.values())
        yield f"memory: {requirement.id} keeps {fixed:,} bytes, plus the contents of its windows"


def _fixed(window: WindowValue) -> int:
    return window.measured.fixed + window.measured.each * (window.most or 0)


def _of(window: WindowValue) -> str:
    each = f"and up to {window.measured.each} a member"
    if window.most is not None:
        return f"{_fixed(window):,} bytes at most"
    if window.window is not None:
        return f"{_fixed(window):,} bytes, {each} in the last {format_duration(window.window)}"
    if not window.measured.steady:
        return f"{_fixed(window):,} bytes, {each} of another value"
    return f"{_fixed(window):,} bytes, however long the run"


def run_format(arguments: argparse.Namespace) -> int:
    """Rewrite specifications in the canonical layout, and return the exit code."""
    from rvmon.language.formatter import format_text

    changed = wrong = 0
    for name in arguments.specs:
        try:
            text = text_of_input() if name == "-" else text_of_file(name)
            laid_out = format_text(text, name=name)
            if name != "-" and laid_out != text and not arguments.check:
                write_whole(name, laid_out)
        except SpecError as error:
            warn(str(error))
            wrong += 1
            continue
        except (OSError, UnicodeDecodeError) as error:
            warn(f"error: {cannot_read(name, error)}")
            wrong += 1
            continue
        if name == "-" and not arguments.check:
            sys.stdout.write(laid_out)
        elif laid_out != text:
            say(f"{'would change' if arguments.check else 'changed'}: {name}")
        changed += laid_out != text
    if wrong:
        return 2
    return int(arguments.check and changed > 0)
