"""From the birth of all signals on less is asked of state formulas, and nothing else changes."""

import random

import pytest

import rvmon
from rvmon.runtime.nodes import Nodes
from rvmon.spec.print.printer import format_formula
from rvmon.testing.generate.formula import Shape, formula

SIGNALS = "time sampled\nsignal p : bool\nsignal q : bool\nsignal r : bool\nevent e\n"

FORMULAS = (
    "upon e and (previous p) then r",
    "always (p -> once[0 s, 3 s] q)",
    "always (not r and (once p) -> (p since[1 s, 4 s] q))",
    "whenever p then within 2 s (q or (previous r))",
    "always ((p and q) or (q and p) -> not (r and previous r))",
)

UNBORN = [(0, {"p": False}), (1, {"p": None}), (2, {"q": True}), (4, {"e": True})]
BORN = [
    *((5, {"r": False}), (6, {"p": True}), (7, {"q": False}), (8, {"e": True, "p": True})),
    *((9, {"p": None}), (10, {"e": True}), (11, {"p": False, "q": True, "r": True})),
    *((12, {"p": True, "r": False}), (13, {"q": None}), (14, {"e": True}), (15, {"p": False})),
]

LATE = [
    *(("p", False), ("p", True), ("p", False), ("p", True), ("q", True), ("p", False)),
    *(("p", True), ("p", False), ("r", False), ("p", True), ("q", False), ("p", False)),
    *(("r", True), ("p", True), ("q", True), ("p", False), ("p", True), ("q", False)),
]


def run(spec, engine, samples, at=None):
    """All that a run tells; put away and taken up again before the sample at `at` seconds."""
    monitor = spec.monitor(engine=engine)
    told = []
    for t, values in samples:
        if t == at:
            monitor = spec.restore(monitor.snapshot())
        told += map(repr, monitor.step(float(t), values))
    return told, monitor.finish(20.0)


@pytest.mark.law
@pytest.mark.parametrize("formula", FORMULAS)
@pytest.mark.parametrize("at", [None, 3, 6, 12])
def test_birth_changes_nothing_else(formula, at, monkeypatch):
    grown = []
    grow = Nodes.grow

    def seen(unit):
        grow(unit)
        grown.append(unit.grown)

    monkeypatch.setattr(Nodes, "grow", seen)
    spec = rvmon.loads(f"{SIGNALS}\nrequirement R\n  {formula}\n")
    samples = UNBORN + BORN
    assert run(spec, "python", samples, at) == run(spec, "automaton", samples)
    assert grown[-1] == 1
    assert formula == FORMULAS[0] or grown[0] == 0  # what speaks of `p` is born with it


def test_what_is_never_born_is_waited_for():
    spec = rvmon.loads(f"{SIGNALS}\nrequirement R\n  {FORMULAS[1]}\n")
    samples = [
        (t, {name: value for name, value in values.items() if name != "q"}) for t, values in BORN
    ]
    assert run(spec, "python", samples) == run(spec, "automaton", samples)


def test_a_value_alone_is_followed_where_others_are_born():
    """Of many requirements, in held time: before that, what it leads to is worked out in full."""
    texts = [
        f"requirement R{n}\n  upon p and not once[0 ns, {n} ns] (q and r)\n  then q"
        for n in range(1, 16)
    ]
    signals = SIGNALS.replace("sampled", "held")
    spec = rvmon.loads("\n".join([f"spec s\n{signals}", *texts]))
    samples = [(t, {name: value}) for t, (name, value) in enumerate(LATE)]
    told = []
    for engine in ("python", "automaton"):
        monitor = spec.monitor(engine=engine)
        steps = [[*map(repr, monitor.step_ns(t, values))] for t, values in samples]
        told.append((steps, monitor.finish_ns(40)))
    assert told[0] == told[1]


BESIDE = "time held\nsignal p : bool\nsignal q : bool\nsignal r : bool\nsignal u : bool\nevent e\n"

SECOND = 1_000_000_000

