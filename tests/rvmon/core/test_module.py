"""The extension type of the core: what it accepts, what it refuses, and that it leaks nothing."""

import gc
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from tests.tools.each import each

import rvmon
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.native import Monitor as Run

SPEC = """
spec odd "Something of each kind"
signal p, q : bool
signal x : real   stale after 2 s
signal n : int
signal mode : {red, green}
event e(k: int, where: {left, right})
event f
requirement R1 "a"
  upon e.k > 2 and e.where == left and once[1 s, 3 s] p
  then within 3 s held(q or x > 1, 1 s)
requirement R2 "b"
  always (f -> (p since[0 s, 5 s] (mode == green)) or n > 3)
requirement R3 "c"
  upon e
  then within 1 s x > v
  for each i in e.k
  let v = x
"""

WAITING = """
spec waiting
signal p, q : bool
requirement R1
  upon p
  then within 1 h q
requirement R2
  upon p
  then within 2 h q
"""

NUMBERS = ("p", "q", "x", "n", "mode", "e", "f")
"""The declared names, in the order of their numbers."""


def planned_of(text: str = SPEC) -> PlannedCore:
    compiled = compile_spec(rvmon.loads(text).checked)
    return planned_core(compiled)


@pytest.fixture(scope="module")
def planned() -> PlannedCore:
    return planned_of()


@pytest.fixture
def run(planned) -> Run:
    """A run that raises `LookupError` where it falls back to Python."""
    return planned.monitor(frozenset(), fallback, fallback)


def fallback(*given: object, **named: object) -> list[rvmon.Attempt]:
    """Stands in for the Python code that takes the calls that the core leaves alone."""
    raise LookupError(given, named)


@pytest.mark.slow
def test_a_step_within_a_garbage_collection_of_a_step_harms_nothing():
    """Attempts are made from copies, since the core may move its records meanwhile."""
    monitor = rvmon.loads(WAITING).monitor()
    meanwhile: list[int] = []
    t = 0

    def step(phase: str, _: dict[str, int]) -> None:
        if not meanwhile:
            meanwhile.append(t)
            for n in range(5000):
                monitor.step_ns(t + 2 + n, {"p": n % 2 == 0, "q": n % 2 == 1})

    for t in range(1, 3001):
        monitor.step_ns(t, {"p": t % 2 == 1, "q": False})
    gc.collect()
    before = gc.get_threshold()
    gc.callbacks.append(step)
    gc.set_threshold(500)  # one step makes 3,000 attempts
    try:
        decided = monitor.step_ns(t + 1, {"q": True})
    finally:
        gc.set_threshold(*before)
        gc.callbacks.remove(step)
    found = [(one.requirement, one.number, one.decided) for one in decided]
    assert meanwhile or sys.version_info >= (3, 12)  # newer versions collect after the call
    assert found == [(r, n, t + 1) for r in ("R1", "R2") for n in range(1, 1501)]


ODD: list[Any] = [
    *({"p": 1}, {"p": np.bool_(True)}, {"n": 1.0}, {"n": True}, {"n": 1 << 63}),
    *({"x": True}, {"x": "1"}, {"x": 1 << 64}, {"x": np.float32(1)}, {"mode": "left"}, {"mode": 0}),
    *({"e": 1}, {"e": {"z": 1}}, {"e": {3: 1}}, {"e": {"k": 1.0}}, {"e": [{"k": 1}]}),
    *({"e": ({"k": 1}, {"k": 2})}, {"e": ({"k": 1}, True)}, {"f": {"k": 1}}, {"z": True}),
    *({3: True}, [("p", True)]),
]


@each("values", ODD)
@each("before", [{}, {"q": True, "f": True, "e": {"k": 5}}])
def test_an_unusual_sample_is_passed_on_to_python(planned, values, before):
    """Python gets the call unchanged, and the core takes nothing of it."""
    run = planned.monitor(frozenset(), fallback, fallback)
    given = {**before, **values} if isinstance(values, dict) else values
    with pytest.raises(LookupError) as left:
        run.step_ns(7, given)
    assert left.value.args == ((7, given), {})
    assert run.times() == (None, None, None)
    assert run.step_ns(7, {"p": True, "x": 1.5, "e": True}) == ()
    assert run.times() == (7, 7, 7)


