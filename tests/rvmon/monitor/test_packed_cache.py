"""The cache of packed plans returns the same plan, or nothing."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

import rvmon
import rvmon.core.pack
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.monitor import build_monitor

pytestmark = pytest.mark.slow

TEXT = """
const T = 2 s
signal x : real
event e, f
event g(k: int, s: {a, b})
requirement R
  upon e then within T x > 1
requirement S
  upon g.k > 1 and g.s = b
  then F[1 s, 2 s] f
  let v = x
coverpoint far = x {low: [0, 1), high: [1, inf)}
coverpoint near = x {none: [0, 2), much: [2, 3), most: [3, inf)}
cross both = far, near
  ignore far == high
"""
SAMPLES = [
    (0, {"x": 3, "e": True, "g": {"k": 2, "s": "b"}}),
    (1, {"x": 0, "e": True, "f": True, "g": {"k": 2, "s": "a"}}),
    (5, {"x": 2}),
]
"""R passes at 0 s and fails at 3 s, S passes at 1 s."""


@pytest.fixture
def packs_nothing(monkeypatch):
    """Packing a plan fails from now on."""

    def forbid():
        monkeypatch.setattr(rvmon.core.pack, "pack", lambda _: pytest.fail("it is packed"))

    return forbid


def kept_in(own_cache):
    return sorted(own_cache.glob("plan-*.bin"))


def judged(text=TEXT, **how):
    """The verdicts of a new monitor on the samples, online and at the end."""
    spec = rvmon.loads(text)
    monitor = spec.monitor(**how)
    decided = [list(monitor.step(t, values)) for t, values in SAMPLES]
    return decided, monitor.finish(9).to_json(), spec


def test_the_second_time_the_cache_is_read(own_cache, packs_nothing):
    decided, report, spec = judged()
    evaluated = spec.evaluate(SAMPLES).verdicts
    build_monitor(compile_spec(spec.checked))  # not every generated specification is kept
    assert [path.stat().st_mode & 0o077 for path in kept_in(own_cache)] == [0]
    packs_nothing()
    again, same, spec = judged()
    assert (again, same) == (decided, report)
    assert [one.requirement for call in decided for one in call] == ["R", "S", "R"]
    spec = rvmon.loads(TEXT)
    assert spec.evaluate(SAMPLES).verdicts == evaluated
    assert "requirements" not in vars(spec._compiled)
    assert len(kept_in(own_cache)) == 1


def test_what_coverage_judges_is_kept_apart(own_cache, monkeypatch):
    first = rvmon.loads(TEXT).coverage(SAMPLES)
    rvmon.loads(TEXT).evaluate(SAMPLES)
    assert len(kept_in(own_cache)) == 3
    planned = []
    monkeypatch.setattr(
        "rvmon.monitor.requirement_plans.plan_alone", lambda *_, **__: planned.append(1)
    )
    assert rvmon.loads(TEXT).coverage(SAMPLES) == first
    assert {"R", "S", "`R` edges"} <= first.keys()
    assert not planned


def test_other_plans_are_told_apart(own_cache):
    judged()
    judged(only=["R"])
    judged(TEXT.replace("T = 2 s", "T = 3 s"))
    judged(TEXT.replace("x > 1\n", "x > 1.5\n"))
    assert len(kept_in(own_cache)) == 4


def whole(body):
    return hashlib.sha256(body).hexdigest().encode() + b"\n" + body


def damages(path, other):
    """Damaged contents of the file: torn, of another plan, empty, changed."""
    content = path.read_bytes()
    body = content.partition(b"\n")[2]
    key, names, data = body.split(b"\n", 2)
    for size in (0, 1, 64, 65, 66, 130, 200, len(content) // 2, len(content) - 1):
        yield content[:size]
        yield whole(body[:size])
    yield other.read_bytes()
    for wrong in (b"", b"[]", b"5", b"[5,[]]", b"[[[]],[]]", b"[" * 100_000, b"\xff"):
        yield whole(b"\n".join([key, wrong, data]))
    for wrong in (b"", b"x" * 4096, data + bytes(8), data[:-8]):
        yield whole(b"\n".join([key, names, wrong]))
    for place in range(0, len(data), 499):
        changed = bytearray(data)
        changed[place] ^= 0x40
        yield whole(b"\n".join([key, names, bytes(changed)]))
        yield content[: len(content) - len(data)] + changed


def test_a_damaged_file_is_ignored(own_cache):
    decided, report, _ = judged()
    [path] = kept_in(own_cache)
    judged(TEXT.replace("x > 1\n", "x > 2\n").replace("requirement S", "requirement Q"))
    [other] = {*kept_in(own_cache)} - {path}
    right = path.read_bytes()
    for damage in damages(path, other):
        path.write_bytes(damage)
        assert judged()[:2] == (decided, report)
        assert path.read_bytes() == right


def test_what_is_refused_is_not_kept(own_cache):
    deep = "(x - " * 40 + "x" + ")" * 40
    for _ in range(2):
        with pytest.raises(rvmon.RvmonError, match="deep"):
            judged(TEXT.replace("x > 1\n", f"{deep} > 1\n"))
    assert not kept_in(own_cache)


@pytest.mark.process
def test_all_processes_share_it(tmp_path):
    """Whatever the order of their sets: the same plan under the same name."""
    spec = Path(__file__).parents[3] / "specs" / "handover_truth.rv"
    program = f"import rvmon; rvmon.load({str(spec)!r}).monitor()"
    found = set()
    for seed in "123":
        cache = tmp_path / seed
        env = {**os.environ, "PYTHONHASHSEED": seed, "XDG_CACHE_HOME": str(cache)}
        command = [sys.executable, "-c", program]
        subprocess.run(command, env=env, check=True)  # noqa: S603
        [path] = kept_in(cache / "rvmon")
        *_, data = path.read_bytes().split(b"\n", 3)
        found.add((path.name, data))
    assert len(found) == 1
