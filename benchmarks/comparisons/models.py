"""The model checker against a walk through all regions."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

from benchmarks.comparisons.timed_ltl import LinearTruth, satisfied_by
from tests.rvmon.models.search.timed_ctl import holds_at_start
from tests.tools.differential import Campaign
from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import Steps, TooManyRegionsError, shows

from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.network import LeadsToFormula, Network, ValueQuery
from rvmon.models.network.expressions import UnaryOp, UnaryOperation
from rvmon.models.network.guards import compares_of, is_linear
from rvmon.models.runs import Ending
from rvmon.models.runs.exact_times import Rules
from rvmon.models.search.budget import Policy
from rvmon.models.search.verify import verify

MOST_REGIONS = 1_500

KINDS = (
    "E<> p", "A[] p", "A<> p", "E[] p", "p --> q", "p -->[<=T] q", "E<>[<=T] p", "A<>[<=T] p",
    "E<> deadlock", "A[] (deadlock imply p)", "A[] (p imply EF q)", "E<> (p and AG q)",
    "A[] (p or AF q)", "E<>[<=T] deadlock",
)  # fmt: skip
"""The kinds of queries of a random network, in their order."""

CTL = (
    *("(EF# ({}))", "(AG# ({}))", "(AF# ({}))", "(EG# ({}))", "(AX ({}))", "(EX ({}))"),
    *("(A[{} U# {}])", "(E[{} U# {}])", "(A[{} W# {}])", "(E[{} W# {}])"),
)
LTL = ("F ({})", "G ({})", "F ({})", "G ({})", "({} U {})", "({} W {})", "({} imply {})")
JOINED = ("not ({})", "({} and {})", "({} or {})", "{}")
"""Templates of formulas: CTL, LTL, and connectives for both."""


def _network(seed: int, number: int) -> Network:
    drawn = number if seed == 1 else Random(f"{seed}/{number}").randrange(1 << 40)
    return loads_network(random_model(drawn), name=f"random-{number}")


def judge_queries(found: Campaign, seed: int, numbers: range) -> None:
    """Queries on random networks against a walk through all regions."""
    for number in numbers:
        network, policy = _network(seed, number), tuple(Policy)[number % 3]
        steps: Steps = {}
        for kind, query in zip(KINDS, network.queries, strict=True):
            outcome = verify(network, query, policy=policy)
            if outcome.run is not None:
                found.counts["runs checked as concrete runs"] += 1
                if not shows(network, outcome):
                    found.disagreements.append(
                        f"network {number}: the run does not show that {query.text}"
                    )
            try:
                expected = holds_at_start(network, query, MOST_REGIONS, steps)
            except TooManyRegionsError:
                found.counts["left out: too many regions"] += 1
                continue
            found.counts[f"{kind}: {str(expected).lower()}"] += 1
            if outcome.holds != expected:
                told = f"zones {outcome.holds}, regions {expected}"
                found.disagreements.append(f"network {number}: {query.text}: {told}")


def judge_logics(found: Campaign, seed: int, numbers: range) -> None:
    """CTL and LTL on random networks against fixpoints and a tableau on all regions."""
    for number in numbers:
        network, random = _network(seed, number), Random(number)
        states = [f"({query.text.partition(' ')[2]})" for query in network.queries[:4]]
        formulas = [
            random_formula(random, own, size, forms, (*forms, *JOINED))
            for own, forms in (([*states, "deadlock"], CTL), (states, LTL))
            for size in (1, 2, 2, 3, 3, 4)
        ]
        for text in formulas:
            try:
                agrees = _agrees(network, text, found)
            except TooManyRegionsError:
                found.counts["left out: too many regions"] += 1
            except ModelError:
                found.counts["left out: the network cannot start"] += 1
            else:
                found.disagreements += [] if agrees else [f"network {number}: {text}"]


def _agrees(network: Network, text: str, found: Campaign) -> bool:
    query = query_on(network, text)[1]
    formula, outcome = query.formula, verify(network, query)
    if isinstance(formula, LeadsToFormula | ValueQuery) or not is_linear(formula):
        found.counts[f"CTL: {str(outcome.holds).lower()}"] += 1
        return outcome.holds == holds_at_start(network, query, 300)
    denied = UnaryOperation(UnaryOp.NOT, formula)
    agrees = outcome.holds != LinearTruth(network, denied, False, 3_000).some_run()
    found.counts[f"LTL: {str(outcome.holds).lower()}"] += 1
    if outcome.run is not None:
        Rules(network).replay(outcome.run)
        found.counts["LTL: runs replayed"] += 1
        if not list(compares_of(denied)):
            agrees = agrees and satisfied_by(network, outcome.run, denied)
            found.counts["LTL: runs that refute the formula by its own meaning"] += 1
        stops = outcome.run.ending in (Ending.ZENO_LOOP, Ending.TIME_LOCK)
        found.counts["LTL: only by time that stops"] += stops
        agrees = agrees and stops != LinearTruth(network, denied, True, 6_000).some_run()
    return agrees


def random_formula(
    random: Random, states: list[str], size: int, forms: Sequence[str], nested: Sequence[str]
) -> str:
    """A random formula of one of the forms over state formulas, with at most `size` operators.

    A `#` in a form is replaced by a bound, or by nothing.
    """
    if not size:
        return random.choice(states)
    form = random.choice(forms)
    bound = f"[<={random.randint(0, 3)}]" if random.random() < 0.25 else ""
    parts = form.count("{}")
    operands = (
        random_formula(random, states, (size - 1) // parts, nested, nested) for _ in range(parts)
    )
    return form.replace("#", bound).format(*operands)