def test_an_unusual_call_is_passed_on_to_python(run):
    """So are times of the wrong type or out of range, and times out of order."""
    calls: list[tuple[Callable[..., object], tuple[object, ...], dict[str, object]]] = [
        (run.step_ns, (1.0, {}), {}),
        (run.step_ns, (1 << 62, {}), {}),
        (run.step_ns, (1 << 70, {}), {}),
        (run.step_ns, (5,), {"values": {}}),
        (run.step_ns, (), {}),
        (run.step_ns, (1, {}, 3), {}),
        (run.step, (1, {}), {}),
        (run.step, (4e9, {}), {}),
        (run.step, (float("nan"), {}), {}),
        (run.step, (), {"t": 1.0, "values": {}}),
    ]
    for call, given, named in calls:
        with pytest.raises(LookupError) as left:
            call(*given, **named)
        assert repr(left.value.args) == repr((given, named))
    run.step_ns(5, {})
    for t in (5, 4):
        with pytest.raises(LookupError):
            run.step_ns(t, {})
    run.hold(True)
    with pytest.raises(LookupError):
        run.step_ns(9, {})
    run.hold(False)
    assert run.step_ns(9, {}) == ()


def test_rows_are_taken_up_to_the_first_that_goes_back_in_time(run):
    assert run.rows(np.array([1, 5, 5, 4, 9]), ()) == 3
    assert run.times() == (1, 5, 5)
    assert run.rows(np.array([3]), ()) == 0
    assert run.rows(np.array([], np.int64), ()) == 0
    assert run.rows(np.array([6]), ()) == 1


TIMES = np.arange(8)
REALS = (0, np.zeros(8), None)
SAYS = np.zeros(8, np.uint8)
WRONG: list[tuple[Any, Any]] = [
    (TIMES, ((2, (0, np.zeros(7), None)),)),
    (TIMES, ((2, (0, np.zeros(16)[::2], None)),)),
    (TIMES, ((2, (0, np.zeros(8, np.float32), None)),)),
    (TIMES, ((2, (0, np.zeros(72, np.uint8)[4:68].view(np.float64), None)),)),
    (TIMES, ((2, (0, np.zeros(8), np.zeros(7, np.uint8))),)),
    (TIMES, ((2, (0, None, SAYS)),)),
    (TIMES, ((5, (0, np.zeros(8), SAYS)),)),
    (TIMES, ((7, SAYS),)),
    (TIMES, ((-1, REALS),)),
    (TIMES, ((2, (3, np.zeros(8), None)),)),
    (TIMES, ((2, (1, np.zeros(8, np.int64), None)),)),
    (TIMES, ((0, REALS),)),
    (TIMES, ((2, (0, 5, None)),)),
    (TIMES, ((2, (0,)),)),
    (TIMES, ((2, 0),)),
    (TIMES, ((2,),)),
    (TIMES, (2,)),
    (TIMES, ((2, REALS), (2, REALS))),
    (TIMES, tuple((2, REALS) for _ in range(8))),
    (TIMES, ((5, SAYS, 3),)),
    (TIMES, ((5, SAYS, ()),)),
    (TIMES, ((5, SAYS, (REALS, REALS, REALS)),)),
    (TIMES, ((5, SAYS, (REALS, REALS)),)),
    (TIMES, ((5, SAYS, (3, 3)),)),
    (TIMES, []),
    (5, ()),
]


@each("given", WRONG)
def test_malformed_columns_are_refused(run, given):
    """The core checks sizes, kinds and numbers before it reads anything."""
    with pytest.raises((ValueError, TypeError, BufferError)):
        run.rows(*given)
    assert run.times() == (None, None, None)


def parts_of(planned: PlannedCore) -> list[Any]:
    """The arguments that the extension type is called with."""
    kept: list[Any] = []

    class Kept:
        def __new__(cls, *given: Any) -> Any:
            kept.extend(given)
            return None

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rvmon.native.Monitor", Kept)
        planned.monitor(frozenset(), fallback, fallback)
    return kept


