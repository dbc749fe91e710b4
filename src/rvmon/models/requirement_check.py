"""Check the requirements of a specification on all runs of a network."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement, TimeModel
from rvmon.logic import formula as mtl
from rvmon.logic.alphabet import alphabet_of
from rvmon.logic.construct import Budget as TableBudget
from rvmon.logic.construct import DoesNotCloseError, construct
from rvmon.logic.lower import Obligation, lower
from rvmon.models import model_error
from rvmon.models.conform import labels_of
from rvmon.models.language.elaborate import signal_on
from rvmon.models.network import Network, check_clocks
from rvmon.models.network import expressions as ex
from rvmon.models.network.derived import finer
from rvmon.models.network.evaluate import Evaluator, evaluator
from rvmon.models.network.guards import conjunction, disjunction
from rvmon.models.network.scope import PlacedSymbol
from rvmon.models.requirement_observer import Observed
from rvmon.models.requirement_propositions import NotExpressibleError
from rvmon.models.runs import Run
from rvmon.models.runs.moves import check_start
from rvmon.models.search.budget import UNLIMITED, Budget, Meter, Statistics, Watch
from rvmon.models.search.native_search import seek
from rvmon.models.search.search_plan import Seek, Sought
from rvmon.trace.time import TICKS_PER_UNIT

MET_IN_THE_END = "no attempt stays open forever while time passes"
OPEN_FOR_EVER = "an attempt stays open forever"
UNDECIDED_IN_THE_END = "no run fails it; a query such as A<> decides whether it is met in the end"
"""Remarks on a requirement without a deadline that no finite run violates."""


@dataclass(frozen=True, slots=True)
class Observation:
    """The result of a requirement, over all runs of a network."""

    requirement: str  # its id
    text: str  # the requirement in words
    # whether no attempt of any run fails; `None` if the budget was exhausted, or if the requirement
    # cannot be expressed on the network
    holds: bool | None
    triggered: Run | None  # a run with an attempt; `None`: there is none, the result is vacuous
    passing: Run | None  # a run with an attempt that passes
    failing: Run | None  # a run with an attempt that fails
    network: Network  # the network in whose unit of time the runs are given
    statistics: Statistics  # the cost of the search
    remark: str = ""  # why there is no decision, or what the result does not cover


def observe(
    network: Network,
    spec: CheckedSpec,
    *,
    bindings: Mapping[str, str] | None = None,
    budget: Budget = UNLIMITED,
    watch: Watch | None = None,
) -> Iterator[Observation]:
    """Check each requirement of a specification on all runs of a network.

    The signals of the specification are `signal` lines of the network, variables of the same name,
    or bindings. Its events are labels of edges and names of channels.

    Args:
        network: with a unit of time.
        spec: in held time.
        bindings: expressions over the network, by signal.
        budget: limits of the search, for each requirement.
        watch: called from time to time with the progress.

    Raises:
        ModelError: the network has no unit or cannot start, or a binding has no meaning on it.
    """
    if network.unit is None:
        raise model_error("TA023", "the model has no unit of time", None, "write `unit 50 ms`")
    check_start(network)
    check_clocks(network)
    bound = [signal_on(network, name, text) for name, text in (bindings or {}).items()]
    network = replace(network, signals=(*network.signals, *bound))
    for requirement in spec.requirements.values():
        meter = Meter(budget, watch)
        try:
            yield _observe(network, spec, requirement, meter)
        except NotExpressibleError as error:
            yield Observation(
                requirement.id, requirement.text, None, None, None, None, network,
                meter.statistics(), f"not expressible: {error}",
            )  # fmt: skip


def _with_monitor(
    network: Network, spec: CheckedSpec, requirement: Requirement
) -> tuple[Network, Observed, Obligation]:
    """The network, in finer units if necessary; the same with the monitor of a requirement."""
    if spec.time is not TimeModel.HELD:
        raise NotExpressibleError("only requirements in held time are checked on models")
    if requirement.captures or requirement.for_each is not None:
        raise NotExpressibleError("it captures values")
    factory = mtl.Factory()
    obligation = lower(requirement, factory)
    alphabet = alphabet_of(obligation.required)
    trigger = obligation.trigger
    if mtl.looks_back(obligation.required):
        raise NotExpressibleError("its consequent refers to the past")
    if trigger is None:
        raise NotExpressibleError("it is evaluated at the end of a trace")
    try:
        automaton = construct(factory.next(obligation.required), alphabet, TableBudget())
    except DoesNotCloseError as error:
        raise NotExpressibleError(f"it has no finite monitor: {error}") from None
    unit = network.unit or 1
    # A strict bound is one tick after a multiple of the unit. Any other cut needs a finer unit.
    if any(cut % unit > 1 for cut in automaton.cuts) and unit % TICKS_PER_UNIT["ms"] == 0:
        network = finer(network, unit // TICKS_PER_UNIT["ms"])
    signals, labels = _values(network), frozenset(labels_of(network))
    watched = Observed(network, obligation, requirement.pulse, automaton, signals, labels)
    return network, watched, obligation


def _decide_unbounded(
    network: Network, spec: CheckedSpec, requirement: Requirement, meter: Meter
) -> tuple[bool | None, Run | None, str]:
    """Decide a requirement without a deadline that no finite run fails.

    Returns:
        Whether it is met on all runs, `None` if undecided; a run on which it is not; a remark.
    """
    original, (_, problem, obligation) = network, _with_monitor(network, spec, requirement)
    met = open_means(obligation.required)
    if met is None and requirement.mode is Mode.WHENEVER and not problem.reads_events:
        # Attempts from one stretch without actions are met alike, so one of them is enough.
        attempts = replace(requirement, mode=Mode.UPON, pulse=True)
        _, problem, obligation = _with_monitor(network, spec, attempts)
        met = open_means(obligation.required)
    if met is not False:
        return True, None, "" if met else UNDECIDED_IN_THE_END
    run = None
    # First look where no invariant bounds time: runs that idle there are the shortest.
    for first in (conjunction((problem.rests, _unbounded(original))), problem.is_open):
        if run is None and not meter.stopped:
            sought = Sought(Seek.STAY_AFTER, first, problem.is_open)
            run = seek(problem.network, sought, meter, proper_only=True).run
    if meter.stopped:
        return None, None, f"not decided: {meter.stopped}"
    if run is None:
        return True, None, MET_IN_THE_END
    return False, run, OPEN_FOR_EVER


def _observe(
    network: Network, spec: CheckedSpec, requirement: Requirement, meter: Meter
) -> Observation:
    original = network
    network, problem, obligation = _with_monitor(network, spec, requirement)
    sought = {"failing": problem.failed, "triggered": problem.triggered, "passing": problem.passed}
    runs = {name: _reached(problem, goal, meter) for name, goal in sought.items()}
    holds: bool | None = runs["failing"] is None
    if holds and _reached(problem, problem.lost, meter) is not None:
        raise NotExpressibleError("its monitor changes at every instant")
    remark = ""
    if meter.stopped and holds:
        holds, remark = None, f"not decided: {meter.stopped}"
    elif holds and runs["triggered"] is None:
        remark = "vacuous: no run triggers it"
    elif holds and mtl.horizon(obligation.required) is None:
        holds, runs["failing"], remark = _decide_unbounded(original, spec, requirement, meter)
    return Observation(
        requirement.id, requirement.text, holds, **runs, network=network,
        statistics=meter.statistics(), remark=remark,
    )  # fmt: skip


def _unbounded(network: Network) -> ex.Expression:
    """Whether every automaton is in a location whose invariant bounds no clock."""
    free = (
        tuple(
            ex.InLocation(index, number)
            for number, place in enumerate(automaton.locations)
            if place.kind is ex.LocationKind.NORMAL and not place.invariant.clocks
        )
        for index, automaton in enumerate(network.automata)
    )
    return conjunction(disjunction(places) for places in free)


def _reached(problem: Observed, goal: ex.Expression, meter: Meter) -> Run | None:
    """A run to a state with the goal; `None` if there is none or the budget is exhausted."""
    if meter.stopped:
        return None
    run = seek(problem.network, Sought(Seek.GOAL, goal), meter).run
    if run is not None and run.steps and run.steps[-1].action is None:
        # The monitor decides just after time has made the difference; this last wait is not shown.
        return replace(run, steps=run.steps[:-1], timing=None)
    return run


def open_means(required: mtl.Core) -> bool | None:
    """Whether an attempt that stays open forever is met; `None` if the formula cannot tell.

    A formula may promise without a deadline (`eventually`: not met) or prohibit without one
    (`always`: met), but for an answer not both.
    """
    nodes = list(mtl.nodes_of(required))
    unbounded = {
        isinstance(node, mtl.Release)
        for node in nodes
        if isinstance(node, mtl.Until | mtl.Release) and node.high is None
    }
    if len(unbounded) > 1 or any(isinstance(node, mtl.Next) for node in nodes):
        return None
    return unbounded.pop() if unbounded else True


def signals_of(network: Network) -> dict[str, Evaluator]:
    """Evaluators by name of the network's variables, and of its signals, which take precedence."""
    return {name: evaluator(value) for name, value in _values(network).items()}


def _values(network: Network) -> dict[str, ex.Expression]:
    values: dict[str, ex.Expression] = {}
    for name, symbol in network.names.top.symbols.items():
        match symbol:
            case PlacedSymbol(ex.BaseType.INT, slot) if slot.is_single:
                values[name] = ex.VariableValue(slot)
    for signal in network.signals:
        values[signal.name] = signal.value
    return values
