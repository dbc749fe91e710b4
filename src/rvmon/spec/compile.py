"""Text to checked specification: the passes in their order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.render import render_full
from rvmon.diagnostics.span import Source, Span
from rvmon.errors import SpecError
from rvmon.spec.check.specification import check
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.spec.names.constants import overridden
from rvmon.spec.names.resolve import resolve
from rvmon.spec.names.unused import unused_names
from rvmon.spec.rules.findings import MOST, Enough, Findings
from rvmon.spec.rules.syntax import empty_file, too_many
from rvmon.spec.syntax.imports import load_files


def compile_text(
    text: str,
    *,
    name: str = "<string>",
    constants: Mapping[str, str] | None = None,
    directory: Path | None = None,
) -> tuple[CheckedSpec, tuple[Diagnostic, ...]]:
    r"""Compile the text of a specification.

    Args:
        text: the specification.
        name: what messages call it.
        constants: constants to override, by name, as text of the language (`{"T": "2 s"}`).
        directory: where imports are looked up.

    Returns:
        The checked specification and the warnings.

    Raises:
        SpecError: the text is wrong; carries all diagnostics, rendered.

    >>> spec, warnings = compile_text("event a, b\nrequirement R upon a then within 3 s b")
    >>> spec.requirements["R"].pulse, warnings
    (True, ())
    """
    source = Source(name, text)
    findings = Findings()
    checked: CheckedSpec | None = None
    with suppress(Enough):
        files = load_files(source, directory, findings)
        files = overridden(files, constants or {}, findings)
        resolved = resolve(files, findings)
        checked = check(resolved, findings)
        if not _errors(findings.found):
            findings.extend(unused_names(resolved, checked))
        if not files[0].items and not findings.found:
            findings.add(empty_file(Span(source, 0, 0)))
    found = sorted(findings.found, key=lambda finding: _place(finding, source))
    broken = _errors(found)
    if findings.more:
        found.append(too_many(MOST, broken=broken))
    if checked is None or broken:
        raise SpecError(found, render_full(found))
    return checked, tuple(found)


def _errors(findings: Iterable[Diagnostic]) -> bool:
    return any(finding.severity is Severity.ERROR for finding in findings)


def _place(finding: Diagnostic, main: Source) -> tuple[bool, str, int, int]:
    """The main file comes first."""
    if not finding.spans:
        return (False, "", 0, 0)
    span = finding.spans[0].span
    return (span.source is not main, span.source.name, span.start, span.end)
