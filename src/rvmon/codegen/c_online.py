"""A compiled monitor that Python steps: the C of a plan as an extension module of this Python.

ctypes would cost more per call than the monitor itself; the module takes samples as dictionaries
and hands back what was decided.
"""

from __future__ import annotations

import sys
import sysconfig
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_loader
from itertools import accumulate
from pathlib import Path
from struct import unpack
from typing import Any, Protocol

from rvmon.codegen.c_build import NATIVE, Build, loaded
from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_exact import whole_limits
from rvmon.codegen.c_margins import Measures
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_network import Networks
from rvmon.codegen.c_source import c_files
from rvmon.codegen.c_tables import DECISIONS, VERDICTS, array, lists
from rvmon.codegen.c_text import filled, template
from rvmon.codegen.comment import comment
from rvmon.dataflow.chain import reach_of
from rvmon.errors import RvmonError
from rvmon.formula.numeric import operands
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Arithmetic, Compare, FieldValue, UpdateValue
from rvmon.spec.checked.specification import Type
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Attempt

_PARTS = ("online.c.in", "online_calls.c.in", "online_type.c.in")
_PARTS_MEASURED = (*_PARTS[:2], "online_margins.c.in", _PARTS[2])
_PARTS_BESIDE = (
    *_PARTS[:2],
    *(f"beside{part}.c.in" for part in ("_letters", "", "_state")),
    _PARTS[2],
)

_MODULE = "rvmon_online"

_KINDS = (Kind.BOOL, Kind.INT, Kind.REAL, Kind.LABEL)
"""In the order of the template's `IS_…`."""

FAST = ("-O3", "-fno-math-errno", NATIVE)
"""Of a monitor that is worth the time that the compiler takes."""

_SHARED = ("-shared", "-fPIC", "-fvisibility=hidden")
"""All modules call their functions alike; where names are shared (`sys.setdlopenflags`), one would
call those of another."""

NEVER = (1 << 63) - 1
"""The instant of what does not happen."""

NOT_YET = -1 << 63
"""The instant of what did not happen."""


NOBODY, BY_CHANGE, ALWAYS = range(3)
"""Whom it concerns what a sample says of a name; see `Core.lend`."""

_SLOTS = (
    *("requirement", "number", "triggered", "decided", "verdict", "decision"),
    *("in_doubt", "_details", "_noted"),
)
"""The fields of an attempt that are set in C, in the order of the template's `SLOT_…`."""


class _Details:
    """Gives attempts the fields that are not set in C: nothing, but for captured values."""

    def __init__(self, plan: Plan) -> None:
        self._captured = CapturedValues(plan)
        self._numbers = {rule.requirement.id: n for n, rule in enumerate(plan.asked)}

    def __call__(self, attempt: Attempt, noted: bytes | None) -> Mapping[str, Any]:
        bare = Attempt(attempt.requirement, 0, 0, None, attempt.verdict)
        names = [one.name for one in fields(Attempt) if one.name not in _SLOTS]
        found = {name: getattr(bare, name) for name in names}
        if noted is not None:
            values = unpack(f"{self._captured.count}d", noted)
            number = self._numbers[attempt.requirement]
            found["captured"] = self._captured.of(number, values)
        return found


class Core(Protocol):
    """The compiled monitor: what `online_type.c.in` lists."""

    step: Callable[[float, Mapping[str, Any]], Sequence[Attempt]]
    step_ns: Callable[[int, Mapping[str, Any]], Sequence[Attempt]]

    def take(self, t: int, values: dict[str, Any], /) -> None:
        """Judge a sample that is in order, of plain values."""

    def advance(self, t: int, /) -> None:
        """Let time come to `t`."""

    def flush(self) -> Sequence[Attempt]:
        """The attempts that were decided since the last call."""

    def lend(self, state: bytes, ledger: list[Attempt], concerns: bytes, /) -> None:
        """Take a state over, beside a monitor in Python; what is decided comes into its ledger.

        `concerns` is, per name, whether Python looks at samples of another value of it, or at all.
        """

    def look_at(self, t: int, /) -> None:
        """Have Python look at all samples from `t` on; said anew after each at which it looks."""

    def take_back(self) -> bytes:
        """The state, as `lend` takes it; Python goes on from there once it says `give_up`."""

    def give_up(self) -> None:
        """Take no samples until the next `lend`."""

    def is_fresh(self, t: int, /) -> bool:
        """Whether all that can become stale is not so at `t`, if nothing comes."""

    def attend(self, attended: bool, /) -> None:
        """Say whether what hears of decisions is called; it says `free` when it has looked."""

    def free(self) -> None:
        """Have samples be taken, as before a decision was heard of."""

    def close(self, until: int | None, /) -> int:
        """End the run; gives the last instant, or `NOT_YET`."""

    def records(self) -> bytes:
        """All records, each as `rvmon.codegen.c_batch.record_type` has it."""

    def counts(self) -> list[tuple[int, int, int, int]]:
        """How many attempts of each requirement failed, passed, and stayed open.

        The last number is 1 if its trigger was ever true or false.
        """

    def open(self) -> list[Attempt]:
        """The attempts that are undecided now, and those that will stay so."""

    def times(self) -> tuple[bool, int, int, int]:
        """Whether there was a sample; when the first one was, the last, and the present."""

    def hold(self, held: bool, /) -> bool:
        """Begin or end a call of which Python does a part: meanwhile no sample is taken quickly.

        False, and nothing is done, while a decision is heard of.
        """

    def next_due(self) -> int:
        """The next instant at which time alone can decide something, or `NEVER`."""

    def reset(self) -> None:
        """Begin anew."""

    # Where robustness is measured; `step`, `step_ns`, `flush` and `open` then give `Measured`.

    def feed(self, times: Any, columns: tuple[Any, ...], /) -> int:
        """Take samples that are rows.

        Args:
            times: int64[n] ticks.
            columns: per signal and event an array: bool[n], or float64[n] of numbers, NaN where
                nothing is known; `None`: it never comes.

        Returns:
            How many were taken: fewer than given if one is out of order.
        """

    def figures(self) -> bytes:
        """What was settled of attempts and not given out, as `margin_judge.c.in` lays it out."""

    def series(self, requirement: int, /) -> tuple[bytes, bytes, bytes, bytes]:
        """What a requirement owes at the rows: int64[n] ticks, three times float64[n]."""


