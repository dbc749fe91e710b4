"""Compiles the text of a specification: runs all passes in order, up to the checked result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from msgspec import Struct

from rvmon.diagnostics import Diagnostic, Severity, Source, Span, render_full
from rvmon.errors import SpecError
from rvmon.language.check import check
from rvmon.language.checked.specification import CheckedSpec
from rvmon.language.names import overridden, resolve, unused_names
from rvmon.language.rules import Findings, TooManyErrors
from rvmon.language.rules.syntax import empty_file, too_many
from rvmon.language.syntax.items import ParsedSpec
from rvmon.language.syntax.parse import load_files
from rvmon.texts import text_of_file


class Compilation(Struct, frozen=True):
    """The results of all passes over a text, which may contain errors."""

    files: Sequence[ParsedSpec]  # the text and its imports, with the items that could be parsed
    # the items that passed the check; `None` if there were too many errors
    checked: CheckedSpec | None
    # errors and warnings in order of place, those of the main text before those of imports
    findings: tuple[Diagnostic, ...]

    @property
    def broken(self) -> bool:
        """Whether any finding is an error."""
        return _errors(self.findings)


def compile_text(
    text: str,
    *,
    name: str = "<string>",
    constants: Mapping[str, str] | None = None,
    directory: Path | None = None,
    read: Callable[[Path], str] = text_of_file,
) -> tuple[CheckedSpec, tuple[Diagnostic, ...]]:
    r"""Compile the text of a specification.

    Args:
        text: the specification.
        name: its name in messages.
        constants: constants to override, by name; values are text of the language
            (`{"T": "2 s"}`).
        directory: the folder to which imports are relative; by default the current one.
        read: returns the text of an imported file.

    Returns:
        The checked specification and the warnings.

    Raises:
        SpecError: the text has errors; the exception carries all diagnostics, rendered.

    >>> spec, warnings = compile_text("event a, b\nrequirement R upon a then within 3 s b")
    >>> spec.requirements["R"].pulse, warnings
    (True, ())
    """
    compiled = compilation(Source(name, text), directory, constants or {}, read)
    if compiled.checked is None or compiled.broken:
        raise SpecError(compiled.findings, render_full(compiled.findings))
    return compiled.checked, compiled.findings


def compilation(
    source: Source,
    directory: Path | None,
    constants: Mapping[str, str],
    read: Callable[[Path], str] = text_of_file,
) -> Compilation:
    """Compile a text and keep partial results in spite of errors; arguments as `compile_text`."""
    findings = Findings()
    checked: CheckedSpec | None = None
    files: Sequence[ParsedSpec] = ()
    with suppress(TooManyErrors):
        files = load_files(source, directory, findings, read)
        files = overridden(files, constants, findings)
        resolved = resolve(files, findings)
        checked = check(resolved, findings)
        # Only without errors: the item that uses a name may be the one that was not parsed.
        if not _errors(findings.diagnostics):
            findings.extend(unused_names(resolved, checked))
        if not files[0].items and not findings.diagnostics:
            findings.add(empty_file(Span(source, 0, 0)))
    ordered = sorted(findings.diagnostics, key=lambda finding: _place(finding, source))
    if findings.more:
        ordered.append(too_many(broken=_errors(ordered)))
    return Compilation(files, checked, tuple(ordered))


def _errors(findings: Iterable[Diagnostic]) -> bool:
    return any(finding.severity is Severity.ERROR for finding in findings)


def _place(finding: Diagnostic, main: Source) -> tuple[bool, str, int, int]:
    """The sort key of a finding: those of the main file come first."""
    if not finding.spans:
        return (False, "", 0, 0)
    span = finding.spans[0].span
    return (span.source is not main, span.source.name, span.start, span.end)
