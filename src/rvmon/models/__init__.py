"""Networks of timed automata: text forms, zone model checker, witnesses, conformance, suites.

This file holds the diagnostics of models and queries: their codes, and the functions that build
and raise them. Whatever has no meaning or is too large raises a `ModelError`, wherever it is found.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.diagnostics import Diagnostic, Label, Severity, Span, render_full
from rvmon.errors import ModelError
from rvmon.texts import did_you_mean

RULES = {
    "TA001": "syntax", "TA002": "unknown-name", "TA003": "double-name", "TA004": "wrong-kind",
    "TA005": "unbounded-int", "TA006": "not-constant", "TA007": "out-of-range",
    "TA008": "diagonal-constraint", "TA009": "clock-in-wrong-place",
    "TA010": "channel-without-partner", "TA011": "clock-guard-on-urgent-channel",
    "TA013": "no-initial-location", "TA014": "no-beginning", "TA015": "wrong-arguments",
    "TA016": "not-supported", "TA017": "bad-weight", "TA018": "malformed-xml", "TA019": "too-large",
    "TA020": "query-not-supported", "TA021": "no-automaton", "TA022": "unreadable-file",
    "TA023": "no-unit",
}  # fmt: skip
"""Name of each diagnostic code."""


def finding(
    code: str,
    message: str,
    span: Span | None,
    fix: str = "",
    *,
    others: Sequence[Label] = (),
    severity: Severity = Severity.ERROR,
) -> Diagnostic:
    """Make a diagnostic of one of the `RULES`; `others` are further relevant places."""
    places = () if span is None else (Label(span),)
    return Diagnostic(code, RULES[code], severity, message, (*places, *others), fix)


def skipped_query(query: str, found: Diagnostic) -> Diagnostic:
    """Make the warning that a query of a model is skipped; `found` is the reason."""
    message = f"the query `{' '.join(query.split())}` is left out: {found.message}"
    fix = found.help or "E<>, A[], A<>, E[] and --> are understood"
    span = found.spans[0].span if found.spans else None
    return finding("TA020", message, span, fix, severity=Severity.WARNING)


def model_error(
    code: str, message: str, span: Span | None, fix: str = "", *, others: Sequence[Label] = ()
) -> ModelError:
    """Make an exception of a single finding."""
    return refusal(finding(code, message, span, fix, others=others))


def unknown(what: str, name: str, span: Span, known: Iterable[str]) -> ModelError:
    """Make the error for an unknown name; `known` are the names to suggest from."""
    return model_error("TA002", f"no {what} `{name}`", span, did_you_mean(name, known))


def refusal(*findings: Diagnostic) -> ModelError:
    """Make one `ModelError` of all findings, in order of place."""
    ordered = sorted(findings, key=lambda one: one.spans[0].span.start if one.spans else -1)
    return ModelError(ordered, render_full(ordered))