def damaged(planned: PlannedCore) -> Iterator[list[Any]]:
    data, reading, absent, look, attempts = parts_of(planned)
    numbers, words, kinds, single = reading
    yield [data[:50], reading, absent, look, attempts]
    yield [bytes(len(data)), reading, absent, look, attempts]
    yield [data, (numbers, words[1:], kinds, single), absent, look, attempts]
    yield [data, (numbers, words, kinds[1:], single), absent, look, attempts]
    yield [data, (numbers, words, kinds, single[1:]), absent, look, attempts]
    yield [data, (numbers, tuple(None for _ in words), kinds, single), absent, look, attempts]
    yield [data, reading, absent[1:], look, attempts]
    for place, wrong in ((0, int), (1, ()), (2, ()), (3, tuple(range(9)))):
        yield [data, reading, absent, look, (*attempts[:place], wrong, *attempts[place + 1 :])]
    yield [data, reading, absent, look]
    yield [3, reading, absent, look, attempts]


def test_inconsistent_arguments_are_refused(planned):
    assert Run(*parts_of(planned)).times() == (None, None, None)
    for given in damaged(planned):
        with pytest.raises((ValueError, TypeError)):
            Run(*given)


def test_names_and_fields_numbered_outside_the_plan_are_passed_on_to_python(planned):
    data, (numbers, words, *rest), *others = parts_of(planned)
    odd = ({**numbers, "p": 7, "q": -1}, (*words[:5], {"k": 2, "where": -1}, *words[6:]), *rest)
    run = Run(data, odd, *others)
    for values in ({"p": True}, {"q": True}, {"e": {"k": 1}}, {"e": {"where": "left"}}):
        with pytest.raises(LookupError):
            run.step_ns(1, values)


def everything(planned: PlannedCore, wrong: list[list[Any]]) -> None:
    """Make all calls of a run, and let each fail in all ways."""
    run = planned.monitor(frozenset({"q"}), fallback, fallback)
    samples: list[Any] = [{}, {"p": True, "x": 1.0}, {"z": 1}, {"e": ({"k": 1}, {"k": 2})}, {3: 1}]
    samples += [{"e": tuple({"k": k} for k in range(50))}, {"e": ({"k": 1}, 3)}, {"n": 2**70}]
    samples += [{"mode": "".join(["gr", "een"])}, {"".join(["p"]): False, "x": 0.0}, {"q": True}]
    for t, values in enumerate(samples):
        try:
            run.step_ns(t * 10**9, values)
        except LookupError:
            run.judge(t * 10**9, values, True)
    for call in (run.records, run.counts, run.times, run.open, run.flush, run.next_due):
        call()
    for given in WRONG:
        with suppress(ValueError, TypeError, BufferError):
            run.rows(*given)
    run.rows(TIMES + 10**12, ((2, (0, np.zeros(8), SAYS)),))
    fields = ((1, TIMES, None), (2, None, None))
    run.rows(TIMES + 10**13, ((5, None, fields),))
    for odd in ((), (1,), (1, 2, 3), ("a", {})):
        with suppress(LookupError):
            run.step_ns(*odd)
    for parts in wrong:
        with suppress(ValueError, TypeError):
            Run(*parts)
    run.finish(None)
    run.reset()

    ring: list[Any] = []
    ring.append(planned.monitor(frozenset(), lambda *_: ring, fallback))


@pytest.mark.slow
def test_no_call_leaks_memory(planned):
    wrong = list(damaged(planned))
    for _ in range(5):
        everything(planned, wrong)
    found = []
    for _ in range(4):
        gc.collect()
        found.append(sys.getallocatedblocks())
        for _ in range(20):
            everything(planned, wrong)
    assert min(found[1:]) <= found[0] + 15  # any leak leaves at least 20


def test_records_share_the_letters_of_their_notes():
    """Failures of a network refer to shared letters, each up to its own decision."""
    spec = rvmon.loads(
        "spec s\nsignal p, q : bool\nevent e\nrequirement R\n"
        "  upon e\n  then within 25 ns for 15 ns (p and q)\n"
    )
    rows = 1000
    run = spec.planned().monitor(frozenset())
    for t in range(rows):
        run.judge(10 * t, {"p": t % 2 == 0, "q": True, "e": t % 2 == 1}, False)
    run.finish(None)
    *_, letters = run.records()
    counts = [count for _, _, count in letters]
    assert len(letters) > rows // 4
    assert all(8 * count <= len(last) for _, last, count in letters)
    assert len({id(last) for _, last, _ in letters}) < len(letters) // 4
    assert len(set(counts)) > 1