@dataclass(frozen=True, slots=True)
class OnlineLibrary:
    """A plan compiled to a type of Python.

    Attributes:
        plan: of requirements that all have automata.
        names: of the plan.
        limits: of whole numbers, by signal and `event.field`.
        type: makes a `Core`.
    """

    plan: Plan
    names: Names
    limits: Mapping[str, int]
    type: Callable[..., Core]

    def core(
        self,
        absent: frozenset[str],
        *,
        look_closer: Callable[[float, Mapping[str, Any]], Sequence[Attempt]],
        look_closer_ns: Callable[[int, Mapping[str, Any]], Sequence[Attempt]],
        heard: Callable[[Sequence[Attempt]], object] | None = None,
        details: Any = None,
        measured: tuple[Any, ...] = (),
    ) -> Core:
        """Begin a run.

        Args:
            absent: the names without a source.
            look_closer: judges the samples that are not plain values in a `dict`, at seconds.
            look_closer_ns: the same at ticks.
            heard: beside Python, hears of decisions if they are attended.
            details: beside Python what gives attempts their other fields, one per rule.
            measured: where robustness is measured, whether of each position of a sample, and the
                type of a figure with its fields, and that of its bounds with theirs.
        """
        plan, names = self.plan, self.names
        called = (*plan.signals, *plan.events)
        words: list[dict[str, int] | None] = [
            _labels(names, plan.spec.signals[name].type) for name in plan.signals
        ]
        words += [
            {field: names.field(event, field) for field in plan.spec.events[event].fields}
            for event in plan.events
        ]
        return self.type(
            tuple(words),
            tuple(_labels(names, type_) for type_ in _field_types(plan, names)),
            {name: names.number(name) for name in called if name not in absent},
            bytes(name in absent for name in called),
            (look_closer, look_closer_ns),
            (RvmonError, heard),
            (
                Attempt,
                tuple(getattr(Attempt, name) for name in _SLOTS),
                tuple(rule.requirement.id for rule in plan.asked),
                VERDICTS,
                DECISIONS,
                _Details(plan) if details is None else details,
            ),
            measured,
        )


def online_build(
    plan: Plan, *, optimised: bool = True, beside: bool = False, measured: bool = False
) -> Build:
    """The module of a plan.

    Args:
        plan: of requirements that all have automata.
        optimised: whether it is to be fast; otherwise it is compiled sooner.
        beside: whether it stands beside a monitor in Python, which lends its state.
        measured: whether it measures robustness, and not of verdicts.

    Raises:
        RvmonError: a number of the specification is no double.
    """
    # Under the specification's own name its functions might be called as some of Python's headers.
    named = replace(plan, spec=replace(plan.spec, name="rvmon"))
    made = c_files(named)
    name = f"{made.prefix}_online.c"
    texts = {
        **made.texts,
        name: online_source(named, beside=beside, measured=measured),
        "python.txt": sys.version,
    }
    flags = [*(FAST if optimised else ("-O0",)), *_SHARED]
    return Build(
        texts, [name, *made.units], EXTENSION_SUFFIXES[0], flags, sysconfig.get_path("include")
    )


def online_library(
    plan: Plan, *, optimised: bool = True, beside: bool = False, measured: bool = False
) -> OnlineLibrary:
    """Compile a plan, once for each content.

    Args:
        plan: as for `online_build`; so are the others.
        optimised: whether it is to be fast.
        beside: see there.
        measured: see there.

    Raises:
        RvmonError: there is no C compiler, or no header of Python; a requirement has no automaton,
            or a number of the specification is no double.
    """
    build = online_build(plan, optimised=optimised, beside=beside, measured=measured)
    return library_of(plan, loaded(build, type_in))


