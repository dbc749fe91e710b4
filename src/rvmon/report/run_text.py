"""Reports of recordings as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

from msgspec.structs import replace

from rvmon.diagnostics import snippet
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.report import wording
from rvmon.report.printer import Piece, Printer
from rvmon.texts import counted
from rvmon.trace.time import format_stamped
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, LazyAttempts
from rvmon.verdicts.report import Report
from rvmon.verdicts.run_coverage import CoveredGroup


def together(several: Sequence[Sequence[CoveredGroup]]) -> list[CoveredGroup]:
    """The summed coverage of several runs of one specification, without first instants."""
    summed = []
    for groups in zip(*several, strict=True):
        alike = zip(*(group.bins for group in groups), strict=True)
        bins = (replace(own[0], hits=sum(one.hits for one in own), first=None) for own in alike)
        summed.append(replace(groups[0], bins=tuple(bins)))
    return summed


def coverage_lines(groups: Sequence[CoveredGroup]) -> Iterator[str]:
    """For each group, a line with the hits of its bins, and one with its holes if it has any.

    >>> from rvmon.language.checked.properties import BinKind
    >>> from rvmon.verdicts.run_coverage import CoveredBin
    >>> low = CoveredBin("low", BinKind.GOAL, 1, 4)
    >>> high = CoveredBin("high", BinKind.GOAL, 3, 1)
    >>> for line in coverage_lines([CoveredGroup("size", "coverpoint", (low, high))]):
    ...     print(line)
    size: 1 of 2 covered; hit: low 4, high 1
    size: not covered: high (1 of 3)
    """
    for group in groups:
        wanted = [one for one in group.bins if one.kind is BinKind.GOAL]
        holes = [one for one in wanted if one.is_hole]
        hit = [
            f"{one.name}{'' if one.kind is BinKind.GOAL else f' ({one.kind})'} {one.hits:,}"
            for one in group.bins
            if one.hits
        ]
        covered = f"{group.name}: {len(wanted) - len(holes):,} of {len(wanted):,} covered"
        yield f"{covered}; hit: {wording.first_of(hit, wording.SHOWN)}" if hit else covered
        if holes:
            found = (f" ({one.hits:,} of {one.goal:,})" if one.goal > 1 else "" for one in holes)
            names = [f"{one.name}{hits}" for one, hits in zip(holes, found, strict=True)]
            yield f"{group.name}: not covered: {wording.first_of(names, wording.SHOWN)}"


def print_reports(
    reports: Sequence[Report], spec: CheckedSpec, *, counts_only: bool = False, broken: int = 0
) -> None:
    """Print the verdicts on each recording; for several recordings, also the counts of verdicts.

    Every F is shown with cause, window and line of the specification, every I with its obligation.
    `broken` further recordings could not be evaluated.
    """
    printer = Printer()
    for report in () if counts_only else reports:
        print_report(report, spec, printer)
    if reports and (len(reports) + broken > 1 or counts_only):
        rest = f", {broken} cannot be evaluated" if broken else ""
        printer.line((f"{counted(len(reports) + broken, 'recording')}{rest}", "italic"))
        _print_counts(reports, printer)
        for name in reports[0].goals:
            count = sum(report.goals[name] is Verdict.PASS for report in reports)
            state = f"met, shown by {count} of {len(reports)}" if count else "open"
            printer.line(f"cover goal {name}: {state}")
        _print_coverage(together([report.coverage for report in reports]), printer)


def print_report(report: Report, spec: CheckedSpec, printer: Printer) -> None:
    """Print the verdicts on one recording."""
    end = "" if report.end is None else f"  to {format_stamped(report.end, report.origin)}"
    printer.line((report.trace or spec.name, "bold"), f"{end}  against {spec.name}")
    if spec.requirements:
        _print_verdicts(report, spec, printer)
    for name, verdict in report.verdicts.items():
        if name in report.misses:
            reason = wording.without_attempts(verdict, report.misses[name])
            why = wording.wrapped(reason, printer.width)
            printer.line((f"{name} ", "bold"), wording.verdict_text(verdict), f"\n{why}\n")
        for shown in (Verdict.FAIL, Verdict.INCONCLUSIVE):
            count = report.counts.get(name, {}).get(shown, 0)
            attempts = report.of(name, shown) if count else ()
            for attempt in islice(attempts, wording.SHOWN_PER_REQUIREMENT):
                _print_attempt(attempt, spec.requirements[name], report, printer)
            rest = count - wording.SHOWN_PER_REQUIREMENT
            if rest > 0:
                printer.line((f"… and {rest} more {shown} of {name}", "dim"))
    _print_goals(report.goals, printer)
    _print_coverage(report.coverage, printer)
    for hit in report.illegal:
        printer.line((hit.sentence(report.origin), "bold red"))
    if report.health:
        printer.line("input health:")
    for names, fact in wording.health_facts(report.health, report.origin):
        printer.line(wording.wrapped(f"{names}  {fact}", printer.width))


def _print_coverage(groups: Sequence[CoveredGroup], printer: Printer) -> None:
    if groups:
        printer.line("coverage:")
    for line in coverage_lines(groups):
        printer.line(wording.wrapped(line, printer.width))


def _print_verdicts(report: Report, spec: CheckedSpec, printer: Printer) -> None:
    least = _least_robustness(report)
    levels = any(spec.requirements[name].severity for name in report.verdicts)
    heads = ["", "verdict", "attempts"]
    heads += ["robustness"] if least else []
    heads += ["severity"] if levels else []
    rows = []
    for name, verdict in report.verdicts.items():
        counts = report.counts[name]
        listed = "  ".join(f"{count} {kind}" for kind, count in counts.items() if count)
        row: list[Piece] = [name, wording.verdict_text(verdict), listed or "–"]
        row += [least.get(name, "–")] if least else []
        requirement = spec.requirements[name]
        row += [requirement.severity or "–"] if levels else []
        tags = f"  [{', '.join(requirement.tags)}]" if requirement.tags else ""
        text = f"{requirement.text}{tags}".lstrip()
        rows.append([*row, (text, "dim")])
    printer.table([*heads, "requirement"], rows)


def _least_robustness(report: Report) -> dict[str, str]:
    """The least robustness of each requirement's attempts, if it was measured."""
    if isinstance(report.attempts, LazyAttempts):
        return {}  # robustness was not measured
    least: dict[str, float] = {}
    for attempt in report.attempts:
        if attempt.robustness is not None:
            known = least.get(attempt.requirement, attempt.robustness)
            least[attempt.requirement] = min(known, attempt.robustness)
    return {name: f"{value:.4g}" for name, value in least.items()}


