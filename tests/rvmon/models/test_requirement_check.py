"""Requirements checked on all runs of a network, with witnesses and counterexamples."""

from collections import Counter
from fractions import Fraction
from random import Random

import pytest
from tests.tools.timed_generate import random_model

import rvmon
from rvmon.errors import ModelError
from rvmon.models.language.load import loads_network
from rvmon.models.network.evaluate import evaluator
from rvmon.models.requirement_check import observe
from rvmon.models.runs import Ending
from rvmon.models.runs.exact_times import InvalidRunError, Rules, initial_configuration
from rvmon.models.search.budget import Budget
from rvmon.models.search.verify import verify
from rvmon.trace.time import TICKS_PER_SECOND

LAMP = """
unit 1 s
clock x
int[0,2] level
automaton Lamp {
  location off
  location on invariant x <= 8
  start off
  edge off -> on when x >= 1 do x = 0, level = 1 as pressed
  edge on -> on when x >= 2 and level < 2 do level = 2 as raised
  edge on -> off when x >= 5 do x = 0, level = 0 as dark
}
signal lit = Lamp.on
"""

SPEC = """
spec lamp
time held
signal lit : bool
signal level : int
event pressed, raised, dark
{requirements}
"""


def observed(requirements, model=LAMP, **options):
    spec = rvmon.loads(SPEC.format(requirements=requirements))
    return list(observe(loads_network(model), spec.checked, **options)), spec


def judged(spec, observation, run):
    """The set of verdicts that the monitor gives on a run."""
    scale, now = observation.network.unit, Fraction(0)

    def values(position):
        return {"lit": position.locations[0] == 1, "level": position.values[0]}

    samples = {0: values(run.start)}
    for step in run.steps:
        now += step.delay
        if step.action is not None:
            events = {edge.label: True for _, edge in step.action.edges}
            samples.setdefault(int(now * scale), {}).update(values(step.position) | events)
    monitor = spec.monitor()
    attempts = [one for t, sample in samples.items() for one in monitor.step_ns(t, sample)]
    attempts += monitor.advance_ns(int(now * scale) + 2)
    return {attempt.verdict.value for attempt in attempts}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("requirement", "holds"),
    [
        ("upon pressed then within 8 s dark", True),
        ("upon pressed then within 7 s dark", False),
        ("upon pressed then for 5 s lit", False),
        ("upon pressed then F[6 s, 8 s] dark", False),
        ("upon pressed then G[0 s, 2 s] level <= 1", False),
        ("upon raised then immediately level == 2", True),
        ("upon pressed then (lit U[0 s, 8 s] dark)", True),
        ("upon lit then within 8 s not lit", True),
        ("upon not lit then for 1 s not lit", False),
        ("upon pressed then within 7.5 s dark", False),
        ("upon pressed and level == 2 then within 1 s dark", True),
        ("upon start then for 1 s not lit", False),
        ("upon start then for 0.5 s not lit", True),
    ],
)
def test_a_claim_is_confirmed_by_monitoring_its_runs(requirement, holds):
    ((one,), spec) = observed(f"requirement R\n  {requirement}")
    assert one.holds is holds
    assert (one.failing is None) is holds
    if one.failing is not None:
        assert "F" in judged(spec, one, one.failing)
    if one.passing is not None:
        assert "P" in judged(spec, one, one.passing)


@pytest.mark.parametrize(
    ("requirement", "options", "holds", "remark"),
    [
        ("upon raised and dark then within 1 s lit", {}, True, "vacuous"),
        ("upon pressed then within 8 s dark", {"budget": Budget(states=3)}, None, "not decided"),
    ],
)
def test_a_vacuous_or_undecided_requirement_has_a_remark(requirement, options, holds, remark):
    ((one,), _) = observed(f"requirement R\n  {requirement}", **options)
    assert (one.holds, one.triggered) == (holds, None)
    assert remark in one.remark