def library_of(plan: Plan, type_: Callable[..., Core]) -> OnlineLibrary:
    """A plan with the type that it was compiled to."""
    return OnlineLibrary(plan, Names(plan), whole_limits(plan), type_)


def type_in(path: Path) -> Callable[..., Core]:
    """The type that a compiled module has.

    Raises:
        OSError: it cannot be loaded; so says the next.
        ImportError: see there.
    """
    loader = ExtensionFileLoader(_MODULE, str(path))
    spec = spec_from_loader(_MODULE, loader)
    if spec is None:
        raise ImportError(f"{path} is no module")
    module = module_from_spec(spec)
    loader.exec_module(module)
    made: Callable[..., Core] = module.Core
    return made


def online_source(plan: Plan, *, beside: bool = False, measured: bool = False) -> str:
    """The source of the module; it includes that of `rvmon.codegen.c_source.c_files`.

    Args:
        plan: see `online_build`; so are the others.
        beside: see there.
        measured: see there.
    """
    names = Names(plan)
    heads = ["beside"] if beside else ["margin"] if measured else []
    places = {  # the first ones hold others
        "HEAD": "".join(template(f"{head}_head.c.in") for head in heads),
        "MEASURES": str(int(measured)),
        "MEASURING": Measures(plan).source() if measured else "",
        "BESIDE": str(int(beside)),
        "HEAP": template("heap.c.in"),
        "KINDS": "\n".join((*_kinds(plan, names), *(_noted(plan, names) if beside else ()))),
        "SPEC": comment(plan.spec.name),
        "PREFIX": names.prefix.upper(),
        "prefix": names.prefix,
    }
    parts = _PARTS_BESIDE if beside else _PARTS_MEASURED if measured else _PARTS
    return filled("".join(template(part) for part in parts), places)


def _noted(plan: Plan, names: Names) -> Iterator[str]:
    """What a module beside Python notes, and what it may take."""
    index = plan.graph.index
    leaves = [[index[leaf] for leaf in rule.noted or ()] for rule in plan.rules]
    yield from lists("seen_first", "seen_leaves", leaves)
    places = [[index[state] for state in rule.alphabet.propositions] for rule in plan.rules]
    yield from lists("told_first", "told_places", places)
    reaches = [reach_of(one) for one in Networks(plan).plans]
    yield array("int64_t", "reaches", [reach or 0 for reach in reaches])
    compared = [state.leaf for state in plan.graph.nodes if isinstance(state.leaf, Compare)]
    sides = [side for leaf in compared for side in (leaf.left, leaf.right)]
    parts = [part for side in sides for part in operands(side)]
    read = {(part.event, part.field) for part in parts if isinstance(part, FieldValue)}
    yield array("uint8_t", "fields_read", [int(one in read) for one in names.fields])
    largest = largest_taken(plan)
    test = "(x) == (x)" if largest is None else f"((x) <= {largest!r}) && ((x) >= -{largest!r})"
    yield f"#define IS_WELCOME(x) ({test})"


_MODERATE = 1e50
"""Up to this magnitude sums and a few products of numbers are finite."""


def largest_taken(plan: Plan) -> float | None:
    """The greatest magnitude of a number that a module beside Python takes; `None`: any."""
    compared = [state.leaf for state in plan.graph.nodes if isinstance(state.leaf, Compare)]
    sides = [side for leaf in compared for side in (leaf.left, leaf.right)]
    calculates = any(isinstance(side, Arithmetic | UpdateValue) for side in sides)
    return _MODERATE if calculates else None


def _kinds(plan: Plan, names: Names) -> Iterator[str]:
    """What each name and each field of a payload is."""
    limits = whole_limits(plan)
    spec = plan.spec
    signals = [spec.signals[name].type for name in plan.signals]
    for what, types, called in (
        ("signal", signals, plan.signals),
        ("field", _field_types(plan, names), [f"{event}.{field}" for event, field in names.fields]),
    ):
        yield array("uint8_t", f"{what}_kinds", [_KINDS.index(one.kind) for one in types])
        yield array("int64_t", f"{what}_limits", [limits[name] for name in called])
    counts = [len(spec.events[event].fields) for event in plan.events]
    yield array("int32_t", "field_first", [0, *accumulate(counts)])


def _field_types(plan: Plan, names: Names) -> list[Type]:
    return [plan.spec.events[event].fields[field] for event, field in names.fields]


def _labels(names: Names, type_: Type) -> dict[str, int] | None:
    """The numbers of the labels that a type has; `None`: it has none."""
    if type_.kind is not Kind.LABEL:
        return None
    return {label: names.label(label) for label in type_.labels}
