"""Text to checked specification: the passes in their order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.render import render_full
from rvmon.diagnostics.span import Source
from rvmon.errors import SpecError
from rvmon.spec.check import check, never_read
from rvmon.spec.checked import CheckedSpec
from rvmon.spec.constants import overridden
from rvmon.spec.load import load_files
from rvmon.spec.resolve import resolve


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
    files, findings = load_files(source, directory)
    files, unknown = overridden(files, constants or {})
    resolved, doubles = resolve(files)
    checked, wrong = check(resolved)
    found = _once([*findings, *unknown, *doubles, *wrong], source)
    if any(finding.severity is Severity.ERROR for finding in found):
        raise SpecError(found, render_full(found))
    return checked, tuple(_once([*found, *never_read(checked)], source))


def _once(findings: Iterable[Diagnostic], main: Source) -> list[Diagnostic]:
    """In order of place, the main file first; what was found several times (in a macro) once."""
    unique = {(finding.code, _place(finding, main)): finding for finding in reversed([*findings])}
    return sorted(unique.values(), key=lambda finding: _place(finding, main))


def _place(finding: Diagnostic, main: Source) -> tuple[bool, str, int, int]:
    if not finding.spans:
        return (False, "", 0, 0)
    span = finding.spans[0].span
    return (span.source is not main, span.source.name, span.start, span.end)
