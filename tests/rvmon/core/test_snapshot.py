"""Snapshots of a run of the core: loading one loses nothing, and no bytes do harm."""

import random
import struct
from collections import Counter
from typing import Any

import pytest
from tests.rvmon.core.test_outages import planned
from tests.rvmon.core.twins import HEAD, Twins, reload_after_each_call
from tests.tools.differential import case_of
from tests.tools.drive import Found, Lost
from tests.tools.forms import Compiler

from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.packed_plan import PlannedCore
from rvmon.monitor.records import report_of_run
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.trace.sample import Sample

REQUIREMENTS = """
requirement R1 whenever p or once[0 s, 3 ns] q
  then eventually[2 ns, 7 ns] (x > 1 or rate(x) < 2)
requirement R2 upon g.k == key then within 6 ns (e or (s since[1 ns, 4 ns] p))
  for each key in g.k
requirement R3 upon g then within 5 ns x == value let value = x
requirement R4 upon rise(q) then always[1 ns, 4 ns] (eventually[0 ns, 3 ns] p)
requirement R5 whenever mean(x, 5 ns) >= 1 or count(g, 6 ns) >= 3
  then within 4 ns (sum(x, 5 ns) > 2 or integral(x) >= 9 ns)
"""


@pytest.mark.law
@pytest.mark.parametrize("outages", [False, True])
@pytest.mark.parametrize("time", TimeModel)
def test_a_loaded_run_goes_on_like_the_saved_one(time, outages):
    compile_, reloads = Compiler(), 0
    for number in range(12):
        profile = Profile(requirements=1 + number % 4, time=time)
        one = case_of(f"away/{time}/{number}", profile, TraceProfile(outages=100 * outages))
        reloads += reload_after_each_call(compile_(one.spec), one)
    assert reloads > 70


def test_a_run_with_a_doubtful_first_position_can_be_loaded():
    """A name lost before the first sample comes back at a tick after that position."""
    text = "requirement R\n  upon start\n  then updated(x) or q\n"
    twins = Twins(planned(text, "sampled every 4 ns"))
    for action in (Lost(("x",), -2), Found(("x",), -2), Sample(1, {}), Sample(3, {"q": True}), 9):
        twins.tell(action)
    twins.finish(12)


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 127 ns"])
@pytest.mark.parametrize("begin", [1 - (1 << 62), (1 << 62) - 200])
def test_windows_may_reach_beyond_the_bounds_of_time(time, begin):
    """So do two nested windows of a century, and the first tick of a clock before its stamp."""
    far = "always[900000 h, 1000000 h] (eventually[600000 h, 700000 h] q)"
    twins = Twins(planned(f"requirement R\n  upon rise(q)\n  then p until ({far})\n", time))
    for t in range(begin, begin + 190, 19):
        twins.tell(Sample(t, {"q": t % 2 == 0, "p": True, "x": 1.0}))
    twins.finish(None)


def test_a_snapshot_says_why_a_value_is_unknown():
    """NaN stays NaN in a sample that waits for its tick, and in values kept for the past."""
    text = "requirement R\n  upon end\n  then once x > value\n  let value = x\n"
    plan = planned(text, "sampled every 4 ns")
    twins = Twins(plan)
    twins.tell(Sample(0, {"x": 1.0}))
    twins.tell(Sample(5, {"x": float("nan")}))
    twins.finish(30)
    (found,) = report_of_run(plan, twins.other, 0, None).attempts
    assert "NaN at 5 ns" in str(found.reason)


def run_of(planned_: PlannedCore, rng: random.Random, steps: int) -> Twins:
    """Two runs after some random steps, of which one was reloaded at each."""
    twins = Twins(planned_)
    t = 0
    for _ in range(steps):
        t += rng.randint(1, 4)
        values: dict[str, Any] = {"p": rng.random() < 0.5, "q": rng.random() < 0.5}
        values["x"] = rng.choice([0.5, 1.5, None])
        if rng.random() < 0.5:
            values |= {"e": True, "s": True, "g": ({"k": rng.randint(0, 3)}, {"k": 4})}
        twins.tell(Sample(t, values))
        if rng.random() < 0.2:
            twins.tell(Lost(("x", "e"), t + 1))
            twins.tell(t + 3)
            twins.tell(Found(("x", "e"), t + 4))
            t += 4
    return twins


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled every 2 ns"])
def test_changed_bytes_are_refused(time):
    plan = planned(REQUIREMENTS, time)
    data = run_of(plan, random.Random(time), 12).plain.save()
    other = plan.monitor(frozenset())
    for place in range(len(data)):
        assert not other.load(data[:place] + bytes([data[place] ^ 0x41]) + data[place + 1 :])
    for end in range(0, len(data), 7):
        assert not other.load(data[:end])
    assert not other.load(data + b"\0")
    assert other.load(data)
    assert other.save() == data
    magic, hash_, size = struct.unpack_from("<8sQQ", data)
    assert (magic, size) == (b"rvvshot3", len(data))
    assert hash_ == struct.unpack_from("<Q", plan.packed.data, 24)[0]


def sealed(body: bytes, head: bytes) -> bytes:
    """A snapshot of a body, with the right size and hash in its header."""
    hash_ = 0xCBF29CE484222325
    for one in body:
        hash_ = (hash_ ^ one) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return head[:16] + struct.pack("<QQ", HEAD + len(body), hash_) + body


def forged(data: bytes, rng: random.Random) -> bytes:
    """A snapshot that was changed at random places, with a matching hash."""
    body = bytearray(data[HEAD:])
    for _ in range(rng.randint(1, 3)):
        place = rng.randrange(len(body))
        how = rng.random()
        if how < 0.5:
            body[place] = rng.choice((0, 1, 2, 3, 127, 128, 255, rng.randrange(256)))
        elif how < 0.8:
            word = rng.choice(
                (0, 1, -1, (1 << 62) - 1, -(1 << 62), (1 << 63) - 1, rng.randrange(99))
            )
            body[place : place + 8] = struct.pack("<q", word)
        elif how < 0.9:
            del body[place : place + rng.randint(1, 9)]
        else:
            other = rng.randrange(len(body))
            body[place:place] = body[other : other + rng.randint(1, 9)]
    return sealed(bytes(body), data[:HEAD])


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled every 2 ns"])
def test_forged_bytes_are_refused_or_give_a_run_that_works(time):
    plan = planned(REQUIREMENTS, time)
    rng = random.Random(time)
    data = run_of(plan, rng, 12).plain.save()
    outcomes: Counter[bool] = Counter()
    for _ in range(500):
        made = plan.monitor(frozenset())
        is_loaded = made.load(forged(data, rng))
        outcomes[is_loaded] += 1
        if is_loaded:
            _, _, reached = made.times()
            again = made.save()
            other = plan.monitor(frozenset())
            assert other.load(again)
            assert other.save() == again
            t = 0 if reached is None else min(reached, 1 << 61)
            for number in range(3):
                made.judge(t + 2 * number + 1, {"p": True, "g": {"k": number}}, True)
            made.open()
            made.finish(None)
            made.counts()
    assert min(outcomes.values()) > 15, outcomes


def test_a_snapshot_says_which_names_have_no_source():
    plan = planned("requirement R1\n  upon start\n  then eventually[2 ns, 2 ns] p")
    absent = plan.monitor(frozenset({"p"}))
    made = plan.monitor(frozenset())
    assert made.load(absent.save())
    for one in (absent, made):
        assert one.judge(0, {"q": True}, True)
        one.finish(5)
        assert one.counts() == [(0, 0, 1, 1)]
