"""Requirements, example timelines and results of the analysis as text for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence

from rvmon.analysis.example import Budget, Example, SearchResult
from rvmon.analysis.graph import graph_lines, graph_of
from rvmon.analysis.plain_english import facts_of, requirement_in_words
from rvmon.analysis.shortest_examples import Analysis, difference_of, shortest_examples, verdict_of
from rvmon.analysis.vacuity import Possible, possible
from rvmon.language.checked.formula import BoundAtom, Constant
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.language.print import format_duration
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.report.printer import Line, plain
from rvmon.report.wording import MARKS
from rvmon.trace.sample import Scalar, Value
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt

HIGH, LOW, NOBODY_KNOWS, OCCURS = "▇", "▁", "?", "●"
NARROWEST = 9  # the least width of a column, in characters


def picture_of(example: Example, spec: CheckedSpec, read: Collection[str]) -> list[Line]:
    """An example timeline as lines, at most 80 columns wide if possible.

    Time is not to scale: each instant with a sample, trigger or decision has a column.
    """
    instants = _instants(example)
    names = [name for name in (*spec.signals, *spec.events) if name in read]
    heads = [*names, *example.verdicts, "time"]
    margin = max(len(head) for head in heads) + 4
    labels = [label_of(t) for t in instants]
    cells = {name: _cells(name, example, spec, instants) for name in names}
    widest = max([len(label) for label in labels] + [len(c) for row in cells.values() for c in row])
    room = (WIDTH - margin) // len(instants)
    width = max(min(max(widest + 2, NARROWEST), room), 4)
    legend = legend_of(labels)
    lines: list[Line] = [
        [
            (f"  {'time':<{margin - 2}}", "dim"),
            ("".join(f"{label:<{width}}" for label in labels).rstrip(), "dim"),
            (f"   ({legend})" if legend else "", "dim"),
        ]
    ]
    for name in names:
        drawn = "".join(_fill(cell, width) for cell in cells[name])
        lines.append([f"  {name:<{margin - 2}}{drawn.rstrip()}"])
    for name in example.verdicts:
        lines += _verdict_lines(name, example, instants, margin, width)
    return lines


def _instants(example: Example) -> list[int]:
    ends = [end for attempt in example.attempts if (end := attempt.decided) is not None]
    triggers = [attempt.triggered for attempt in example.attempts]
    return sorted({example.end, *ends, *triggers, *(sample.t for sample in example.samples)})


def _cells(name: str, example: Example, spec: CheckedSpec, instants: Sequence[int]) -> list[str]:
    """The cells of a row: a text, or one character that fills the column."""
    given = {sample.t: sample.values[name] for sample in example.samples if name in sample.values}
    if name in spec.events:
        return [_occurrence(given.get(t, False)) for t in instants]
    stale_after = spec.signals[name].stale_after
    cells: list[str] = []
    before = ""
    value: Value = None
    at = 0
    for t in instants:
        if t in given:
            value, at = given[t], t
        stale = stale_after is not None and t - at > stale_after
        shown = _scalar(None if stale or isinstance(value, Mapping | tuple) else value)
        unit = spec.signals[name].type.unit
        text = f"{shown} {unit}" if unit and shown not in (HIGH, LOW, NOBODY_KNOWS) else shown
        plain = text in (HIGH, LOW, NOBODY_KNOWS)
        # A value is written at its change; a line means that it stays. Blocks are lines already.
        cells.append("─" if text == before and not plain else text)
        before = text
    return cells


def _scalar(value: Scalar) -> str:
    match value:
        case bool():
            return HIGH if value else LOW
        case None:
            return NOBODY_KNOWS
        case int() | float():
            return f"{value:.6g}"
        case str():
            return value


def _occurrence(value: Value) -> str:
    if value is False:
        return "·"
    if value is None:
        return NOBODY_KNOWS
    if isinstance(value, Mapping) and value:
        texts = {key: str(v).lower() if isinstance(v, bool) else str(v) for key, v in value.items()}
        return OCCURS + " " + " ".join(f"{key}={text}" for key, text in texts.items())
    return OCCURS + " "


def _fill(cell: str, width: int) -> str:
    if cell in (HIGH, LOW, NOBODY_KNOWS, "─"):
        return cell * width
    if cell == "·":
        return f"{cell:<{width}}"
    filler = " " if cell.startswith(OCCURS) else "─"
    text = cell if len(cell) < width else cell[: width - 2] + "…"
    return (text + " ").ljust(width, filler) if filler == "─" else text.ljust(width)


def _verdict_lines(
    name: str, example: Example, instants: Sequence[int], margin: int, width: int
) -> list[Line]:
    attempts = [attempt for attempt in example.attempts if attempt.requirement == name]
    if not attempts:
        mark = MARKS[Verdict.NOT_TRIGGERED]
        return [[(f"  {name:<{margin - 2}}{mark.sign} NT no attempt", mark.terminal)]]
    lines: list[Line] = []
    for attempt in attempts:
        head = name if len(attempts) == 1 else attempt.name
        mark = MARKS[attempt.verdict]
        drawn = _attempt(attempt, example, instants, width)
        verdict = f"{mark.sign} {attempt.verdict.value}"
        lines.append([f"  {head:<{margin - 2}}{drawn}", (verdict, mark.terminal)])
    return lines


def _attempt(attempt: Attempt, example: Example, instants: Sequence[int], width: int) -> str:
    """The bar of an attempt, from its trigger to its decision or the end of the run."""
    first = instants.index(attempt.triggered)
    last = instants.index(example.end if attempt.decided is None else attempt.decided)
    if first == last:
        return " " * (first * width) + "▼ "
    return " " * (first * width) + "▼" + "┄" * ((last - first) * width - 2) + " "


def label_of(t: int) -> str:
    """An instant; one tick before or after a round one is marked ⁻ or ⁺.

    >>> label_of(3_000_000_001), label_of(199_999_999), label_of(0), label_of(1_500_000_000)
    ('3 s⁺', '200 ms⁻', '0 s', '1500 ms')
    """
    if t < 1000 or not (t + 1) % 1000:
        return f"{format_duration(t + 1)}⁻" if t >= 1000 else format_duration(t)
    return f"{format_duration(t - 1)}⁺" if t % 1000 == 1 else format_duration(t)


def legend_of(labels: list[str]) -> str:
    """The legend of the signs in some labels; "" if there are none."""
    signs = {"⁺": "after", "⁻": "before"}
    used = [
        f"{sign} a tick {word}" for sign, word in signs.items() if any(sign in x for x in labels)
    ]
    return ", ".join(used)


WIDTH = 80
_SHOWN = (
    (Verdict.PASS, "passes"),
    (Verdict.FAIL, "fails"),
    (Verdict.NOT_TRIGGERED, "is not triggered"),
    (Verdict.INCONCLUSIVE, "stays open"),
)


def explained(compiled: CompiledSpec, name: str, budget: Budget | None = None) -> Iterator[Line]:
    """One requirement: words, facts, automaton, and the shortest timeline of each verdict."""
    own = compiled.requirements[name]
    yield _title(own.requirement)
    yield []
    for line in requirement_in_words(own.requirement):
        yield _wrapped(line, "  ", "    ")
    yield []
    for heading, fact in facts_of(own).items():
        yield _wrapped(fact, f"  {heading:<12}", " " * 14)
    if own.automaton is not None:
        yield []
        yield [("The automaton", "bold")]
        for line in graph_lines(graph_of(own, own.automaton, compiled.checked)):
            yield [line]
    yield []
    yield [("The shortest run on which it …", "bold")]
    trigger, at_end = own.obligation.trigger, own.requirement.at_end
    can = possible(compiled.checked, trigger, own.automaton, at_end)
    impossible = _impossible(own.requirement, can)
    wanted = [verdict.value for verdict, _ in _SHOWN if verdict not in impossible]
    search = shortest_examples(compiled, [own], verdict_of(name), wanted, budget)
    for verdict, phrase in _SHOWN:
        yield []
        example = search.examples.get(verdict.value)
        if example is not None:
            yield [f"… {phrase}"]
            yield from picture_of(example, compiled.checked, _names_read(own))
        else:
            yield _wrapped(f"… {phrase}: {impossible.get(verdict) or _not_found(search)}", "", "  ")


def difference_explained(
    compiled: CompiledSpec, first: str, second: str, budget: Budget | None = None
) -> Iterator[Line]:
    """Two requirements: the shortest timelines on which they differ."""
    pair = [compiled.requirements[name] for name in (first, second)]
    for requirement in pair:
        yield _title(requirement.requirement)
        for line in requirement_in_words(requirement.requirement):
            yield _wrapped(line, "  ", "    ")
        yield []
    goal = difference_of(first, second)
    search = shortest_examples(compiled, pair, goal, ["hard", "soft"], budget)
    read = _names_read(pair[0]) | _names_read(pair[1])
    if not search.examples:
        yield _wrapped(f"No run was found on which they differ: {_not_found(search)}", "", "  ")
    for kind, phrase in (("hard", "one fails and the other does not"), ("soft", "they differ")):
        example = search.examples.get(kind)
        if example is not None:
            yield [(f"The shortest run on which {phrase}", "bold")]
            yield from picture_of(example, compiled.checked, read)
            yield []


def _title(requirement: Requirement) -> Line:
    text = f"{requirement.id}  {requirement.text}".rstrip()
    end = len(requirement.id)
    wrapped = textwrap.fill(text, WIDTH, subsequent_indent=" " * (end + 2))
    return [(wrapped[:end], "bold"), wrapped[end:]]


def _impossible(requirement: Requirement, can: Possible) -> Mapping[Verdict, str]:
    """The impossible verdicts, each with the reason."""
    reasons = {}
    match requirement.trigger, requirement.mode:
        case (BoundAtom(), _) | (Constant(value=True), Mode.WHENEVER):
            reasons[Verdict.NOT_TRIGGERED] = "never, every run triggers it"
    if can.trigger is False:
        reason = "never, nothing can trigger it"
        reasons |= dict.fromkeys((Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE), reason)
    if can.pass_ is False:
        reasons[Verdict.PASS] = "never, whatever comes"
    if can.fail is False:
        reasons[Verdict.FAIL] = "never, whatever comes: at worst it stays open"
    return reasons


def _not_found(search: SearchResult) -> str:
    tried = f"none found in {search.runs} short runs"
    return f"{tried}, which are all there are" if search.exhausted else f"{tried}; not decided"


def _names_read(compiled: CompiledRequirement) -> frozenset[str]:
    each = compiled.requirement.for_each
    return compiled.reads | ({each.value.event} if each else set())


def _wrapped(text: str, first: str, rest: str) -> Line:
    return [textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=rest)]


def analysis_lines(analysis: Analysis, spec: CheckedSpec) -> list[str]:
    """The lines to print below the diagnostics of an analysis."""
    lines: list[str] = []
    for conflict, example in analysis.timelines:
        ids = list(dict.fromkeys(conflict.ids))
        fails = f"one of {', '.join(ids)} fails" if len(ids) > 1 else f"{ids[0]} fails"
        lines += [f"After this, {fails}, whatever comes:"]
        drawn = {name for sample in example.samples for name in sample.values}
        lines += map(plain, picture_of(example, spec, drawn))
        lines.append("")
    examination = analysis.examination
    if examination.undecided:
        lines.append(f"not decided alone: {', '.join(examination.undecided)}")
    if examination.pairs_undecided:
        lines.append(
            f"not decided for {examination.pairs_undecided} of {examination.pairs} pairs that "
            "read a common name"
        )
    if examination.sets_undecided:
        lines.append(f"not decided for {examination.sets_undecided} larger sets")
    if examination.whole_sets is not None:
        lines.append(f"not all sets of more than {examination.whole_sets} were examined")
    if not examination.implications_done:
        lines.append("not all were examined for being implied by others")
    return lines
