"""Compiles requirements for the core: core formulas, alphabets, and automata or networks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial

from rvmon.errors import RvmonError
from rvmon.language.checked.formula import BoundAtom, Compare, Constant
from rvmon.language.checked.names_read import names_in
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.logic.alphabet import Alphabet, alphabet_of
from rvmon.logic.automaton import Automaton, moves_in_runs
from rvmon.logic.automaton_shapes import Shapes
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.forecast import Forecaster
from rvmon.logic.formula import Core, Factory
from rvmon.logic.lower import Obligation, UnmonitorableError, lower
from rvmon.logic.network_plan import NetworkPlan, plan_of
from rvmon.logic.normal_form import expanded
from rvmon.logic.reduce import reduce
from rvmon.logic.residual import Residual
from rvmon.logic.state_formula import State, events_of
from rvmon.logic.state_graph import graph_of, leaf_texts
from rvmon.logic.window_chains import reach_of
from rvmon.monitor.obligation_words import Words

_DOUBT_BUDGET = Budget(locations=30, clocks=3, rows=200, clauses=12)
"""The budget of automata for attempts in doubt, which are rarely used and so kept small."""


class CompiledRequirement:
    """One requirement, compiled; each derived form is built at its first use.

    Attributes:
        rank: its index in the file.
        spec: the specification it belongs to.
        requirement: as checked.
        obligation: its formulas.
        alphabet: the alphabet of the obligation.
        gap: ticks between two positions; `None` if only samples are positions.
        ordinary: the requirement whose attempts in doubt this one judges; `None` if this is itself
            the ordinary one.
        measured: the obligation for robustness: logically equivalent, but with the comparisons
            whose distances are measured kept apart.
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
        ordinary: CompiledRequirement | None = None,
        measured: Callable[[], Obligation],
    ) -> None:
        self._factory = factory
        self._shapes = shapes
        self.ordinary = ordinary
        self._measured = measured
        self.rank = rank
        self.spec = spec
        self.gap = spec.gap
        self.requirement = requirement
        self.obligation = obligation
        self.alphabet: Alphabet = alphabet_of(obligation.required)
        self._required = factory.next(obligation.required)

    @cached_property
    def _built(self) -> Automaton | DoesNotCloseError:
        if self.network_plan.looks_back:
            return DoesNotCloseError("something of the future below an operator of the past")
        try:
            return reduce(construct(self._required, self.alphabet, self._budget), self.words.label)
        except DoesNotCloseError as error:
            return error.with_traceback(None)  # a traceback would keep the caller's frames alive

    @property
    def automaton(self) -> Automaton | None:
        """Its automaton, as shown to users; `None` if the construction exceeds its budget."""
        return self._built if isinstance(self._built, Automaton) else None

    @cached_property
    def shaped(self) -> Automaton | None:
        """The automaton for the core, shared by requirements of the same shape; `None` as above."""
        return self._shapes.reduced(self._required, self.alphabet, self._budget)

    @cached_property
    def shaped_residuals(self) -> Sequence[Residual]:
        """The residual of each location of `shaped`."""
        return self._shapes.residuals(self._required, self.alphabet, self._budget)

    @property
    def _budget(self) -> Budget:
        return Budget() if self.ordinary is None else _DOUBT_BUDGET

    @property
    def refusal(self) -> str:
        """Why it has no automaton; empty if it has one."""
        return str(self._built) if isinstance(self._built, DoesNotCloseError) else ""

    def scatters(self, automaton: Automaton | None) -> bool:
        """Whether open attempts may spread over ever more states, each to be stepped on its own.

        They do not if only one is open at a time, if each has captured values and is judged by
        itself, or if they move through `automaton` in runs.
        """
        one = self.requirement
        once = isinstance(one.trigger, Constant | BoundAtom)
        return not (automaton is None or once or one.captured or moves_in_runs(automaton))

    @cached_property
    def hidden(self) -> CompiledRequirement | None:
        """The requirement that judges its attempts in doubt; `None` if it can have none."""
        return self._doubt_judge(self.obligation.hidden, lambda: self.measured.hidden)

    @cached_property
    def doubted(self) -> CompiledRequirement | None:
        """The same for an instance of `for each` that may not exist."""
        return self._doubt_judge(self.obligation.doubted, lambda: self.measured.doubted)

    def _doubt_judge(
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
            ordinary=self,
            measured=lambda: measured() or obligation,
        )

    @cached_property
    def network_plan(self) -> NetworkPlan:
        """The nodes of its delay network."""
        return plan_of(self.obligation.required, self.gap)

    @cached_property
    def reach(self) -> int | None:
        """`reach_of` its network, ticks."""
        return reach_of(self.network_plan)

    @cached_property
    def measured_required(self) -> Core:
        """The obligation for robustness, with past operators expanded so that they are measured."""
        return expanded(self.measured.required)

    @cached_property
    def measured(self) -> Obligation:
        """See `CompiledRequirement`."""
        return self._measured()

    @property
    def counts_alone(self) -> bool:
        """Whether its attempts start independently of how earlier ones end.

        Episodes do not, as they resume after a failure; nor do attempts in doubt, which have no
        record if they are met.
        """
        upon = self.requirement.mode is Mode.UPON and self.obligation.trigger is not None
        return upon and not self.requirement.captured and self.ordinary is None

    @cached_property
    def forecaster(self) -> Forecaster:
        """Forecasts the verdicts of its open attempts; its cache is shared by all of them."""
        return Forecaster()

    @cached_property
    def leaves(self) -> tuple[tuple[State, str], ...]:
        """The leaves whose values its records show, with their text; see `leaf_texts`."""
        determined = (self.ordinary or self).obligation.determined
        return leaf_texts(self._read, () if determined is None else (determined,))

    @property
    def _read(self) -> Sequence[State]:
        """The state formulas whose leaves appear in its records."""
        trigger = self.obligation.trigger
        return (*(() if trigger is None else (trigger,)), *self.alphabet.propositions)

    @cached_property
    def reads(self) -> frozenset[str]:
        """The signals and events that it reads."""
        graph = graph_of(state for state, _ in self.leaves)
        return frozenset(graph.by_name) | frozenset(
            name for capture in self.requirement.captures for name in names_in(capture.value)
        )

    @cached_property
    def single_payloads(self) -> frozenset[str]:
        """The events of which it can judge only one payload at an instant."""
        each = self.requirement.for_each
        read = {
            event
            for state, _ in self.leaves
            if isinstance(state.leaf, Compare)
            for event in events_of(state.leaf.left, state.leaf.right)
        }
        return frozenset(read) - frozenset([each.value.event] if each else [])

    @cached_property
    def words(self) -> Words:
        """Puts its parts into words, for explanations."""
        return Words(self.obligation.origins, self.requirement.consequent)


def compiled_requirements(checked: CheckedSpec) -> Mapping[str, CompiledRequirement]:
    """The requirements of a specification, compiled, by id.

    Raises:
        RvmonError: one cannot be monitored; the message says which one and why.
    """
    factory, shapes = Factory(), Shapes()
    compiled = {}
    for rank, (name, requirement) in enumerate(checked.requirements.items()):
        lowered = partial(lower, requirement, factory, checked.period, sampled=checked.gap is None)
        try:
            obligation = lowered()
        except UnmonitorableError as error:
            span = requirement.span
            place = "" if span is None else f"{span.source.name}:{span.line}: "
            raise RvmonError(
                f"{place}{name} cannot be monitored: {error}. Move the future operators after "
                "`then`"
            ) from None
        given = (rank, checked, requirement, obligation, factory, shapes)
        compiled[name] = CompiledRequirement(*given, measured=partial(lowered, measured=True))
    return compiled