@pytest.mark.slow
@pytest.mark.parametrize(
    ("requirement", "holds", "remark"),
    [
        ("upon pressed then eventually dark", True, "while time passes"),
        ("upon pressed then eventually raised", False, "forever"),
        ("upon dark then eventually pressed", False, "forever"),
        ("upon pressed then (lit until dark)", True, "while time passes"),
        ("upon start then eventually pressed", False, "forever"),
        ("upon pressed then always level <= 2", True, ""),
        ("upon pressed then always eventually dark", True, "in the end"),
    ],
)
def test_requirements_without_a_deadline(requirement, holds, remark):
    ((one,), _) = observed(f"requirement R\n  {requirement}")
    assert one.holds is holds
    assert remark in one.remark if remark else not one.remark
    assert (one.failing is None) is holds
    if one.failing is not None:
        assert one.failing.ending in (Ending.IDLE, Ending.LOOP)


def test_a_loop_refutes_a_promise_only_if_time_passes_on_it():
    going = "edge on -> on when x >= 1 and level == 1 do x = 0 as kept"
    model = LAMP.replace("  edge on -> off", f"  {going}\n  edge on -> off")
    ((one,), _) = observed("requirement R\n  upon pressed then eventually dark", model)
    assert (one.holds, one.failing.ending) == (False, Ending.LOOP)
    assert one.failing.loop is not None
    hasty = LAMP.replace(
        "  edge on -> off", "  edge on -> on when level == 1 as kept\n  edge on -> off"
    )
    ((one,), _) = observed("requirement R\n  upon pressed then eventually dark", hasty)
    assert one.holds is True


@pytest.mark.parametrize(
    ("requirement", "reason"),
    [
        ("upon pressed then within 1 s broken", "no action `broken`"),
        ("upon hot then within 1 s lit", "no signal `hot`"),
        ("upon pressed and once dark then within 1 s lit", "the past"),
        ("upon pressed then within 10 ns dark", "whole number"),
    ],
)
def test_an_inexpressible_requirement_says_why(requirement, reason):
    spec = rvmon.loads(
        "spec s\ntime held\nsignal lit, hot : bool\nevent pressed, dark, broken\n"
        f"requirement R\n  {requirement}\n"
    )
    (one,) = observe(loads_network(LAMP), spec.checked)
    assert one.holds is None
    assert one.remark.startswith("not expressible")
    assert reason in one.remark


def test_signals_can_be_bound_to_expressions():
    spec = rvmon.loads(
        "spec s\ntime held\nsignal bright : bool\n"
        "requirement R\n  upon bright then within 6 s not bright\n"
    )
    for formula, holds in (("level == 2", True), ("Lamp.on", False)):
        (one,) = observe(loads_network(LAMP), spec.checked, bindings={"bright": formula})
        assert one.holds is holds, formula


PAIR = """
unit 1 s
int[0, 1] v
chan c
clock x
automaton p { location a invariant x <= 2 location b start a
  edge a -> b when x >= 1 on c! as pressed }
automaton q { location a location b start a edge a -> b on c? as raised }
signal lit = p.b
signal level = v
"""


@pytest.mark.parametrize(
    ("requirement", "holds"),
    [
        ("upon pressed then immediately raised", True),
        ("upon raised then immediately not pressed", False),
    ],
)
def test_all_labels_of_a_synchronised_move_are_events(requirement, holds):
    (found,), spec = observed(f"requirement R\n  {requirement}", model=PAIR)
    assert found.triggered is not None
    assert found.holds is holds
    if not holds:
        assert "F" in judged(spec, found, found.failing)


def random_labelled(seed):
    """A random network, the formulas of its signals p, q and r, and the random generator."""
    random = Random(seed)
    signals = random.choices(["P0.l0", "P0.l1", "b", "v > 0", "not P0.l1", "not b"], k=3)
    lines = random_model(seed).replace("network random", "network random\nunit 1 s").split("\n")
    lines = [
        f"{line} as a{k % 3}" if line.split()[:1] == ["edge"] else line
        for k, line in enumerate(lines)
        if not line.startswith("query")
    ]
    lines += [f"signal {name} = {text}" for name, text in zip("pqr", signals, strict=True)]
    return loads_network("\n".join(lines)), signals, random


