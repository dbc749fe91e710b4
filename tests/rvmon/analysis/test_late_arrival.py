"""Events and states that came after their deadline."""

from tests.tools.each import each

import rvmon
from rvmon.analysis.late_arrival import late_in, waits_of
from rvmon.analysis.truths import look_through
from rvmon.trace.sample import Sample

SECOND = 10**9
HEAD = """spec s
time {time}
signal near : bool
signal gap : real [m]
event go, done
event part(id: int)
requirement R
"""

CASES = {
    "an event": (
        "  upon go\n  then within 3 s done",
        [(0, {}), (1, {"go": True}), (4.02, {"done": True}), (9, {"done": True})],
        {1: 4.02},
    ),
    "a signal that must become false": (
        "  upon go\n  then within 3 s not near",
        [(0, {"near": True}), (1, {"go": True}), (5, {"near": False}), (9, {})],
        {1: 5},
    ),
    "the end of an until": (
        "  upon go\n  then near until[0 s, 3 s] done",
        [(0, {"near": True}), (1, {"go": True}), (6, {"done": True})],
        {1: 6},
    ),
    "never": ("  upon go\n  then within 3 s done", [(1, {"go": True}), (9, {})], {}),
    "in time": ("  upon go\n  then within 3 s done", [(1, {"go": True}), (2, {"done": True})], {}),
    "no deadline was missed": (
        "  upon go\n  then near until[0 s, 3 s] done",
        [(0, {"near": True}), (1, {"go": True}), (2, {"near": False}), (6, {"done": True})],
        {},
    ),
    "what speaks of the future itself": (
        "  upon go\n  then within 1 s for 2 s near",
        [(0, {"near": False}), (1, {"go": True}), (5, {"near": True}), (9, {})],
        {},
    ),
    "a captured value": (
        "  upon go\n  then within 1 s gap > g\n  let g = gap",
        [
            *((0, {"gap": 1.0}), (1, {"go": True}), (4, {"go": True, "gap": 3.0})),
            *((6, {"gap": 2.0}), (8, {"gap": 4.0})),
        ],
        {1: 4, 2: 8},
    ),
    "each instance its own": (
        "  upon part\n  then eventually[1 s, 2 s] part\n  for each i in part.id",
        [(0, {"part": {"id": 1}}), (1, {"part": {"id": 2}}), (4, {"part": {"id": 2}}), (5, {})],
        {2: 4},
    ),
}


@each("time", ["held", "sampled"])
@each("name", CASES)
def test_what_came_too_late_is_found_with_its_instant(name, time):
    text, rows, expected = CASES[name]
    spec = rvmon.loads(HEAD.format(time=time) + text + "\n")
    samples = [Sample(round(t * SECOND), values) for t, values in rows]
    report = spec.evaluate(rows)
    waits = waits_of(spec.requirements["R"], report.attempts)
    seen = look_through(spec.checked, waits.values(), samples, report.end)
    found = late_in(report.attempts, waits, seen)
    assert found == {number: round(t * SECOND) for number, t in expected.items()}
