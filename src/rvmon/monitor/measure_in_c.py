"""Robustness measured by compiled C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rvmon.codegen.c_online import Core, OnlineLibrary, online_library
from rvmon.dataflow.margins import INFINITE
from rvmon.monitor.c.monitor import CompiledMonitor
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import Key, Margins, Measured, Robustness, Stream

if TYPE_CHECKING:
    from rvmon.readers.source import Columns
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report


def measuring_library(
    compiled: CompiledSpec, requirements: Sequence[CompiledRequirement], *, optimised: bool = True
) -> OnlineLibrary:
    """What measures some requirements, compiled once for a specification.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        optimised: whether it is to be fast; otherwise it is compiled sooner.

    Raises:
        RvmonError: there is no C compiler, or a requirement cannot be measured by compiled C.
    """
    ids = tuple(one.requirement.id for one in requirements)
    key = ("margins in c", ids)
    found = compiled.forms.get(key)
    if not isinstance(found, OnlineLibrary):
        plan = plan_alone(compiled, ids, measured=True)
        found = compiled.forms[key] = online_library(plan, optimised=optimised, measured=True)
    return found


class CompiledRun(CompiledMonitor):
    """Takes samples as compiled C does; what it returns are figures in the place of verdicts.

    Args:
        library: from `measuring_library`.
        compiled: the specification.
        requirements: to be measured.
        settle: see `CompiledMonitor`.
        sources: the names that can arrive; `None`: all.
        streams: whether each position of a sample is measured, and not those of attempts alone.
    """

    def __init__(
        self,
        library: OnlineLibrary,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        settle: str,
        sources: frozenset[str] | None,
        *,
        streams: bool,
    ) -> None:
        self._rest: Sequence[Measured] = ()
        measured = _types(streams=streams)
        super().__init__(library, compiled, requirements, settle, sources, measured=measured)

    def _conclude(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        report, figures = super()._conclude(t_ns)
        self._rest = _figures(figures)
        return report, ()

    def advanced(self, t_ns: int) -> Sequence[Measured]:
        """Let time pass; gives the figures that this settled."""
        return _figures(self.advance_ns(t_ns))

    def followed(self, decided: Sequence[Any]) -> Sequence[Measured]:
        """What a step returned."""
        return _figures(decided)

    def open_figures(self) -> Sequence[Measured]:
        """What is known of the open attempts."""
        return _figures(self.open)

    def finished(self, t_ns: int | None) -> Sequence[Measured]:
        """End the run; gives the figures that are left."""
        self.finish_ns(t_ns)
        return self._rest


class CompiledRobustnessMonitor(RobustnessMonitor):
    """Measures by compiled C; arguments and errors are those of `RobustnessMonitor`.

    Raises:
        RvmonError: there is no C compiler, or a requirement cannot be measured by compiled C.
    """

    _run: CompiledRun

    def _begun(
        self,
        compiled: CompiledSpec,
        chosen: Sequence[CompiledRequirement],
        settle: str,
        sources: frozenset[str] | None,
        *,
        streams: bool,
    ) -> CompiledRun:
        """See `RobustnessMonitor`."""
        library = measuring_library(compiled, chosen)
        run = CompiledRun(library, compiled, chosen, settle, sources, streams=streams)
        vars(self).update(step=run.step, step_ns=run.step_ns)  # with nothing in between
        return run


def margins_of_columns(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    columns: Columns,
    end: int | None,
    *,
    streams: bool,
) -> Margins:
    """Measure a recording by its columns.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        columns: of the recording.
        end: of the trace in ticks; `None`: its last row.
        streams: whether each row is measured, and not the attempts alone.

    Raises:
        RvmonError: there is no C compiler, or a requirement cannot be measured by compiled C.
        TraceError: a whole number is larger than C computes with exactly.
        TimeOrderError: an instant is not after the one before.
    """
    import numpy as np

    from rvmon.codegen.c_batch import exact_columns
    from rvmon.monitor.c.batch import out_of_order

    library = measuring_library(compiled, requirements)
    plan = library.plan
    names = (*plan.signals, *plan.events)
    core = library.core(
        frozenset(names) - {*columns.names},
        look_closer=_not_stepped,
        look_closer_ns=_not_stepped,
        measured=_types(streams=streams),
    )
    core.reset()
    rows = 0
    for block in columns.read():
        laid = exact_columns(plan, library.limits, block.times, block.columns)
        times = np.ascontiguousarray(block.times)
        taken = core.feed(times, tuple(laid.get(name) for name in names))
        rows += taken
        if taken < len(times):
            raise out_of_order(rows, int(times[taken]))
    core.close(end)
    found = np.frombuffer(core.figures(), np.dtype(_FIGURE, align=True))
    found = found[found["vanished"] == 0]
    ids = [one.requirement.id for one in requirements]
    owners = [ids[owner] for owner, _ in plan.judges]
    attempts: tuple[dict[Key, Robustness], dict[Key, Robustness]] = ({}, {})
    for sure in (True, False):
        some = found[found["sure"] == sure]
        # What nothing triggered owes nothing.
        high = some["high"] if sure else np.full(len(some), INFINITE)
        keys = zip(
            [owners[n] for n in some["judge"].tolist()], some["number"].tolist(), strict=True
        )
        figures = map(Robustness, some["low"].tolist(), high.tolist(), some["kept"].tolist())
        attempts[not sure].update(zip(keys, figures, strict=True))
    return Margins(*attempts, {name: _stream(core, n) for n, name in enumerate(ids) if streams})


def _not_stepped(_: float, __: Mapping[str, Any]) -> Sequence[Attempt]:
    raise AssertionError("it takes rows")


def _stream(core: Core, requirement: int) -> Stream:
    import numpy as np

    times, *bounds = core.series(requirement)
    return Stream(np.frombuffer(times, np.int64), *map(np.frombuffer, bounds))


def _types(*, streams: bool) -> tuple[Any, ...]:
    """What `OnlineLibrary.core` is given of figures."""
    return (streams, *(part for one in (Measured, Robustness) for part in (one, _slots(one))))


def _figures(returned: Sequence[Any]) -> Sequence[Measured]:
    return returned


_FIGURE = [
    *(("t", "i8"), ("low", "f8"), ("high", "f8"), ("kept", "f8")),
    *(("judge", "i4"), ("number", "u4"), ("sure", "u1"), ("vanished", "u1")),
]
"""A figure as `margin_judge.c.in` lays it out."""


def _slots(type_: type) -> tuple[Any, ...]:
    """What stands for the fields of a type, in their order."""
    return tuple(getattr(type_, name) for name in type_.__slots__)  # type: ignore[attr-defined]
