"""Requirements of a specification, checked on all runs of a network."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

from rvmon.logic.automaton import NOW
from rvmon.logic.construct import Budget as TableBudget
from rvmon.logic.construct import DoesNotCloseError, construct
from rvmon.logic.formula import Factory, horizon, looks_back
from rvmon.logic.letters import alphabet_of
from rvmon.logic.lower import Obligation, lower
from rvmon.logic.state_formula import StateOp
from rvmon.spec.checked.formula import BoundAtom
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, TimeModel
from rvmon.timed.conformance.recordings import labels_of
from rvmon.timed.language.elaborate import signal_on
from rvmon.timed.model.evaluate import Evaluator, evaluator
from rvmon.timed.model.expressions import VariableValue
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import BaseType
from rvmon.timed.model.refine import finer
from rvmon.timed.model.rules import model_error
from rvmon.timed.model.scope import PlacedSymbol
from rvmon.timed.observation.lasting import Lasting, open_means
from rvmon.timed.observation.observer import (
    Observed,
    ObservedLink,
    ObservedSite,
    Phase,
    is_failed,
    is_passed,
)
from rvmon.timed.observation.propositions import Labelling, NotExpressibleError
from rvmon.timed.runs.paths import PathStep, invariant_of, make_run
from rvmon.timed.runs.run import Ending, Run
from rvmon.timed.runs.timing import TimedStep
from rvmon.timed.search.explore import Node, explore
from rvmon.timed.search.meter import Meter
from rvmon.timed.search.outcome import UNLIMITED, Budget, Statistics, Watch
from rvmon.timed.zones.dbm import STRICT
from rvmon.timed.zones.symbolic import check_clocks, check_start
from rvmon.timed.zones.zone_unions import Constraint
from rvmon.trace.time import TICKS_PER_UNIT

MET_IN_THE_END = "none stays open for ever while time passes on"
OPEN_FOR_EVER = "an attempt stays open for ever"
UNDECIDED_IN_THE_END = "none fails it; that it is met in the end, a query such as A<> decides"
"""What is reported of a requirement without deadline that no finite run fails."""

_Node = Node[ObservedSite, ObservedLink]


@dataclass(frozen=True, slots=True)
class Observation:
    """A requirement on all runs of a network.

    Attributes:
        requirement: its id.
        text: the requirement in words.
        holds: whether no attempt of any run fails; `None` if the budget ended first, or if the
            network cannot express it.
        triggered: a run with an attempt; `None`: there is none, so that the claim is vacuous.
        passing: a run with an attempt that passes.
        failing: a run with an attempt that fails.
        network: in whose unit the runs are.
        statistics: what it cost.
        remark: why it is not decided, or what the answer does not cover.
    """

    requirement: str
    text: str
    holds: bool | None
    triggered: Run | None
    passing: Run | None
    failing: Run | None
    network: Network
    statistics: Statistics
    remark: str = ""


def observe(
    network: Network,
    spec: CheckedSpec,
    *,
    bindings: Mapping[str, str] | None = None,
    budget: Budget = UNLIMITED,
    watch: Watch | None = None,
) -> Iterator[Observation]:
    """Check each requirement of a specification on all runs of a network.

    Signals are the network's `signal` lines, its variables of the same name, or bindings; events
    are labels of its edges, or its channels.

    Args:
        network: with a unit of time.
        spec: in held time.
        bindings: expressions over the network by signal.
        budget: when to give up, for each requirement.
        watch: called now and then.

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


