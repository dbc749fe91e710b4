"""Open attempts that the core keeps in a queue, or moves in runs, agree with the law."""

import random

import pytest
from tests.tools.differential import disagreements
from tests.tools.forms import FORMS, Compiler, Maker

import rvmon
from rvmon.testing.generate.trace import TraceProfile, random_trace

NAMES = "signal p, q : bool\nevent e\n"
REQUIRED = [
    "G[0 ns, 20 ns] (p -> F[0 ns, 7 ns] q)",
    "G[3 ns, 9 ns] (p U[2 ns, 8 ns] q)",
    "F[3 ns, 18 ns] (p U[0 ns, 3 ns] not q)",
    "(F[3 ns, 6 ns] q) U (p and not q)",
    "(F[0 ns, 6 ns] p) U[0 ns, 20 ns] (G[0 ns, 6 ns] q)",
    "p U (q U[3 ns, 6 ns] not p)",
]
"""Nested so that clocks are reset at triggers, at changes, and at each tick."""

IN_RUNS = ["F[0 ns, 40 ns] p", "F[7 ns, 40 ns] p", "p U[2 ns, 30 ns] q", "G[0 ns, 25 ns] not p"]
"""Formulas whose only clock starts at the trigger: attempts are moved in runs."""


TRACES = TraceProfile(samples=40, fewest=30, span=90)
WHEN = ["upon e", "whenever p", "whenever q or e"]


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 3 ns"])
def test_attempts_in_a_queue_agree_with_the_law(time):
    compiler, forms = Compiler(), (*FORMS, "c+interrupt")
    for required in (*REQUIRED, *IN_RUNS):
        for when in WHEN if required in REQUIRED else WHEN[:1]:
            text = f"time {time}\n{NAMES}requirement R\n  {when}\n  then {required}\n"
            spec = rvmon.loads(text).checked
            for place, form in enumerate(forms):
                case = random_trace(
                    random.Random(f"{time} {when} {required} {place}"), spec, TRACES
                )
                online = place == 0 and when == WHEN[0]
                wrong = disagreements(case, Maker(form, compiler), online=online)
                assert wrong == [], (required, when, form)
