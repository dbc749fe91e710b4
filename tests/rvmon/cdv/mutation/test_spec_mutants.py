"""Mutants of requirements: specification texts that are evaluated on runs or proved equivalent."""

import inspect
import re

import pytest
from tests.tools.each import each

from rvmon import load, loads
from rvmon.cdv.mutation.spec_mutants import spec_mutants, try_spec_mutants
from rvmon.cdv.play import Recorded
from rvmon.cdv.system import Run
from rvmon.language.print import format_formula

DECLARED = "signal x : real [m]\nsignal p, q : bool\nevent go, stop, beep\n"

CHANGES = [
    ("connective", "upon go and p then within 3 s stop", "upon go or p then within 3 s stop"),
    ("dropped operand", "upon go and p then within 3 s stop", "upon go then within 3 s stop"),
    ("dropped not", "upon go then for 3 s not p", "upon go then for 3 s p"),
    ("negated", "upon go and p then within 3 s stop", "upon go and not p then within 3 s stop"),
    ("comparison", "upon go then for 3 s x < 2 m", "upon go then for 3 s x <= 2 m"),
    ("threshold", "upon go then for 3 s x < 2 m", "upon go then for 3 s x < 2.2 m"),
    ("temporal operator", "upon go then within 3 s stop", "upon go then for 3 s stop"),
    ("bound", "upon go then within 3 s stop", "upon go then within 2 s stop"),
    ("bound", "upon go then F[1 s, 3 s] stop", "upon go then eventually[0, 3 s] stop"),
    ("bound", "upon go then within 150 ms stop", "upon go then within 149 ms stop"),
    ("no deadline", "upon go then within 3 s stop", "upon go then eventually stop"),
]


def spec_of(requirement):
    return loads(f"{DECLARED}requirement R\n  {requirement}\n")


@each(("kind", "requirement", "after"), CHANGES)
def test_operators(kind, requirement, after):
    found = spec_mutants(spec_of(requirement).checked)
    texts = [one.after for one in found if one.kind == kind]
    assert after.replace("eventually[0, 3 s]", "within 3 s") in texts
    assert len({one.identity for one in found}) == len(found)


def test_every_operator_is_tried():
    known = re.findall(r'yield "([^"]+)"', inspect.getsource(inspect.getmodule(spec_mutants)))
    assert {kind for kind, _, _ in CHANGES} == set(known)


@pytest.mark.slow
@pytest.mark.parametrize("path", ["specs/handover.rv", "specs/handover_legacy.rv"])
def test_the_printed_mutant_is_the_one_evaluated(path):
    """When parsed, its text gives the formulas that are evaluated."""
    spec = load(path)
    text = spec.checked.source.text
    declared = text[: text.index("requirement ")]
    for mutant in spec_mutants(spec.checked):
        again = loads(f"{declared}requirement R\n  {mutant.after}\n").requirements["R"]
        formulas = (again.trigger, again.consequent)
        changed = (mutant.changed.trigger, mutant.changed.consequent)
        assert [*map(format_formula, formulas)] == [*map(format_formula, changed)]
        assert again.pulse == mutant.changed.pulse


def tried(requirement, *samples, end_s=9):
    """The result of one recorded run for all mutants, by their text."""
    spec = spec_of(requirement)
    monitor = spec.monitor()
    for t_ns, values in samples:
        monitor.step_ns(t_ns, values)
    report = monitor.finish_ns(end_s * 10**9)
    run = Recorded(Run(end_s * 10**9), report, samples, {}, (), 0.0, 0.0)
    found = try_spec_mutants(spec, spec_mutants(spec.checked), {"one": run})
    return {one.mutant.after: one for one in found}


def test_a_run_with_another_verdict_kills():
    found = tried(
        "upon go then within 3 s stop", (0, {"go": True}), (2_500_000_000, {"stop": True})
    )
    killed = found["upon go then within 2 s stop"]
    assert (killed.test, killed.was.value, killed.now.value) == ("one", "P", "F")
    alive = found["upon go then within 4 s stop"]
    assert (alive.test, alive.proved) == ("", False)


@pytest.mark.slow
def test_equivalent_mutants_are_proved():
    """Only with bounds: an attempt that stays open neither fails nor passes."""
    found = tried("upon go then within 3 s (stop or stop and p)")
    assert found["upon go then within 3 s stop"].proved
    assert not found["upon go then within 4 s (stop or stop and p)"].proved
    endless = tried("upon go then eventually (stop or stop and p)")
    assert not endless["upon go then eventually stop"].proved
    weaker = tried("upon go and p then within 3 s stop")["upon go then within 3 s stop"]
    assert not weaker.proved, "it starts attempts where there was none"
