"""A requirement explained in the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from rvmon.analysis.possible import Possible, possible
from rvmon.explain.example import Budget, Found
from rvmon.explain.facts import facts_of
from rvmon.explain.graph import graph_of
from rvmon.explain.graph_text import graph_lines
from rvmon.explain.search import difference_of, shortest_examples, verdict_of
from rvmon.explain.words import requirement_in_words
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.report.example_text import picture_of
from rvmon.spec.checked.formula import BoundAtom, Constant
from rvmon.spec.checked.specification import Mode, Requirement
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import RenderableType

WIDTH = 80
_SHOWN = (
    (Verdict.PASS, "passes"),
    (Verdict.FAIL, "fails"),
    (Verdict.NOT_TRIGGERED, "is not triggered"),
    (Verdict.INCONCLUSIVE, "stays open"),
)


def explained(
    compiled: CompiledSpec, name: str, budget: Budget | None = None
) -> Iterator[RenderableType]:
    """One requirement: words, facts, automaton, the shortest timeline of each verdict."""
    from rich.text import Text

    one = compiled.requirements[name]
    yield _title(one.requirement)
    yield ""
    for line in requirement_in_words(one.requirement):
        yield _wrapped(line, "  ", "    ")
    yield ""
    for heading, fact in facts_of(one).items():
        yield _wrapped(fact, f"  {heading:<12}", " " * 14)
    if one.automaton is not None:
        yield ""
        yield Text("The automaton", style="bold")
        for line in graph_lines(graph_of(one, one.automaton, compiled.checked)):
            yield Text(line)
    yield ""
    yield Text("The shortest run on which it …", style="bold")
    can = possible(compiled.checked, one.obligation.trigger, one.automaton, one.requirement.at_end)
    impossible = _impossible(one.requirement, can)
    wanted = [verdict.value for verdict, _ in _SHOWN if verdict not in impossible]
    found = shortest_examples(compiled, [one], verdict_of(name), wanted, budget)
    for verdict, phrase in _SHOWN:
        yield ""
        example = found.examples.get(verdict.value)
        if example is not None:
            yield Text(f"… {phrase}")
            yield from picture_of(example, compiled.checked, _concerned(one))
        else:
            yield _wrapped(f"… {phrase}: {impossible.get(verdict) or _not_found(found)}", "", "  ")


def difference_explained(
    compiled: CompiledSpec, first: str, second: str, budget: Budget | None = None
) -> Iterator[RenderableType]:
    """Two requirements: the shortest timelines on which they differ."""
    from rich.text import Text

    pair = [compiled.requirements[name] for name in (first, second)]
    for one in pair:
        yield _title(one.requirement)
        for line in requirement_in_words(one.requirement):
            yield _wrapped(line, "  ", "    ")
        yield ""
    goal = difference_of(first, second)
    found = shortest_examples(compiled, pair, goal, ["hard", "soft"], budget)
    concerned = _concerned(pair[0]) | _concerned(pair[1])
    if not found.examples:
        yield _wrapped(f"No run was found on which they differ: {_not_found(found)}", "", "  ")
    for kind, phrase in (("hard", "one fails and the other does not"), ("soft", "they differ")):
        example = found.examples.get(kind)
        if example is not None:
            yield Text(f"The shortest run on which {phrase}", style="bold")
            yield from picture_of(example, compiled.checked, concerned)
            yield ""


def _title(requirement: Requirement) -> RenderableType:
    from rich.text import Text

    text = f"{requirement.id}  {requirement.text}".rstrip()
    wrapped = Text(textwrap.fill(text, WIDTH, subsequent_indent=" " * (len(requirement.id) + 2)))
    wrapped.stylize("bold", 0, len(requirement.id))
    return wrapped


def _impossible(requirement: Requirement, can: Possible) -> Mapping[Verdict, str]:
    """The verdicts that cannot be, each with the reason."""
    found = {}
    if _is_always_triggered(requirement):
        found[Verdict.NOT_TRIGGERED] = "never, every run triggers it"
    if can.trigger is False:
        reason = "never, nothing can trigger it"
        found |= dict.fromkeys((Verdict.PASS, Verdict.FAIL, Verdict.INCONCLUSIVE), reason)
    if can.pass_ is False:
        found[Verdict.PASS] = "never, whatever comes"
    if can.fail is False:
        found[Verdict.FAIL] = "never, whatever comes: at worst it stays open"
    return found


def _is_always_triggered(requirement: Requirement) -> bool:
    match requirement.trigger:
        case BoundAtom():
            return True
        case Constant(value=True):
            return requirement.mode is Mode.WHENEVER
        case _:
            return False


def _not_found(found: Found) -> str:
    tried = f"none found in {found.runs} short runs"
    return f"{tried}, all that there are to try" if found.exhausted else f"{tried}; not decided"


def _concerned(one: CompiledRequirement) -> frozenset[str]:
    each = one.requirement.for_each
    return one.reads | ({each.value.event} if each else set())


def _wrapped(text: str, first: str, rest: str) -> RenderableType:
    from rich.text import Text

    return Text(textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=rest))
