"""Robustness measured by compiled C."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rvmon.codegen.c_online import OnlineLibrary, online_library
from rvmon.errors import RvmonError
from rvmon.monitor.c.monitor import CompiledMonitor
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.robustness.evaluators import is_for_unit
from rvmon.monitor.robustness.values import Measured, Robustness

if TYPE_CHECKING:
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report


def expect_measurable(requirements: Sequence[CompiledRequirement]) -> None:
    """See that compiled C can measure requirements.

    Raises:
        RvmonError: it cannot; which one, and why, is said.
    """
    for one in requirements:
        if not is_for_unit(one) or one.obligation.trigger is None:
            raise RvmonError(
                f"the engine `c` does not measure {one.requirement.id}: it has `let`, `for each`, "
                "`upon end`, payloads in what it owes, or a clock of several ticks: use the "
                "engine `auto`, or leave it out (`only`, --only)"
            )


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
        expect_measurable(requirements)
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
        types = (Measured, Robustness)
        measured = [part for one in types for part in (one, _slots(one))]
        super().__init__(
            library, compiled, requirements, settle, sources, measured=(streams, *measured)
        )

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


def _figures(returned: Sequence[Any]) -> Sequence[Measured]:
    return returned


def _slots(type_: type) -> tuple[Any, ...]:
    """What stands for the fields of a type, in their order."""
    return tuple(getattr(type_, name) for name in type_.__slots__)  # type: ignore[attr-defined]
