"""A run of the core as bytes, and from them: nothing is lost, and no bytes do harm."""

import random
import struct
from collections import Counter
from typing import Any

import pytest
from tests.rvmon.core.put_away import HEAD, Twins, put_away
from tests.rvmon.core.test_outages import planned
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


ALL: frozenset[str] = frozenset()
"""All names have a source."""


@pytest.mark.law
@pytest.mark.parametrize("outages", [False, True])
@pytest.mark.parametrize("time", [TimeModel.HELD, TimeModel.SAMPLED, TimeModel.CLOCKED])
def test_a_run_taken_up_again_goes_on_alike(time, outages):
    """Of some requirements, with keys and captured values; names may be lost."""
    compile_, taken = Compiler(), 0
    for number in range(12):
        profile = Profile(requirements=1 + number % 4, time=time)
        one = case_of(f"away/{time}/{number}", profile, TraceProfile(outages=100 * outages))
        taken += put_away(compile_(one.spec), one)
    assert taken > 70


def test_a_run_whose_first_position_may_not_be_there_is_taken_up_again():
    """What was lost before the first sample comes back at a tick that lies behind that position."""
    text = "requirement R\n  upon start\n  then updated(x) or q\n"
    plan = planned(text, "sampled every 4 ns")
    twins = Twins(plan, frozenset())
    for action in (Lost(("x",), -2), Found(("x",), -2), Sample(1, {}), Sample(3, {"q": True})):
        twins.tell(action)
        twins.take_up()
    twins.tell(9)
    twins.finish(12)


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 127 ns"])
@pytest.mark.parametrize("begin", [1 - (1 << 62), (1 << 62) - 200])
def test_what_is_asked_for_may_lie_behind_the_bounds_of_time(time, begin):
    """Two windows of a century lead there; a clock's first position lies before its first stamp."""
    far = "always[900000 h, 1000000 h] (eventually[600000 h, 700000 h] q)"
    twins = Twins(planned(f"requirement R\n  upon rise(q)\n  then p until ({far})\n", time), ALL)
    for t in range(begin, begin + 190, 19):
        twins.tell(Sample(t, {"q": t % 2 == 0, "p": True, "x": 1.0}))
    twins.finish(None)


def test_why_a_value_is_unknown_is_part_of_it():
    """A sample that waits for its tick, and what is kept for those that look back, say NaN."""
    text = "requirement R\n  upon end\n  then once x > value\n  let value = x\n"
    plan = planned(text, "sampled every 4 ns")
    twins = Twins(plan, ALL)
    twins.tell(Sample(0, {"x": 1.0}))
    twins.tell(Sample(5, {"x": float("nan")}))
    twins.finish(30)
    (found,) = report_of_run(plan, twins.other, 0, None).attempts
    assert "NaN at 5 ns" in str(found.reason)


def run_of(planned_: PlannedCore, rng: random.Random, steps: int) -> Twins:
    """Two runs that have come somewhere, of which one was taken up again on the way."""
    twins = Twins(planned_, frozenset())
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
    """A snapshot with the size and the hash of what stands behind its head."""
    hash_ = 0xCBF29CE484222325
    for one in body:
        hash_ = (hash_ ^ one) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return head[:16] + struct.pack("<QQ", HEAD + len(body), hash_) + body


def forged(data: bytes, rng: random.Random) -> bytes:
    """A snapshot that was changed somewhere, with a hash that fits."""
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
def test_forged_bytes_do_no_harm(time):
    """Bytes with a hash that fits are refused, or give a run that can be led to its end."""
    plan = planned(REQUIREMENTS, time)
    rng = random.Random(time)
    data = run_of(plan, rng, 12).plain.save()
    outcomes: Counter[bool] = Counter()
    for _ in range(500):
        made = plan.monitor(frozenset())
        taken = made.load(forged(data, rng))
        outcomes[taken] += 1
        if taken:
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


def test_names_without_a_source_are_part_of_it():
    plan = planned("requirement R1\n  upon start\n  then eventually[2 ns, 2 ns] p")
    absent = plan.monitor(frozenset({"p"}))
    made = plan.monitor(frozenset())
    assert made.load(absent.save())
    for one in (absent, made):
        assert one.judge(0, {"q": True}, True)
        one.finish(5)
        assert one.counts() == [(0, 0, 1, 1)]