def _print_goals(goals: Mapping[str, Verdict], printer: Printer) -> None:
    if not goals:
        return
    words = {Verdict.PASS: "shown", Verdict.INCONCLUSIVE: "not shown, still possible at the end"}
    printer.line("cover goals:")
    for name, verdict in goals.items():
        sign = wording.MARKS[verdict].sign
        printer.line(f"  {name}  {verdict} {sign}  {words.get(verdict, 'not shown')}")
    printer.line()


def _print_attempt(
    attempt: Attempt, requirement: Requirement, report: Report, printer: Printer
) -> None:
    first, *rest = wording.instants_of(attempt)
    when = "\n  ".join([f"attempt {attempt.numbered}, {first}", *rest])
    if attempt.robustness is not None:
        when += f", robustness {attempt.robustness:.4g}"
    name: Piece = (f"{attempt.requirement} ", "bold")
    printer.line(name, wording.verdict_text(attempt.verdict), f"  {when}")
    if attempt.reason:
        printer.line(wording.wrapped(wording.full_reason(attempt, report), printer.width))
    if attempt.forecast is not None:
        printer.line(f"  {wording.forecast_sentence(attempt.forecast)}")
    span = requirement.span
    if attempt.blame is not None and span is not None:
        span = type(span)(span.source, attempt.blame.start, attempt.blame.end)
        printer.line(snippet(span, width=printer.width))
    else:
        printer.line()


def _print_counts(reports: Sequence[Report], printer: Printer) -> None:
    rows = []
    for name in reports[0].verdicts:
        seen = [report.verdicts[name] for report in reports]
        rows.append([name, *(str(seen.count(verdict)) for verdict in Verdict)])
    heads = ["", *(verdict.value for verdict in Verdict)]
    printer.table(heads, rows, right=range(1, len(heads)))