def _problem(
    network: Network, spec: CheckedSpec, requirement: Requirement, *, ticks: bool = False
) -> tuple[Network, Observed, Obligation]:
    """The product of a network, in finer units if need be, with a requirement's monitor."""
    if spec.time is not TimeModel.HELD:
        raise NotExpressibleError("only requirements in held time are checked on models")
    if requirement.captures or requirement.for_each is not None:
        raise NotExpressibleError("it captures values")
    factory = Factory()
    obligation = lower(requirement, factory)
    alphabet = alphabet_of(obligation.required)
    labelling = Labelling(signals_of(network), frozenset(labels_of(network)))
    trigger = obligation.trigger
    if looks_back(obligation.required):
        raise NotExpressibleError("it looks back from what lies ahead")
    if trigger is None:
        raise NotExpressibleError("it is evaluated at the end of a trace")
    if not (trigger.op is StateOp.LEAF and isinstance(trigger.leaf, BoundAtom)):
        labelling.reader(trigger)
    for proposition in alphabet.propositions:
        labelling.reader(proposition)
    try:
        automaton = construct(factory.next(obligation.required), alphabet, TableBudget())
    except DoesNotCloseError as error:
        raise NotExpressibleError(f"it has no finite monitor: {error}") from None
    unit = network.unit or 1
    # A strict bound lies a tick behind its number; any other cut asks for a finer unit.
    if any(cut % unit > 1 for cut in automaton.cuts) and unit % TICKS_PER_UNIT["ms"] == 0:
        network = finer(network, unit // TICKS_PER_UNIT["ms"])
    product = Observed(network, obligation, requirement.pulse, automaton, labelling, ticks)
    return network, product, obligation


def _in_the_end(
    network: Network, spec: CheckedSpec, requirement: Requirement, meter: Meter
) -> tuple[bool | None, Run | None, str]:
    """Whether what has no deadline is met, where no finite run fails it; else a run."""
    network, problem, obligation = _problem(network, spec, requirement, ticks=True)
    met = open_means(obligation.required)
    if met is None and requirement.mode is Mode.WHENEVER and not problem.reads_events:
        # Within a stretch without actions what one attempt meets the others do.
        attempts = replace(requirement, mode=Mode.UPON, pulse=True)
        network, problem, obligation = _problem(network, spec, attempts, ticks=True)
        met = open_means(obligation.required)
    if met is not False:
        return True, None, "" if met else UNDECIDED_IN_THE_END
    found = Lasting(problem, meter).find()
    if meter.stopped:
        return None, None, f"not decided: {meter.stopped}"
    if found is None:
        return True, None, MET_IN_THE_END
    node, loop = found
    ending = Ending.IDLE if loop is None else Ending.LOOP
    return False, observed_run(network, problem, node, ending, loop), OPEN_FOR_EVER


def _observe(
    network: Network, spec: CheckedSpec, requirement: Requirement, meter: Meter
) -> Observation:
    original = network
    network, problem, obligation = _problem(network, spec, requirement)
    first: dict[str, _Node] = {}

    def visit(node: _Node) -> None:
        if node.site.phase is not Phase.IDLE:
            first.setdefault("triggered", node)
        if is_passed(node.site):
            first.setdefault("passing", node)
        elif is_failed(node.site):
            first.setdefault("failing", node)

    explore(problem, meter, visit)
    runs = {name: observed_run(network, problem, node) for name, node in first.items()}
    holds: bool | None = "failing" not in first
    remark = ""
    if meter.stopped and holds:
        holds, remark = None, f"not decided: {meter.stopped}"
    elif holds and "triggered" not in first:
        remark = "vacuous: no run triggers it"
    elif holds and horizon(obligation.required) is None:
        holds, run, remark = _in_the_end(original, spec, requirement, meter)
        runs.update({} if run is None else {"failing": run})
    return Observation(
        requirement.id,
        requirement.text,
        holds,
        runs.get("triggered"),
        runs.get("passing"),
        runs.get("failing"),
        network,
        meter.statistics(),
        remark,
    )


def signals_of(network: Network) -> dict[str, Evaluator]:
    """How specifications' names are read off the network; its own variables come last."""
    signals = {}
    for name, symbol in network.names.top.symbols.items():
        if isinstance(symbol, PlacedSymbol) and symbol.kind is BaseType.INT and symbol.is_single:
            signals[name] = evaluator(VariableValue(symbol.slot))
    for signal in network.signals:
        signals[signal.name] = evaluator(signal.value)
    return signals


def observed_run(
    network: Network,
    problem: Observed,
    node: Node[ObservedSite, ObservedLink],
    ending: Ending = Ending.REACHED,
    loop: int | None = None,
) -> Run:
    """The run that leads to a node of the product."""
    nodes = node.path()
    clock_of = dict.fromkeys(range(problem.base, problem.dim), problem.dim)
    steps = []
    for number, (before, after) in enumerate(pairwise(nodes), start=1):
        assert after.link is not None, "only the first node has no link"
        own = problem.dim + number
        steps.append(_step(problem, before.site, after.link, after.site, clock_of, own))
    return make_run(network, nodes[0].site.state, steps, ending, loop)


def _step(
    problem: Observed,
    here: ObservedSite,
    link: ObservedLink,
    behind: ObservedSite,
    clock_of: dict[int, int],
    own: int,
) -> PathStep:
    """One instant; `clock_of` says which step's clock each of the monitor's clocks is."""
    state, move = here.state, link.move
    leave: list[Constraint] = [invariant_of(state)]
    if here.phase is Phase.HELD:
        held = (*problem.held(here.location, here.region), (problem.since, 0, -STRICT))
        leave.append(_renamed(held, clock_of))
    if move is not None:
        leave.append(move.guard)
    for step in link.steps:
        leave.append(_renamed(step.constraint, clock_of))
        sources = [own if s == NOW else clock_of[problem.base + s] for s in step.sources]
        clock_of.update(enumerate(sources, start=problem.base))
    resets: tuple[tuple[int, float], ...] = ((own, 0.0),)
    if move is not None:
        clock_of[problem.since] = own
        resets = (*move.resets, *resets)
    waits = state.delays and here.phase is not Phase.FRESH
    bounds = tuple(bound for constraint in leave for bound in constraint)
    timed = TimedStep(waits, bounds, resets, invariant_of(behind.state))
    return PathStep(timed, move, behind.state)


def _renamed(constraint: Constraint, clock_of: dict[int, int]) -> Constraint:
    return tuple((clock_of.get(x, x), clock_of.get(y, y), bound) for x, y, bound in constraint)
