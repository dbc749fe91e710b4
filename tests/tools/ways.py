"""Ways to drive an engine that must change nothing: samples in portions, and snapshots."""

from __future__ import annotations

import random

from rvmon.errors import RvmonError
from rvmon.monitor import CompiledSpec, build_monitor
from rvmon.testing.case import Case
from tests.tools import forms
from tests.tools.core_forms import Stepped
from tests.tools.drive import Monitored, OnlineMonitor
from tests.tools.forms import EXPLAINING, FORMS, Compiler
from tests.tools.held_back import HeldBack
from tests.tools.interrupt import Interrupted

NEXT, INTERRUPT = "next", "interrupt"
"""Samples in portions, settled by the next stamp; put away and taken up again on the way."""


class Maker(forms.Maker):
    """Makes monitors of one form, driven in some way.

    Args:
        form: one of `FORMS`, perhaps followed by `+next` or `+interrupt`, or both.
        compiler: shared with other makers; default: its own.

    Raises:
        RvmonError: there is no such form, or it is not driven so.
    """

    def __init__(self, form: str, compiler: Compiler | None = None) -> None:
        plain, *ways = form.split("+")
        driven = plain in EXPLAINING or not ways or [plain, *ways] == ["c", INTERRUPT]
        if plain not in FORMS or not driven or {*ways} - {NEXT, INTERRUPT}:
            raise RvmonError(
                f"no form `{form}`: there are {', '.join(FORMS)}; "
                f"{', '.join(EXPLAINING)} also with +{NEXT}, +{INTERRUPT}; c with +{INTERRUPT}"
            )
        super().__init__(plain, compiler)
        self._settle = "next" if NEXT in ways else "now"
        self._interrupts = INTERRUPT in ways

    def __call__(self, case: Case) -> Monitored | None:
        """See `tests.tools.forms.Maker`."""
        made = super().__call__(case)
        if self._interrupts and isinstance(made, Stepped):
            made.take_up_again(random.Random(len(case.actions)))
        return made

    def online(self, compiled: CompiledSpec, case: Case) -> OnlineMonitor:
        """See `tests.tools.forms.Maker`."""
        rng = random.Random(len(case.actions))
        monitor = build_monitor(compiled, engine=self.form, settle=self._settle, sources=case.names)
        driven = Interrupted(monitor, rng) if self._interrupts else monitor
        return driven if self._settle == "now" else HeldBack(driven, case.spec, rng)
