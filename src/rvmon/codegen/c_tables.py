"""The automata of a plan as C tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rvmon.automaton.location import PASSED
from rvmon.automaton.table import TableData, tables_of
from rvmon.formula.state import State
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.spec.checked.specification import EndPolicy, Mode
from rvmon.verdict.attempt import Decision
from rvmon.verdict.end import settle_at_end
from rvmon.verdict.verdict import Verdict

VERDICTS = (Verdict.FAIL, Verdict.PASS, Verdict.INCONCLUSIVE, Verdict.NOT_TRIGGERED)
DECISIONS = (Decision.PREFIX, Decision.HELD_TO_END, Decision.POLICY, Decision.OPEN)

_TABLES = (
    *("class_of", "bases", "clocks", "strides", "cut_first", "cuts", "edges", "targets"),
    *("sources", "time_values", "clause_first", "test_first", "tests"),
)
"""The arrays of an automaton."""

_WAITING = ", ".join([str(PASSED + 1), "0", *("NULL" for _ in _TABLES)])
"""In place of an automaton where a network judges: an attempt is neither passed nor failed."""


def automata_source(plan: Plan, forms: Mapping[int, int], numbers: Sequence[int]) -> Iterator[str]:
    """The tables of all requirements, and the array `automata` of them.

    Args:
        plan: what is generated.
        forms: by number of a judge that has one, that of its form; see `Networks`.
        numbers: of the requirements of its rules, among all.
    """
    width = max((r.automaton.clocks for _, r in plan.judges if r.automaton), default=0) or 1
    entries = []
    for index, (owner, rule) in enumerate(plan.judges):
        yield ""
        doubt = ", its attempts in doubt" if index >= len(plan.rules) else ""
        yield f"/* Requirement number {numbers[owner]}{doubt}. */"
        machine = _WAITING
        if rule.automaton is not None:
            data = tables_of(rule.automaton)
            yield from _arrays(data, index, width)
            machine = _machine(data, index)
        yield array("uint8_t", f"outcomes{index}", outcomes(rule.requirement.at_end))
        form = forms.get(index, -1)
        judging = f"{machine}, {form if rule.automaton is None else -1}, {form}"
        entries.append(_entry(plan, (owner, numbers[owner]), rule, judging, index))
    if not entries:  # which C does not have
        places, flags = ", ".join(["-1"] * 10), ", ".join(["false"] * 4)
        entries.append(f"    {{{_WAITING}, {places}, {flags}, NULL}},")
    yield ""
    yield "static const automaton automata[] = {"
    yield from entries
    yield "};"


def repeats(rule: PlannedRule) -> bool:
    """Whether a trigger that stays true starts an attempt at each position."""
    return rule.requirement.pulse and not runs_on(rule)


def runs_on(rule: PlannedRule) -> bool:
    """Whether an attempt runs until its trigger is false."""
    return rule.requirement.mode is Mode.WHENEVER


def outcomes(policy: EndPolicy) -> list[int]:
    """What becomes of an undecided attempt: verdict plus 4 times the decision.

    Counted through in binary: whether it holds by the rule for the end (1), can pass no more (2),
    can fail no more (4).
    """
    found = []
    for state in range(8):
        verdict, decision = settle_at_end(
            policy,
            held=bool(state & 1),
            cannot_pass=bool(state & 2),
            cannot_fail=bool(state & 4),
        )
        found.append(VERDICTS.index(verdict) + 4 * DECISIONS.index(decision))
    return found


def _arrays(data: TableData, index: int, width: int) -> Iterator[str]:
    cut_first, strides = [0], []
    cuts: list[int] = []
    for location, own in enumerate(data.cuts):
        for clock in range(width):
            some = own[clock] if clock < len(own) else ()
            cuts += some
            cut_first.append(len(cuts))
            strides.append(data.strides[location][clock] if clock < len(own) else 0)
    edges = sorted({edge for row in data.rows for edge in row if edge is not None})
    number = {edge: position for position, edge in enumerate(edges)}
    sources = [
        source for _, own in edges for source in (*own, *(0 for _ in range(width - len(own))))
    ]
    clause_first, test_first = [0], [0]
    tests: list[tuple[int, int, bool]] = []
    for clauses in data.end_clauses:
        for clause in clauses:
            tests += clause
            test_first.append(len(tests))
        clause_first.append(len(test_first) - 1)
    yield array("uint16_t", f"class_of{index}", data.class_of)
    yield array("int32_t", f"bases{index}", data.bases)
    yield array("uint8_t", f"clocks{index}", [len(own) for own in data.cuts])
    yield array("int32_t", f"strides{index}", strides)
    yield array("int32_t", f"cut_first{index}", cut_first)
    yield array("int64_t", f"cuts{index}", cuts)
    flat = [0 if edge is None else number[edge] for row in data.rows for edge in row]
    yield array("int32_t", f"edges{index}", flat)
    yield array("uint16_t", f"targets{index}", [target for target, _ in edges])
    yield array("int8_t", f"sources{index}", sources)
    yield array("uint8_t", f"time_values{index}", data.time_values)
    yield array("int32_t", f"clause_first{index}", clause_first)
    yield array("int32_t", f"test_first{index}", test_first)
    shown = ", ".join(
        f"{{{clock}, INT64_C({age}), {str(at_end).lower()}}}" for clock, age, at_end in tests
    )
    yield f"static const end_test tests{index}[] = {{{shown or '{0, 0, false}'}}};"


def _machine(data: TableData, index: int) -> str:
    """The fields of an automaton: where it begins, its classes of letters, its tables."""
    classes = len(data.rows[0]) if data.rows else 1
    return ", ".join([str(data.initial), str(classes), *(f"{name}{index}" for name in _TABLES)])


def _entry(plan: Plan, owner: tuple[int, int], rule: PlannedRule, judging: str, index: int) -> str:
    def places(*formulas: State | None) -> str:
        index = plan.graph.index
        return ", ".join(str(-1 if state is None else index[state]) for state in formulas)

    requirement = rule.requirement
    named = places(rule.trigger, rule.again, rule.unborn, rule.determined)
    running = places(rule.running if requirement.captures else rule.trigger, rule.blurs)
    whose = ", ".join(map(str, owner))
    hidden = index >= len(plan.rules)
    own = (rule.blurs_anywhere, requirement.pulse, hidden or runs_on(rule), hidden)
    flags = ", ".join(str(flag).lower() for flag in own)
    return f"    {{{judging}, {named}, {whose}, {running}, {flags}, outcomes{index}}},"


def array(kind: str, name: str, values: Sequence[int]) -> str:
    """A constant array; one of no elements holds a zero that nobody reads."""
    texts = [f"INT64_C({v})" if kind == "int64_t" else str(v) for v in values] or ["0"]
    return f"static const {kind} {name}[] = {{{', '.join(texts)}}};"


def lists(first: str, name: str, values: Sequence[Sequence[int]]) -> Iterator[str]:
    """Lists one behind the other, and where each begins."""
    starts = [0]
    for own in values:
        starts.append(starts[-1] + len(own))
    yield array("int32_t", first, starts)
    yield array("int32_t", name, [value for own in values for value in own])
