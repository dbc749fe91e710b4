"""Runs in equal situations continue equally."""

import random

import pytest

from rvmon.analysis.representative_inputs import SILENT
from rvmon.analysis.shortest_examples import Player, _choices
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import show_spec
from rvmon.trace.sample import Sample

pytestmark = pytest.mark.law


def drawn(rng, valuations, start, count):
    """Samples from an instant on that give every name a value."""
    t, made = start, []
    for _ in range(count):
        made.append(Sample(t, dict(rng.choice(valuations))))
        t += rng.randint(1, 5)
    return made, t - 1


def behind(example, end):
    """The outcomes of attempts after an instant, relative to it."""
    began = [
        (one.triggered - end, one.decided and one.decided - end, one.verdict)
        for one in example.attempts
        if one.triggered > end
    ]
    decided = {
        (one.decided - end, one.verdict)
        for one in example.attempts
        if one.decided is not None and one.decided > end and not one.in_doubt
    }
    return began, decided


@pytest.mark.law
def test_equal_situations_continue_equally():
    """Whatever follows them, with all time models, captured values and instances."""
    for seed in range(16):
        rng = random.Random(seed)
        pairs = 0
        for _ in range(4):
            spec = random_spec(rng, Profile(requirements=1, depth=2))
            compiled = compile_spec(spec)
            own = [*compiled.requirements.values()]
            valuations = [
                one for one in _choices(spec, own).valuations if SILENT not in one.values()
            ]
            if not valuations:
                continue
            player = Player(compiled, own)
            gap = spec.period or 1
            known = {}
            for _ in range(60):
                samples, last = drawn(rng, valuations, gap * rng.randint(0, 3), rng.randint(1, 3))
                end = last + rng.randint(0, 3)
                found = player.play(samples, end)
                known.setdefault(found.situation, []).append((samples, end, found.cut))
            for same in known.values():
                (first, first_end, cut), *others = same
                for second, second_end, other_cut in others[:3]:
                    assert (cut - first_end) == (other_cut - second_end) or cut == other_cut
                    further, _ = drawn(rng, valuations, rng.randint(1, 4), rng.randint(1, 3))
                    wait = rng.randint(0, 6)
                    ends = []
                    for samples, end in ((first, first_end), (second, second_end)):
                        rest = [Sample(end + one.t, one.values) for one in further]
                        played = player.play([*samples, *rest], rest[-1].t + wait)
                        ends.append(behind(played.example, end))
                    assert ends[0] == ends[1], (show_spec(spec), first, second, further, wait)
                    pairs += 1
        assert pairs
