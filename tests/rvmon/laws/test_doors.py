"""Green means green at the doors: what one loses is filled in, and overturns no verdict of it."""

import json
import random
from dataclasses import replace

import pytest
from tests.tools.differential import case_of
from tests.tools.law import judge
from tests.tools.sound import is_spoken_of

from rvmon.adapters.json_lines import feed_lines
from rvmon.adapters.json_objects import JsonObjects
from rvmon.errors import TraceError
from rvmon.live import Driver, DurableMonitor, SimulatedClock
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.trace.sample import Sample
from rvmon.verdict.verdict import Verdict

pytestmark = pytest.mark.law
RUNS, FILLINGS = 100, 6
GREEN = (Verdict.PASS, Verdict.NOT_TRIGGERED)


def line_of(sample):
    """A sample as JSON has it."""
    values = {n: [*v] if isinstance(v, tuple) else v for n, v in sample.values.items()}
    return json.dumps({"t_ns": sample.t, **values}).encode()


def damaged(rng, line):
    """A line of which nobody can say what it held."""
    half = line[: rng.randrange(1, len(line) - 1)]
    large = line.replace(b": ", b': 1e400, "t_ns": ', 1)
    return rng.choice([half, line[:-1] + b',"t_ns":1}', large, b"\xff"])


def by_lines(rng, spec, case, lost):
    """Lines of a pipe, some of them damaged."""
    clock = SimulatedClock(case.samples[0].t)
    driver = Driver(spec, clock=clock, sources=case.names)
    objects = JsonObjects(driver, spec.schema, clock=clock)
    whole = [line_of(one) for one in case.samples]
    lines = [damaged(rng, one) if n in lost else one for n, one in enumerate(whole)]
    feed_lines(objects, lines)
    return closed(driver, clock, case)


def by_connection(rng, spec, case, lost):
    """A connection that is down while some samples are sent."""
    clock = SimulatedClock(case.samples[0].t)
    driver = Driver(spec, clock=clock, sources=case.names)
    first, last = min(lost), max(lost)
    for number, sample in enumerate(case.samples):
        clock.set_ns(sample.t)
        if number == first:
            driver.lose(None if rng.random() < 0.5 else sorted(names_of(case, lost)), robot="")
        if not first <= number <= last:
            driver.offer(sample.values, t_ns=sample.t)
        elif number == last:
            driver.found()
        if rng.random() < 0.3:
            driver.work()
    return closed(driver, clock, case)


def by_order(rng, spec, case, lost):
    """Samples that come behind later ones; what is late is not judged."""
    clock = SimulatedClock(case.samples[0].t)
    driver = Driver(spec, clock=clock, sources=case.names)
    late = [case.samples[number] for number in lost]
    for number, sample in enumerate(case.samples):
        clock.set_ns(sample.t)
        if number not in lost:
            driver.offer(sample.values, t_ns=sample.t)
        driver.work()
    for sample in late:
        driver.offer(sample.values, t_ns=sample.t)
    return closed(driver, clock, case)


def by_flood(rng, spec, case, lost):
    """More samples than there is room for."""
    clock = SimulatedClock(case.samples[0].t)
    driver = Driver(spec, clock=clock, sources=case.names, room=len(case.samples) - len(lost))
    for number in [n for n in range(len(case.samples)) if n not in lost]:
        sample = case.samples[number]
        clock.set_ns(sample.t)
        driver.offer(sample.values, t_ns=sample.t)
        follows = number + 1
        while follows in lost:  # each is offered while the queue is full
            room, driver._waiting.room = driver._waiting.room, 0
            driver.offer(case.samples[follows].values, t_ns=case.samples[follows].t)
            driver._waiting.room = room
            follows += 1
        if rng.random() < 0.3:
            driver.work()
    return closed(driver, clock, case)


def by_journal(rng, spec, case, lost, folder):
    """A run that is killed at any point, of which some samples could not be read."""

    def begun():
        return DurableMonitor(
            spec, folder / "run", lambda *_: None, sources=case.names, settle="next"
        )

    monitor = begun()
    for number, sample in enumerate(case.samples):
        if rng.random() < 0.2:
            monitor = begun()
        if number in lost and rng.random() < 0.5:
            monitor.miss()
        elif number in lost:
            with pytest.raises(TraceError):
                monitor.step_ns(sample.t, {**sample.values, "no such name": 1})
        else:
            monitor.step_ns(sample.t, dict(sample.values))
    end = case.samples[-1].t + 1
    monitor.advance_ns(end)
    return monitor.monitor.finish_ns().verdicts


