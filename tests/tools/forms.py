"""Every form that a monitor runs in, behind the interface that the differential test drives."""

from __future__ import annotations

from rvmon.errors import RvmonError
from rvmon.monitor import CompiledSpec, build_monitor, compile_spec
from rvmon.monitor.engines.registry import engine_named
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case
from tests.tools.core_forms import ByRows, Stepped
from tests.tools.drive import Monitored, OnlineMonitor

EXPLAINING = ("auto", "python", "automaton", "progression", "network")
"""The engines that judge streams and give reasons."""

HANDING_ON = ("auto", "python")
"""The engines that have others judge beside them what they refuse; the rest refuse it."""

FORMS = (*EXPLAINING, "c", "c rows")
"""The engines of `Spec.monitor` that give reasons; the core, stepped, and fed rows."""


class Compiler:
    """Compiles specifications; that of one case serves the next case and all makers too.

    Args:
        next_law: whether for the law to come.
    """

    def __init__(self, *, next_law: bool = False) -> None:
        self._next_law = next_law
        self._spec: CheckedSpec | None = None
        self._compiled: CompiledSpec | None = None

    def __call__(self, spec: CheckedSpec) -> CompiledSpec:
        """The compiled specification.

        Raises:
            RvmonError: no engine judges it.
        """
        if self._compiled is None or spec is not self._spec:
            self._compiled = compile_spec(spec, next_law=self._next_law)
            self._spec = spec
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
        self._made: CompiledSpec | None = None

    def __call__(self, case: Case) -> Monitored | None:
        """A fresh monitor for a case; `None` if the form does not judge such specifications.

        Raises:
            RvmonError: no engine judges such specifications.
        """
        if case.spec is not self._spec:
            self._made, self._spec = self._compiled(case.spec), case.spec
        if self._made is None:
            return None
        match self.form:
            case "c":
                return Stepped(self._made, case)
            case "c rows":
                return ByRows(self._made, case)
            case _:
                return self.online(self._made, case)

    def online(self, compiled: CompiledSpec, case: Case) -> OnlineMonitor:
        """A monitor of this process, for an engine of `Spec.monitor`."""
        return build_monitor(compiled, engine=self.form, sources=case.names)

    def _compiled(self, spec: CheckedSpec) -> CompiledSpec | None:
        compiled = self._compile(spec)
        if self.form in HANDING_ON:
            return compiled
        engine = engine_named(self.form if self.form in EXPLAINING else "c")
        if any(engine.refuses(one) for one in compiled.requirements.values()):
            return None
        return compiled
