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
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_source import c_files
from rvmon.codegen.c_tables import DECISIONS, VERDICTS, array
from rvmon.codegen.c_text import filled, template
from rvmon.codegen.comment import comment
from rvmon.errors import RvmonError
from rvmon.plan.plan import Plan
from rvmon.spec.checked.specification import Type
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Attempt

_PARTS = ("online.c.in", "online_calls.c.in", "online_type.c.in")

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

    def hold(self, held: bool, /) -> None:
        """Begin or end a call of which Python does a part: meanwhile no sample is taken quickly."""

    def next_due(self) -> int:
        """The next instant at which time alone can decide something, or `NEVER`."""

    def reset(self) -> None:
        """Begin anew."""


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
    ) -> Core:
        """Begin a run.

        Args:
            absent: the names without a source.
            look_closer: judges the samples that are not plain values in a `dict`, at seconds.
            look_closer_ns: the same at ticks.
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
            RvmonError,
            (
                Attempt,
                tuple(getattr(Attempt, name) for name in _SLOTS),
                tuple(rule.requirement.id for rule in plan.asked),
                VERDICTS,
                DECISIONS,
                _Details(plan),
            ),
        )


def online_build(plan: Plan, *, optimised: bool = True) -> Build:
    """The module of a plan.

    Args:
        plan: of requirements that all have automata.
        optimised: whether it is to be fast; otherwise it is compiled sooner.

    Raises:
        RvmonError: a number of the specification is no double.
    """
    # Under the specification's own name its functions might be called as some of Python's headers.
    named = replace(plan, spec=replace(plan.spec, name="rvmon"))
    made = c_files(named)
    name = f"{made.prefix}_online.c"
    texts = {
        **made.texts,
        name: online_source(named),
        "python.txt": sys.version,
    }
    flags = [*(FAST if optimised else ("-O0",)), *_SHARED]
    return Build(
        texts, [name, *made.units], EXTENSION_SUFFIXES[0], flags, sysconfig.get_path("include")
    )


def online_library(plan: Plan, *, optimised: bool = True) -> OnlineLibrary:
    """Compile a plan, once for each content.

    Args:
        plan: as for `online_build`; so are the others.
        optimised: whether it is to be fast.

    Raises:
        RvmonError: there is no C compiler, or no header of Python; a requirement has no automaton,
            or a number of the specification is no double.
    """
    build = online_build(plan, optimised=optimised)
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


def online_source(plan: Plan) -> str:
    """The source of the module; it includes that of `rvmon.codegen.c_source.c_files`.

    Args:
        plan: see `online_build`; so are the others.
    """
    names = Names(plan)
    places = {  # the first ones hold others
        "HEAP": template("heap.c.in"),
        "KINDS": "\n".join(_kinds(plan, names)),
        "SPEC": comment(plan.spec.name),
        "PREFIX": names.prefix.upper(),
        "prefix": names.prefix,
    }
    return filled("".join(template(part) for part in _PARTS), places)


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
