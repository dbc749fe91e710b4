"""Ways to drive a monitor that must change nothing: samples in portions, and snapshots."""

from __future__ import annotations

import random

from rvmon.errors import RvmonError
from rvmon.monitor import CompiledSpec, build_monitor
from rvmon.testing.case import Case
from tests.tools import forms
from tests.tools.core_forms import Stepped
from tests.tools.drive import Monitored
from tests.tools.forms import FORMS, Compiler
from tests.tools.held_back import HeldBack
from tests.tools.interrupt import Interrupted

NEXT, INTERRUPT = "next", "interrupt"
"""Samples in portions, settled by the next stamp; put away and taken up again on the way."""


class Maker(forms.Maker):
    """Makes monitors of one form, driven in some way.

    Args:
        form: one of `FORMS`; `c` perhaps followed by `+next` or `+interrupt`, or both.
        compiler: shared with other makers; default: its own.

    Raises:
        RvmonError: there is no such form, or it is not driven so.
    """

    def __init__(self, form: str = "c", compiler: Compiler | None = None) -> None:
        plain, *ways = form.split("+")
        if plain not in FORMS or (ways and plain != "c") or {*ways} - {NEXT, INTERRUPT}:
            raise RvmonError(
                f"no form `{form}`: there are {', '.join(FORMS)}; c also with +{NEXT}, +{INTERRUPT}"
            )
        super().__init__(plain, compiler)
        self._holds_back = NEXT in ways
        self._interrupts = INTERRUPT in ways

    def stepped(self, compiled: CompiledSpec, case: Case) -> Monitored:
        """See `tests.tools.forms.Maker`."""
        rng = random.Random(len(case.actions))
        if not self._holds_back:
            made = Stepped(compiled, case)
            if self._interrupts:
                made.take_up_again(rng)
            return made
        monitor = build_monitor(compiled, settle="next", sources=case.names)
        return HeldBack(Interrupted(monitor, rng) if self._interrupts else monitor, case.spec, rng)