def closed(driver, clock, case):
    """The verdicts when all was offered."""
    clock.set_ns(max(clock.now_ns(), case.samples[-1].t) + 1)
    return driver.close()[""][-1].verdicts


def names_of(case, lost):
    """What the lost samples spoke of."""
    return {name for number in lost for name in case.samples[number].values}


def filled(rng, case, lost, *, really):
    """The verdicts if the lost samples said what they did, or something else."""
    samples = list(case.samples)
    names = names_of(case, lost)
    for number in [] if really else lost:
        other = rng.choice(random_trace(rng, case.spec, TraceProfile()).samples or samples)
        values = {name: value for name, value in other.values.items() if name in names}
        samples[number] = Sample(samples[number].t, values)
    actions = (*samples, max(case.samples[-1].t, samples[-1].t) + 1)
    return judge(replace(case, actions=actions, end=None)).verdicts


DOORS = {
    "lines": by_lines,
    "connection": by_connection,
    "order": by_order,
    "flood": by_flood,
    "journal": by_journal,
}


@pytest.mark.parametrize("door", DOORS)
def test_no_verdict_is_overturned(door, tmp_path):
    """By what was lost, or any other in its place; late samples may take no failure back."""
    split = runs = 0
    for number in range(RUNS):
        rng = random.Random(f"{door} {number}")
        case = case_of(f"door/{door}/{number}", Profile(requirements=2), TraceProfile())
        if len(case.samples) < 3 or case.spec.max_delay or not is_spoken_of(case.spec):
            continue
        spec = Spec(case.spec)
        # Of the first and the last nobody may know that there was one.
        inner = range(1, len(case.samples) - 1)
        begin = rng.choice(inner)
        lost = {*range(begin, min(begin + rng.randint(1, 3), len(case.samples) - 1))}
        folder = tmp_path / str(number)
        folder.mkdir()
        given = (rng, spec, case, lost) + ((folder,) if door == "journal" else ())
        verdicts = DOORS[door](*given)
        runs += 1
        seen = {name: set() for name in verdicts}
        for which in range(FILLINGS):
            truly = filled(rng, case, lost, really=which == 0)
            for name, verdict in verdicts.items():
                failed = truly[name] is Verdict.FAIL
                seen[name].add(failed)
                assert not (verdict in GREEN and failed), (number, name)
                if verdict is Verdict.FAIL and door != "order":
                    assert failed, (number, name)
        split += any(len(kinds) > 1 for kinds in seen.values())
    assert runs > RUNS / 3
    assert split > runs / 20


@pytest.mark.parametrize("late", [False, True])
def test_a_file_that_is_damaged_or_out_of_order_has_the_verdicts_of_the_whole_or_none(
    late, tmp_path
):
    """A line that cannot be read is an error; under `max delay` their order does not matter."""
    path, told = tmp_path / "a.jsonl", 0
    for number in range(RUNS):
        rng = random.Random(f"file {late} {number}")
        case = case_of(f"door/file/{number}", Profile(requirements=2), TraceProfile())
        if len(case.samples) < 3:
            continue
        spec = Spec(replace(case.spec, max_delay=1 if late else None))
        lines = [line_of(one) for one in case.samples]
        path.write_bytes(b"\n".join(lines) + b"\n")
        whole = spec.evaluate(path, sources=case.names)
        if late:
            rng.shuffle(lines)
            path.write_bytes(b"\n".join(lines) + b"\n")
            assert spec.evaluate(path, sources=case.names).attempts == whole.attempts
        else:
            place = rng.randrange(len(lines))
            rest = [damaged(rng, lines[place]), *lines[place + 1 :]]
            path.write_bytes(b"\n".join([*lines[:place], *rest]) + b"\n")
            with pytest.raises(TraceError, match=f"line {place + 1}:|not UTF-8 text"):
                spec.evaluate(path, sources=case.names)
        told += 1
    assert told > RUNS / 3