BESIDES = {
    "an episode that goes on, beside attempts": (
        "requirement R1\n  whenever p then within 2 s q\n"
        "requirement R2\n  upon e then within 1 s r\n",
        [(2 * SECOND + 1, {"r": True}), (3 * SECOND, {"r": False}), (4 * SECOND + 9, {"q": True})],
    ),
    "what is due, beside a window that ends later": (
        "requirement R1\n  whenever p then within 2 s r\n"
        "requirement R2\n  always (u -> once[0 s, 10 s] q)\n",
        [(1, {"q": True}), (SECOND, {"q": False}), (5 * SECOND, {"r": True})],
    ),
}


@pytest.mark.parametrize("which", BESIDES)
def test_nothing_is_slept_through_beside_other_requirements(which):
    requirements, samples = BESIDES[which]
    spec = rvmon.loads(BESIDE + requirements)
    first = {"p": True, "q": False, "r": False, "u": False}
    runs = {}
    for engine in ("python", "automaton"):
        monitor = spec.monitor(engine=engine)
        told = [repr(monitor.step_ns(t, values)) for t, values in [(0, first), *samples]]
        runs[engine] = told, monitor.finish_ns(9 * SECOND)
    assert runs["python"] == runs["automaton"]
    assert runs["python"][1].verdicts["R1"] == "F"


def born_late(rng):
    """Samples of one signal each, of which `p` comes last."""
    t, samples = 0, []
    late = rng.randint(3, 25)
    for number in range(30):
        t += rng.choice((1, 1, 2, 5, 12))
        name = rng.choice("qqr" if number < late else "pqr")
        samples.append((t, {name: None if rng.random() < 0.05 else rng.random() < 0.5}))
    return samples


def agree(spec, samples):
    """Whether generated code and tables tell the same of each sample and at the end."""
    runs = []
    for engine in ("python", "automaton"):
        monitor = spec.monitor(engine=engine)
        told = [[*map(repr, monitor.step_ns(t, values))] for t, values in samples]
        runs.append((told, monitor.finish_ns(samples[-1][0] + 20)))
    return runs[0] == runs[1]


MANY = "".join(
    f"requirement R{n}\n  always ((r and (not q) and (once q)) -> "
    f"((once[0 ns, {n} ns] (p or q)) since q))\n"
    for n in range(3, 15)
)


@pytest.mark.law
@pytest.mark.parametrize("requirements", [MANY, MANY[: MANY.index("requirement R4")]])
def test_many_requirements_wait_for_a_signal_that_is_born_late(requirements):
    """Some of many are followed before all signals are born: only what is the same by then is."""
    spec = rvmon.loads(
        "time held\nsignal p : bool\nsignal q : bool\nsignal r : bool\n" + requirements
    )
    for seed in range(15):
        samples = born_late(random.Random(seed))
        assert agree(spec, samples), samples


def test_what_has_a_value_once_all_are_born_had_one_before():
    """A deep formula is shallower then: it is cut into values at the same places all the same."""
    spec = rvmon.loads(
        "time held\nsignal p : bool\nsignal q : bool\nsignal r : bool\nevent f\n"
        "requirement R\n  upon f\n  then (false since[1 ns, 1 ns] (r xor q))\n"
    )
    for engine in ("python", "automaton"):
        monitor = spec.monitor(engine=engine)
        monitor.step_ns(-3, {})
        monitor.step_ns(-2, {"q": True, "r": False})
        (attempt,) = monitor.step_ns(5, {"f": True})
        assert attempt.verdict == "F"


@pytest.mark.law
@pytest.mark.parametrize("time", ["held", "sampled"])
@pytest.mark.parametrize("count", [2, 8])
def test_random_requirements_wait_for_a_signal_that_is_born_late(time, count):
    shape = Shape(future=False, numbers=False, events=False)
    for seed in range(10):
        rng = random.Random(f"{time}/{count}/{seed}")
        texts = [
            f"requirement R{n}\n  always ({format_formula(formula(rng, shape, 3))})"
            for n in range(count)
        ]
        signals = [f"signal {name} : bool" for name in "pqr"]
        spec = rvmon.loads("\n".join([f"time {time}", *signals, *texts]))
        for _ in range(4):
            samples = born_late(rng)
            assert agree(spec, samples), (texts, samples)