def requiring(text):
    return rvmon.loads(
        f"spec s\ntime held\nsignal p, q, r : bool\nevent a0, a1, a2\nrequirement R\n  {text}\n"
    )


@pytest.mark.law
@pytest.mark.parametrize("first", range(0, 10, 5))
def test_random_promises_agree_with_ltl_model_checking(first):
    """The Büchi product decides without a monitor."""
    compared = 0
    for seed in range(first, first + 5):
        network, (p, q, r), _ = random_labelled(seed)
        for requirement, formula in (
            ("whenever p then eventually q", f"G (({p}) imply F ({q}))"),
            ("whenever p then (r until q)", f"G (({p}) imply (({r}) U ({q})))"),
            ("upon start then eventually (p and eventually q)", f"F (({p}) and F ({q}))"),
        ):
            try:
                expected = verify(network, formula)
            except ModelError:
                continue  # it cannot start
            if expected.run and expected.run.ending in (Ending.ZENO_LOOP, Ending.TIME_LOCK):
                continue  # time stops, which no recording shows
            (one,) = observe(network, requiring(requirement).checked)
            assert one.holds == expected.holds, (seed, requirement)
            compared += 1
    assert compared > 9


BOUNDED = (
    "whenever p then within {a} s q",
    "upon p then for {a} s q",
    "upon q then F[{a} s, {b} s] r",
    "upon q then F[{a} s, {a} s] r",
    "upon a0 then within {a} s q",
    "upon p then (q U[{a} s, {b} s] r)",
    "upon p and a1 then immediately q",
    "upon start then within {b} s p",
    "upon p then G[{a} s, {b} s] (q or r)",
    "upon a1 then within {a} s (p and within {b} s q)",
    "upon p then for {a} s not a0",
)


def random_run(network, random):
    """The samples `(t, signals and events)` of a random run, then `(end, None)`."""
    read = {one.name: evaluator(one.value) for one in network.signals}
    now, t, names = initial_configuration(network), Fraction(0), set[str]()
    rules = Rules(network)
    for _ in range(12):
        signals = {name: bool(one(now.locations, now.values)) for name, one in read.items()}
        yield t, signals | dict.fromkeys(names, True)
        try:
            delay = Fraction(random.randint(1, 5), 2)
            now, t = rules.wait(now, delay), t + delay
            action = random.choice([*rules.every_action(now)])
            now = rules.act(now, action)
        except (InvalidRunError, IndexError):
            break
        names = {edge.label for _, edge in action.edges}
    yield t, None


@pytest.mark.law
@pytest.mark.parametrize("first", range(0, 20, 10))
def test_no_random_run_refutes_a_claim(first):
    """A requirement that holds fails on no run, and a vacuous one is never triggered."""
    said = Counter()
    for seed in range(first, first + 10):
        network, _, random = random_labelled(seed)
        for requirement in random.sample(BOUNDED, 5):
            text = requirement.format(a=random.randint(1, 3), b=random.randint(3, 6))
            spec = requiring(text)
            try:
                (one,) = observe(network, spec.checked)
            except ModelError:
                continue  # it cannot start, or a variable leaves its range
            for _ in range(25):
                monitor, attempts = spec.monitor(), []
                try:
                    for t, sample in random_run(network, random):
                        instant = int(t * TICKS_PER_SECOND)
                        if sample is None:
                            attempts += monitor.advance_ns(instant)
                        else:
                            attempts += monitor.step_ns(instant, sample)
                except ModelError:
                    continue  # a variable leaves its range
                verdicts = {attempt.verdict.value for attempt in attempts}
                said.update(verdicts)
                if one.holds is not None and attempts:
                    assert one.triggered is not None, (seed, text)
                    assert not (one.holds and "F" in verdicts), (seed, text)
    assert min(said["F"], said["P"]) > 20
