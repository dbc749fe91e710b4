"""Every form that a monitor runs in, behind the interface that the differential test drives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rvmon.codegen.c_batch import BatchLibrary, BatchRun
from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_online import OnlineLibrary, online_library
from rvmon.monitor.c.monitor import CompiledMonitor
from rvmon.monitor.c.recorded import report_of_records

from rvmon.errors import RvmonError, TimeOrderError
from rvmon.monitor import CompiledSpec, build_monitor, compile_spec
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.engines.registry import engine_named
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample, Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from tests.tools.drive import Monitored, OnlineMonitor

EXPLAINING = ("auto", "python", "automaton", "progression", "network")
"""The engines that judge streams and give reasons."""

HANDING_ON = ("auto", "python")
"""The engines that have others judge beside them what they refuse; the rest refuse it."""

FORMS = (*EXPLAINING, "c", "c rows")
"""The engines of `Spec.monitor` that give reasons; compiled C that is stepped, and fed rows."""


class Compiler:
    """Compiles specifications; that of one case serves the next case and all makers too."""

    def __init__(self) -> None:
        self._spec: CheckedSpec | None = None
        self._compiled: CompiledSpec | None = None

    def __call__(self, spec: CheckedSpec) -> CompiledSpec:
        """The compiled specification.

        Raises:
            RvmonError: no engine judges it.
        """
        if self._compiled is None or spec is not self._spec:
            self._compiled, self._spec = compile_spec(spec), spec
        return self._compiled


class Maker:
    """Makes monitors of one form; what is compiled for a specification serves the next case too.

    Args:
        form: one of `FORMS`.
        compiler: shared with other makers; default: its own.

    Raises:
        RvmonError: there is no such form.
    """

    def __init__(self, form: str, compiler: Compiler | None = None) -> None:
        if form not in FORMS:
            raise RvmonError(f"no form `{form}`: there are {', '.join(FORMS)}")
        self.form = form
        self._compile = compiler or Compiler()
        self._spec: CheckedSpec | None = None
        self._made: Any = None

    def __call__(self, case: Case) -> Monitored | None:
        """A fresh monitor for a case; `None` if the form does not judge such specifications.

        Raises:
            RvmonError: no engine judges such specifications.
        """
        if case.spec is not self._spec:
            self._made, self._spec = self._compiled(case.spec), case.spec
        match self._made:
            case CompiledSpec() as compiled:
                return self.online(compiled, case)
            case BatchLibrary() as library:
                return _Compiled(library, case)
            case OnlineLibrary() as library:
                return _Terse(library, self._compile(case.spec), case)
            case _:
                return None

    def online(self, compiled: CompiledSpec, case: Case) -> OnlineMonitor:
        """A monitor of this process, for an engine of `Spec.monitor`."""
        return build_monitor(compiled, engine=self.form, sources=case.names)

    def _compiled(self, spec: CheckedSpec) -> CompiledSpec | BatchLibrary | OnlineLibrary | None:
        compiled = self._compile(spec)
        if self.form in HANDING_ON:
            return compiled
        engine = engine_named(self.form if self.form in EXPLAINING else "c")
        if any(engine.refuses(one) for one in compiled.requirements.values()):
            return None
        match self.form:
            case "c":
                return online_library(plan_alone(compiled), optimised=False)
            case "c rows":
                return BatchLibrary(plan_alone(compiled), optimised=False)
            case _:
                return compiled


def _absent(case: Case) -> frozenset[str]:
    declared = {*case.spec.signals, *case.spec.events}
    return frozenset() if case.names is None else frozenset(declared - case.names)


class _Terse:
    """A compiled monitor that is stepped; what other monitors say beside verdicts is not asked."""

    def __init__(self, library: OnlineLibrary, compiled: CompiledSpec, case: Case) -> None:
        chosen = list(compiled.requirements.values())
        monitor = CompiledMonitor(library, compiled, chosen, "now", case.names)
        self.step_ns = monitor.step_ns
        self.advance_ns = monitor.advance_ns
        self.finish_ns = monitor.finish_ns


class _Compiled:
    """A compiled monitor: it hears everything at the end, as of a recording."""

    def __init__(self, library: BatchLibrary, case: Case) -> None:
        self.library = library
        self.case = case
        self.actions: list[Sample | int] = []

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample."""
        self.actions.append(Sample(t_ns, values))
        return ()

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        """Let time pass."""
        self.actions.append(t_ns)
        return ()

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        """End the trace.

        Raises:
            TimeOrderError: a sample was not taken.
        """
        from rvmon.codegen.c_columns import rows_of_samples

        rows = rows_of_samples(self.actions, self.library.names, self.library.limits)
        with BatchRun(self.library, _absent(self.case)) as run:
            taken = run.feed(rows.times, rows.columns, rows.kinds)
            if taken != len(rows.times):
                raise TimeOrderError(f"row {taken} was not taken")
            made = run.close(t_ns)
        captured = CapturedValues(self.library.plan)
        return report_of_records(tuple(self.case.spec.requirements), made, captured, origin=0)
