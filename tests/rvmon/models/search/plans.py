"""Plans of the native search for random networks."""

from collections.abc import Iterable, Iterator

from tests.tools.timed_generate import random_model

from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.network import LeadsToFormula, Network, ValueQuery
from rvmon.models.network.derived import Watcher
from rvmon.models.network.expressions import (
    FALSE,
    TRUE,
    ClockCompare,
    ClockOp,
    Constant,
    Expression,
    PathFormula,
)
from rvmon.models.network.guards import normal_form
from rvmon.models.search.budget import Policy
from rvmon.models.search.ltl import buchi_of
from rvmon.models.search.search_plan import Plan, Seek, Sought

_LINEAR = "G F (P0.l0 or x > 1)", "(F G P0.l1 and not (b U x < 2))"
_NESTS = "AG (EF[<=2] P0.l1 or A[not P0.l0 U[<=3] deadlock] or EX AF x > 1)"


def search_plans(seeds: Iterable[int]) -> Iterator[Plan]:
    """A plan of each kind for some random networks."""
    for seed in seeds:
        network = loads_network(random_model(seed))
        formulas = [network.queries[k].formula for k in (0, 1, 10)]
        some, other, nested = (f.body for f in formulas if isinstance(f, PathFormula))
        some, other, nested = normal_form(some), normal_form(other), normal_form(nested, False)
        for sought in (
            *(Sought(Seek.GOAL, some, choose=choose) for choose in Policy),
            Sought(Seek.GOAL, some, bound=3),
            Sought(Seek.DEADLOCK, some, other),
            Sought(Seek.STAY, None, other),
            Sought(Seek.STAY_AFTER, some, other),
            Sought(Seek.LATE, None, other, bound=2),
            Sought(Seek.LATE_AFTER, some, other, bound=2),
            Sought(Seek.NESTED, nested=nested),
            *(
                Sought(Seek.RUN, automaton=buchi_of(normal_form(linear), None), progress=progress)
                for linear in (_formula(network, text) for text in _LINEAR)
                for progress in (False, True)
            ),
            Sought(Seek.START, nested=normal_form(_formula(network, _NESTS))),
        ):
            yield Plan(network, sought)
        yield Plan(_watched(network), Sought(Seek.GOAL, FALSE))


def _watched(network: Network) -> Network:
    """The network with a watcher that allows moves a unit apart and makes one of its own."""
    watcher = Watcher(network, [], [""])
    for _ in range(3):
        watcher.add_location([ClockCompare(watcher.clock, ClockOp.LE, Constant(9))])
    since = [ClockCompare(watcher.clock, ClockOp.GE, Constant(1))]
    watcher.add_edge(0, 1)
    watcher.add_edge(1, 2, TRUE, since, [watcher.clock])
    watcher.add_edge(2, 0, TRUE, since, watches=False)
    return watcher.network()


def _formula(network: Network, text: str) -> Expression:
    formula = query_on(network, text)[1].formula
    assert not isinstance(formula, LeadsToFormula | ValueQuery)
    return formula
