"""A specification made ready for monitors: formulas, alphabets, engines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from typing import Any

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.bulk import moves_in_runs
from rvmon.automaton.construct import Budget, DoesNotCloseError, construct
from rvmon.automaton.forecast import Forecaster
from rvmon.automaton.machine import Machine
from rvmon.automaton.progression import Progression
from rvmon.automaton.reduce import reduce
from rvmon.automaton.shapes import Shapes
from rvmon.dataflow.chain import Chain, Windows, chain_of, reach_of
from rvmon.dataflow.network_plan import plan_of
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.dataflow.soonest_news import delay_of
from rvmon.errors import RvmonError
from rvmon.formula.alphabet import Alphabet, alphabet_of
from rvmon.formula.core import Core
from rvmon.formula.expand import expanded
from rvmon.formula.factory import Factory
from rvmon.formula.lower import lower
from rvmon.formula.obligation import Obligation, UnmonitorableError
from rvmon.formula.residual import Residual
from rvmon.formula.state import State
from rvmon.monitor.reasons.obligation_words import Words
from rvmon.plan.graph import Graph, graph_of, leaf_count, leaf_texts
from rvmon.plan.numbers import events_of, inputs_of
from rvmon.runtime.table_machine import TableMachine
from rvmon.spec.checked.formula import Compare
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement

MOST_SEEN = 19
"""So many truth values, seen at the trigger, fit into a number of 32 bits."""

_BESIDE = Budget(locations=30, clocks=3, rows=200, clauses=12)
"""What judges attempts in doubt has to be small: it is rarely asked for, and built beside each."""


class CompiledRequirement:
    """One requirement, ready to be judged by any engine; what an engine needs is made at first use.

    Attributes:
        rank: its place in the file.
        spec: the specification that it is of.
        requirement: as checked.
        obligation: its formulas.
        alphabet: of what it owes.
        gap: ticks between two positions; `None` if only samples are positions.
        is_beside: whether this judges the attempts in doubt of a requirement.
        measured: its formulas as they are measured: their truth is that of `obligation`.
    """

    def __init__(
        self,
        rank: int,
        spec: CheckedSpec,
        requirement: Requirement,
        obligation: Obligation,
        factory: Factory,
        shapes: Shapes,
        *,
        is_beside: bool = False,
        measured: Callable[[], Obligation],
    ) -> None:
        self._factory = factory
        self._shapes = shapes
        self.is_beside = is_beside
        self._measured = measured
        self.rank = rank
        self.spec = spec
        self.gap = spec.gap
        self.requirement = requirement
        self.obligation = obligation
        self.alphabet: Alphabet = alphabet_of(obligation.owed)
        self._owed = factory.next(obligation.owed)
        self.evaluators: dict[object, Any] = {}
        """What was generated for its runs; see `rvmon.monitor.attempts.evaluator_classes`."""

    @cached_property
    def _built(self) -> Automaton | DoesNotCloseError:
        if self.network_plan.looks_back:
            return DoesNotCloseError("something of the future below an operator of the past")
        try:
            return reduce(construct(self._owed, self.alphabet, self._budget), self.words.label)
        except DoesNotCloseError as error:
            return error.with_traceback(None)  # which would keep the frames of whoever asked

    @property
    def automaton(self) -> Automaton | None:
        """Its automaton; `None` if that does not close."""
        return self._built if isinstance(self._built, Automaton) else None

    @cached_property
    def shaped(self) -> Automaton | None:
        """Its automaton as the core has it, which those of its shape share; `None`: as above."""
        return self._shapes.reduced(self._owed, self.alphabet, self._budget)

    @cached_property
    def shaped_residuals(self) -> Sequence[Residual]:
        """What is owed in the locations of that."""
        return self._shapes.residuals(self._owed, self.alphabet, self._budget)

    @property
    def _budget(self) -> Budget:
        return _BESIDE if self.is_beside else Budget()

    @property
    def refusal(self) -> str:
        """Why it has no automaton, or empty."""
        return str(self._built) if isinstance(self._built, DoesNotCloseError) else ""

    def in_runs(self, automaton: Automaton | None) -> bool:
        """Whether its open attempts are kept in runs if an automaton of it judges them."""
        requirement = self.requirement
        return (
            automaton is not None
            and self.obligation.trigger is not None
            and not requirement.captures
            and requirement.for_each is None
            and leaf_count(self._read) <= MOST_SEEN
            and moves_in_runs(automaton)
        )

    @cached_property
    def follows_windows(self) -> bool:
        """Whether generated windows, within windows, judge it though it has an automaton.

        That steps each open attempt by itself; the windows are one step for all of them.
        """
        return (
            self.is_fed
            and self.obligation.trigger is not None
            and self._chain is not None
            and len(self._chain.windows) > 1
            and self.automaton is not None
            and not self.in_runs(self.automaton)
        )

    @cached_property
    def hidden(self) -> CompiledRequirement | None:
        """What judges its attempts in doubt; `None` if there are none."""
        return self._beside(self.obligation.hidden, lambda: self.measured.hidden)

    @cached_property
    def doubted(self) -> CompiledRequirement | None:
        """The same where no trigger is sure."""
        return self._beside(self.obligation.doubted, lambda: self.measured.doubted)

    @property
    def judges(self) -> Mapping[str, CompiledRequirement]:
        """What judges its attempts: it, and those that are in doubt."""
        beside = {"": self, "?": self.hidden, "??": self.doubted}
        return {kind: one for kind, one in beside.items() if one is not None}

    def _beside(
        self, obligation: Obligation | None, measured: Callable[[], Obligation | None]
    ) -> CompiledRequirement | None:
        if obligation is None:
            return None
        return CompiledRequirement(
            self.rank,
            self.spec,
            self.requirement,
            obligation,
            self._factory,
            self._shapes,
            is_beside=True,
            measured=lambda: measured() or obligation,
        )

    @cached_property
    def _table(self) -> TableMachine | None:
        return None if self.automaton is None else TableMachine(self.automaton)

    @cached_property
    def _progression(self) -> Progression:
        return Progression(self._owed, self.alphabet, self.requirement.id)

    @cached_property
    def network_plan(self) -> NetworkPlan:
        """The nodes of its delay network."""
        return plan_of(self.obligation.owed, self.gap)

    @cached_property
    def _chain(self) -> Chain | None:
        return None if self.is_beside else chain_of(self.network_plan, self.gap)

    @cached_property
    def windows(self) -> type[Windows] | None:
        """What follows its network's windows; `None` if they are no chain."""
        from rvmon.codegen.python_windows import windows_class

        chain = self._chain
        return None if chain is None else windows_class(self.network_plan, chain, self.gap)

    @cached_property
    def reach(self) -> int | None:
        """Of its network, as `reach_of` says it."""
        return reach_of(self.network_plan)

    @cached_property
    def measured_owed(self) -> Core:
        """What it owes as far as that is measured, propositions that look back taken apart."""
        return expanded(self.measured.owed)

    @cached_property
    def measured(self) -> Obligation:
        """See `CompiledRequirement`."""
        return self._measured()

    def network_delay(self, letter: Sequence[bool]) -> int:
        """Ticks that pass in its delay network until an attempt that begins can be decided."""
        key = tuple(letter)
        found = self._delays.get(key)
        if found is None:
            found = self._delays[key] = delay_of(self.network_plan, self.gap, letter)
        return found

    @cached_property
    def _delays(self) -> dict[tuple[bool, ...], int]:
        return {}

    @property
    def is_fed(self) -> bool:
        """Whether generated code in this process can work out what it reads."""
        return self.requirement.for_each is None and not self.requirement.captures

    @property
    def counts_alone(self) -> bool:
        """Whether which attempts it has does not hang on what becomes of them.

        Episodes go on after a failure; what is in doubt leaves no record if it is met.
        """
        upon = self.requirement.mode is Mode.UPON and self.obligation.trigger is not None
        return upon and self.is_fed and not self.is_beside

    def engine(self, name: str) -> str:
        """Which of `automaton`, `network` and `progression` judges it where no code is generated.

        Args:
            name: of the engine that was asked for, and that does not refuse this requirement.
        """
        if name in ("network", "progression"):
            return name
        if self.automaton is None or (self.follows_windows and name != "automaton"):
            return "network"
        return "automaton"

    def machine(self, engine: str) -> Machine:
        """The machine that judges its attempts, if it is none of `network`.

        Args:
            engine: as `engine` takes it.
        """
        if self.engine(engine) == "automaton" and self._table is not None:
            return self._table
        return self._progression

    @cached_property
    def forecaster(self) -> Forecaster:
        """Tells what is still possible for its open attempts."""
        return Forecaster()

    @cached_property
    def shared_graph(self) -> Graph:
        """The state formulas of all its attempts: with `let`, only those of the trigger."""
        return graph_of(self._shared)

    @property
    def _shared(self) -> Iterator[State]:
        obligation = self.obligation
        states = (obligation.trigger, obligation.determined, obligation.doubt)
        yield from (one for one in states if one is not None)
        if not self.requirement.captures:
            yield from self._own
        for beside in (self.hidden, self.doubted):
            if beside is not None:
                yield from beside._shared

    @property
    def _own(self) -> Iterator[State]:
        """The state formulas of an attempt."""
        obligation = self.obligation
        yield from self.alphabet.propositions
        yield from (one for one in (obligation.again, obligation.unborn) if one is not None)
        if self.requirement.mode is Mode.WHENEVER:
            states = (obligation.trigger, obligation.running)
            yield from (one for one in states if one is not None)

    @cached_property
    def leaves(self) -> tuple[tuple[State, str], ...]:
        """What it reads of the input, with its text."""
        return leaf_texts(graph_of(self._read))

    @property
    def _read(self) -> Sequence[State]:
        """The state formulas whose leaves are shown of it."""
        trigger = self.obligation.trigger
        return (*(() if trigger is None else (trigger,)), *self.alphabet.propositions)

    @cached_property
    def reads(self) -> frozenset[str]:
        """The signals and events that it reads."""
        graph = graph_of(state for state, _ in self.leaves)
        return frozenset(graph.by_name) | frozenset(
            name for capture in self.requirement.captures for name in inputs_of(capture.value)
        )

    @cached_property
    def single_payloads(self) -> frozenset[str]:
        """The events of which it can judge one payload at an instant only."""
        own = self.requirement.for_each
        read = {
            event
            for state, _ in self.leaves
            if isinstance(state.leaf, Compare)
            for event in events_of(state.leaf.left, state.leaf.right)
        }
        return frozenset(read) - frozenset([own.value.event] if own else [])

    @cached_property
    def words(self) -> Words:
        """Names its parts."""
        return Words(self.obligation.origins)

    @cached_property
    def consequent_graph(self) -> Graph:
        """The propositions of what it owes."""
        return graph_of(self._own)

    def looks_back_beyond(self, followed: Graph) -> bool:
        """Whether what it owes depends on what was before the trigger and `followed` lacks."""
        graph = self.consequent_graph
        if self.network_plan.looks_back or graph.remembers_captured:
            return True
        return any(graph.nodes[place] not in followed.index for place in graph.stateful)


def compiled_requirements(
    checked: CheckedSpec, *, next_law: bool = False
) -> Mapping[str, CompiledRequirement]:
    """The requirements of a specification, compiled, by id.

    Args:
        checked: as checked.
        next_law: see `CompiledSpec`.

    Raises:
        RvmonError: one is beyond all engines; which one and why is in the message.
    """
    factory, shapes = Factory(), Shapes()
    made = {}
    for rank, (name, requirement) in enumerate(checked.requirements.items()):
        try:
            obligation = lower(
                requirement,
                factory,
                checked.period,
                next_law=next_law,
                sampled=checked.gap is None,
            )
        except UnmonitorableError as error:
            span = requirement.span
            place = "" if span is None else f"{span.source.name}:{span.line}: "
            raise RvmonError(
                f"{place}{name} cannot be monitored: {error}. Move what lies ahead behind `then`"
            ) from None
        measured = partial(
            lower,
            requirement,
            factory,
            checked.period,
            measured=True,
            next_law=next_law,
            sampled=checked.gap is None,
        )
        given = (rank, checked, requirement, obligation, factory, shapes)
        made[name] = CompiledRequirement(*given, measured=measured)
    return made
