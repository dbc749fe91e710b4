"""Wording shared by reports: reasons, instants, input health and values; looks of verdicts."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from msgspec import Struct

from rvmon.language.print import format_duration
from rvmon.trace.sample import Health, HealthKind, Scalar
from rvmon.trace.time import TICKS_PER_SECOND, format_instant, format_stamped, format_ticks
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

NO_VALUES: Mapping[str, str] = MappingProxyType({})


def without_attempts(verdict: Verdict, miss: str) -> str:
    """Why a requirement has no attempt.

    >>> without_attempts(Verdict.NOT_TRIGGERED, "`near` was never true")
    'never triggered: `near` was never true'
    >>> without_attempts(Verdict.INCONCLUSIVE, "")
    'not known ever to be triggered'
    """
    is_sure = verdict is Verdict.NOT_TRIGGERED
    why = "never triggered" if is_sure else "not known ever to be triggered"
    return f"{why}: {miss}" if miss else why


def instants_of(attempt: Attempt) -> Sequence[str]:
    """The instants of trigger and decision in words; separate lines if stamps are absolute.

    >>> instants_of(Attempt("R1", 1, 5, 9, Verdict.PASS))
    ('triggered 5 ns, decided 9 ns',)
    """
    found = [f"triggered {format_stamped(attempt.triggered, attempt.origin)}"]
    if attempt.decided is not None:
        found.append(f"decided {format_stamped(attempt.decided, attempt.origin)}")
    return (*found,) if attempt.origin else (", ".join(found),)


def full_reason(attempt: Attempt, report: Report) -> str:
    """The reason of an attempt, with the values and the late response from the report."""
    late = report.late.get(attempt.requirement, {}).get(attempt.number)
    values = report.values.get(attempt.requirement, {}).get(attempt.number, {})
    return reason_text(attempt, late, values)


def reason_text(attempt: Attempt, came: int | None, values: Mapping[str, str] = NO_VALUES) -> str:
    """The reason of an attempt, with values at its decision and the instant of a late response.

    >>> from rvmon.verdicts.attempt import Blame
    >>> from rvmon.verdicts import Verdict
    >>> second = 10**9
    >>> blame = Blame("within 3 s a", 0, 12, (0, 3 * second))
    >>> failed = Attempt("R1", 1, 0, 3 * second + 1, Verdict.FAIL, reason="no `a`", blame=blame)
    >>> reason_text(failed, 3 * second + 20_000_000)
    'no `a`; it came at 3.02 s, 20 ms after the deadline'
    >>> reason_text(failed, 5 * second + 500_000_000)
    'no `a`; it came at 5.5 s, 2.5 s after the deadline'
    >>> reason_text(failed, None, {"speed": "3 m/s", "mode": "idle"})
    'no `a` (speed = 3 m/s, mode = idle)'
    """
    listed = ", ".join(f"{name} = {value}" for name, value in values.items())
    reason = f"{attempt.reason} ({listed})" if listed else attempt.reason
    if came is None or attempt.blame is None or attempt.blame.window[1] is None:
        return reason
    span = duration_text(came - attempt.blame.window[1])
    when = format_instant(came, attempt.origin)
    return f"{reason}; it came at {when}, {span} after the deadline"


def health_facts(entries: Sequence[Health], origin: int) -> Iterator[tuple[str, str]]:
    """Entries of input health in words, as pairs of names and fact.

    >>> speed = Health(HealthKind.NAN, "speed", 3, 2 * TICKS_PER_SECOND, ("R1",))
    >>> for fact in health_facts([speed, Health(HealthKind.IGNORED, "x", remark="unknown")], 0):
    ...     print(*fact)
    speed nan 3 times, first at 2 s  (R1)
    x ignored: unknown
    """
    ignored: dict[str, list[str]] = {}
    for entry in entries:
        if entry.kind is HealthKind.IGNORED:
            ignored.setdefault(entry.remark, []).append(entry.name)
        elif entry.is_doubt:
            yield entry.name, f"warning: {entry.remark}"
        else:
            at = "" if entry.first is None else format_stamped(entry.first, origin)
            first = f", first at {at}" if at else ""
            times = "once" if entry.count == 1 else f"{entry.count} times"
            remark = f": {entry.remark}" if entry.remark else ""
            readers = f"  ({', '.join(entry.requirements)})" if entry.requirements else ""
            kind = "given as unknown" if entry.kind is HealthKind.NONE else entry.kind.value
            yield entry.name, f"{kind} {times}{first}{remark}{readers}"
    for remark, names in ignored.items():
        yield first_of(names, SHOWN), f"ignored{f': {remark}' if remark else ''}"


SHOWN_PER_REQUIREMENT = 3
"""The most failed or undecided attempts shown in full; the rest is only counted."""

SHOWN = 12  # the most names listed for one fact; the rest is only counted


def first_of(names: Sequence[str], most: int) -> str:
    """The first `most` names, and the number of the others.

    >>> first_of(["a", "b", "c"], 2)
    'a, b, … and 1 more'
    """
    more = f", … and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def value_text(value: Scalar, unit: str = "") -> str:
    """The value of a signal or proposition as text.

    >>> value_text(True), value_text(0.1 + 0.2, "m"), value_text("closed"), value_text(None, "m")
    ('true', '0.3 m', 'closed', 'not known')
    """
    if unit and value is not None:
        return f"{value_text(value)} {unit}"
    match value:
        case None:
            return "not known"
        case bool():
            return "true" if value else "false"
        case float():
            return f"{value:.10g}"
        case _:
            return str(value)


def duration_text(ticks: int) -> str:
    """A duration in a suitable unit.

    >>> duration_text(20_000_000), duration_text(2_500_000_000)
    ('20 ms', '2.5 s')
    """
    return format_duration(ticks) if ticks < TICKS_PER_SECOND else format_ticks(ticks)


def forecast_sentence(forecast: Verdict) -> str:
    """The forecast of an undecided attempt, as a sentence.

    >>> forecast_sentence(Verdict.FAIL)
    'forecast F: no continuation can fulfil it'
    """
    if forecast is Verdict.PASS:
        return "forecast P: every continuation fulfils it"
    return "forecast F: no continuation can fulfil it"


class Mark(Struct, frozen=True):
    """The look of one verdict."""

    word: str  # for sentences ("R2 failed")
    sign: str  # a shape that distinguishes it without colour
    terminal: str  # a style of `rvmon.report.printer`, and of rich
    light: str  # CSS colour on a light page
    dark: str  # CSS colour on a dark page


MARKS = {
    Verdict.PASS: Mark("passed", "✓", "green", "#1a7f4b", "#4cc38a"),
    Verdict.FAIL: Mark("failed", "✗", "bold red", "#c4302b", "#ff7b72"),
    Verdict.NOT_TRIGGERED: Mark("was not triggered", "–", "bright_black", "#6b7280", "#8b949e"),
    Verdict.INCONCLUSIVE: Mark("is inconclusive", "?", "yellow", "#9a6700", "#e3b341"),
}
"""The look of each verdict; the contrast with the page is at least 4.5 to 1."""


def verdict_colours() -> str:
    """The colours as CSS variables named by the verdicts' letters, for light and dark pages."""
    light = "".join(f"--{verdict.value}:{mark.light};" for verdict, mark in MARKS.items())
    dark = "".join(f"--{verdict.value}:{mark.dark};" for verdict, mark in MARKS.items())
    return f":root{{{light}}}@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}"


