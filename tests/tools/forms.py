"""The forms in which the core is run, behind the interface that the differential test drives."""

from __future__ import annotations

from rvmon.errors import RvmonError
from rvmon.monitor import CompiledSpec, compile_spec
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case
from tests.tools.core_forms import ByRows, Stepped
from tests.tools.drive import Monitored

FORMS = ("c", "c rows")
"""The core, stepped, and fed rows."""


class Compiler:
    """Compiles specifications; that of one case serves the next case and all makers too."""

    def __init__(self) -> None:
        self._spec: CheckedSpec | None = None
        self._compiled: CompiledSpec | None = None

    def __call__(self, spec: CheckedSpec) -> CompiledSpec:
        """The compiled specification.

        Raises:
            RvmonError: it cannot be monitored.
        """
        if self._compiled is None or spec is not self._spec:
            self._compiled = compile_spec(spec)
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

    def __init__(self, form: str = "c", compiler: Compiler | None = None) -> None:
        if form not in FORMS:
            raise RvmonError(f"no form `{form}`: there are {', '.join(FORMS)}")
        self.form = form
        self._compile = compiler or Compiler()

    def __call__(self, case: Case) -> Monitored:
        """A fresh monitor for a case.

        Raises:
            RvmonError: its specification cannot be monitored.
        """
        compiled = self._compile(case.spec)
        return self.stepped(compiled, case) if self.form == "c" else ByRows(compiled, case)

    def stepped(self, compiled: CompiledSpec, case: Case) -> Monitored:
        """A monitor that takes sample by sample."""
        return Stepped(compiled, case)
