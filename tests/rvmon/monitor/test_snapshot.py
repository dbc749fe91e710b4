"""A run that is saved and restored continues unchanged."""

import copy
import hashlib
import json
import random
from types import MappingProxyType

import pytest

import rvmon
from rvmon.errors import RvmonError, SnapshotError

TEXT = """
spec door
signal closed : bool input
signal width  : real  stale after 3 s
event knock(force: real) input
requirement D1
  upon knock
  then within 2 s not closed
requirement D2
  upon knock
  then within 4 s width < bound
  let bound = knock.force
requirement D3
  whenever width > prev(width)
  then for 1 s closed
"""
SAMPLES = [
    (0, {"closed": True}),
    (1, {"knock": {"force": 0.5}, "width": 0.7}),
    (2, {"width": float("nan"), "knock": True}),
    (3, {"width": 0.75, "knock": {"force": 1.0}}),
    (8, {"closed": None}),
    (9, {"closed": False, "width": 2.0}),
]


def opened(spec, samples):
    """The document in the snapshot of a run, and a function that makes snapshots of others."""
    monitor = spec.monitor()
    for t, values in samples:
        monitor.step(t, values)
    head, _, body = monitor.snapshot().partition(b"\n")

    def sealed(document):
        text = json.dumps(document, separators=(",", ":")).encode()
        seal = hashlib.sha256(text).hexdigest().encode()
        return head.rpartition(b" ")[0] + b" " + seal + b"\n" + text

    return json.loads(body), sealed


def test_another_specification_is_refused():
    monitor = rvmon.loads(TEXT).monitor()
    monitor.step(0, {"closed": True})
    data = monitor.snapshot()
    with pytest.raises(SnapshotError, match="another specification"):
        rvmon.loads(TEXT.replace("2 s", "3 s")).restore(data)
    assert rvmon.loads(f"# the front door\n{TEXT}\n").restore(data).snapshot() == data
    for wrong in (b"", b"PK\x03\x04", data[:-1], data + b" ", data.replace(b"settle", b"sattle")):
        with pytest.raises(SnapshotError, match=r"not a snapshot|damaged"):
            rvmon.loads(TEXT).restore(wrong)
    monitor.finish()
    with pytest.raises(SnapshotError, match="finished"):
        monitor.snapshot()


def test_forged_bytes_are_refused():
    """Also an instant of an interrupted step that is not a whole number of ticks."""
    spec = rvmon.loads(TEXT)
    document, sealed = opened(spec, SAMPLES[:5])
    instants = (float("inf"), float("nan"), 1.5, "x", 2**62)
    forged = [
        {"state": ["object", "os", "system"]},
        {"state": {}},
        *({"state": {**document["state"], "interrupted": one}} for one in instants),
        {"core": document["core"][:-8]},
        {"core": ""},
        {"arrivals": "AAAA"},
        {"plan": "0"},
        {"sources": [["closed"]]},
        {"settle": "next"},
    ]
    for one in forged:
        with pytest.raises(SnapshotError):
            spec.restore(sealed({**document, **one}))
    del document["only"]
    with pytest.raises(SnapshotError):
        spec.restore(sealed(document))


def places_in(value, path=()):
    """The paths to all values of a document."""
    found = list(enumerate(value)) if isinstance(value, list) else []
    found += list(value.items()) if isinstance(value, dict) else []
    for key, one in found:
        yield (*path, key)
        yield from places_in(one, (*path, key))


@pytest.mark.slow
def test_most_hostile_snapshots_are_refused_at_once():
    spec = rvmon.loads(TEXT)
    document, sealed = opened(spec, SAMPLES[:5])
    places = list(places_in(document))
    for seed in range(150):
        rng = random.Random(seed)
        hostile, path = copy.deepcopy(document), rng.choice(places)
        inner = hostile
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = rng.choice([None, True, -1, 1.5, "x", [], ["dict"], ["same", 0], {}])
        try:
            restored = spec.restore(sealed(hostile))
            _ = restored.open, restored.next_due, restored.verdicts
            restored.snapshot()
            restored.finish()
        except RvmonError:
            continue


def test_a_run_interrupted_in_its_first_step_is_restored():
    """An interrupt before the first sample has no instant."""
    spec = rvmon.loads(TEXT)
    monitor = spec.monitor()

    class Torn(BaseException):
        pass

    def tear(*_):
        raise Torn

    monitor._feed.take = tear
    t, values = SAMPLES[0]
    with pytest.raises(Torn):
        monitor.step(t, MappingProxyType(values))
    report = spec.restore(monitor.snapshot()).finish()
    assert {*report.verdicts.values()} == {"I"}
    assert ("interrupted", None) in {(one.kind.value, one.first) for one in report.health}


@pytest.mark.parametrize("changing", [63, 64, 65, 128])
def test_a_run_continues_however_many_letters_its_reasons_need(changing):
    """Letters are stored in pieces; the last piece may be full or empty."""
    spec = rvmon.loads(
        "time sampled every 500 ms\nsignal x, y : real\nevent e\nrequirement R\n  upon e\n"
        "  then F[1 s, 3 s] ((x > 2) U[2 s, 4 s] (y < 4))\n"
    )
    plain, taken_up = spec.monitor(), spec.monitor()
    for place in range(changing + 20):
        value = float(min(place, changing) % 2)
        sample = {"x": 3 * value, "y": 5 * value, "e": True}
        plain.step(place / 2, sample)
        taken_up.step(place / 2, sample)
        taken_up = spec.restore(taken_up.snapshot())
    assert taken_up.finish().to_json() == plain.finish().to_json()