def verdict_text(verdict: Verdict) -> tuple[str, str]:
    """A verdict for the terminal, its letter and its sign, with its style."""
    mark = MARKS[verdict]
    return f"{verdict.value:<2} {mark.sign}", mark.terminal


_WITHIN_VALUE = re.compile(r"(?<=\d) (?=[A-Za-zµ°%])|(?<=\w) (?== )|(?<= =) ")
_TOGETHER = "\N{NO-BREAK SPACE}"


def wrapped(sentence: str, width: int) -> str:
    """A sentence in lines, the first indented by two columns, the others by four.

    A number is kept on one line with its unit, and with `name =` before it.

    >>> print(wrapped("`released` occurred at 4.75 s, 0.75 s after the trigger", 32))
      `released` occurred at 4.75 s,
        0.75 s after the trigger
    """
    # `fill` would not change these sentences; most are such, and `fill` is slow.
    if len(sentence) + 2 <= width and sentence.isprintable() and not sentence.endswith(" "):
        return f"  {sentence}"
    whole = _WITHIN_VALUE.sub(_TOGETHER, sentence)
    lines = textwrap.fill(
        whole, width, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False
    )
    return lines.replace(_TOGETHER, " ")


def in_short(message: str) -> str:
    r"""The first line of a message, with the second one if it ends in a colon.

    >>> in_short("there is no column for what is read:\n  `go`, read by R1\n  say which it is")
    'there is no column for what is read: `go`, read by R1'
    """
    first, *rest = message.split("\n")
    return f"{first} {rest[0].strip()}" if rest and first.endswith(":") else first
