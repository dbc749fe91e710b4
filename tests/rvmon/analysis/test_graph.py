"""Drawn automata: the conditions on their edges agree with the automaton."""

import random
import re

import pytest
from tests.tools import build

from rvmon.analysis.graph import ANY, cubes_of, graph_of
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.testing.generate.spec import Profile, random_spec

pytestmark = pytest.mark.law


@pytest.mark.parametrize("seed", range(5))
def test_cubes_cover_exactly(seed):
    rng = random.Random(seed)
    for _ in range(40):
        size = rng.randint(1, 4)
        everything = [tuple(n >> k & 1 for k in range(size)) for n in range(1 << size)]
        kinds = {vector: rng.choice(("in", "out", "never")) for vector in everything}
        wanted = [v for v, kind in kinds.items() if kind == "in"]
        never = [v for v, kind in kinds.items() if kind == "never"]
        cubes = cubes_of(wanted, never)
        for vector, kind in kinds.items():
            covered = any(
                all(own in (ANY, truth) for own, truth in zip(cube, vector, strict=True))
                for cube in cubes
            )
            assert covered is (kind == "in") or kind == "never"


def test_a_response():
    spec = build.spec_of(build.requirement(build.eventually(build.f, 0, 7), upon=build.e))
    one = compile_spec(spec).requirements["R"]
    edges = [
        (e.source, e.ages, e.condition, e.target) for e in graph_of(one, one.automaton, spec).edges
    ]
    assert sorted(edges) == [
        ("A", "x ≤ 7 ns", "f", "P"),
        ("A", "x ≤ 7 ns", "not f", "A"),
        ("A", "x ≥ 8 ns", "", "F"),
        ("start", "", "f", "P"),
        ("start", "", "not f", "A"),
    ]


def test_random_automata_are_drawn():
    rng = random.Random(3)
    drawn = 0
    for _ in range(40):
        spec = random_spec(rng, Profile(requirements=1, depth=2, mixed=False))
        one = compile_spec(spec).requirements["R1"]
        if one.automaton is None:
            continue
        graph = graph_of(one, one.automaton, spec)
        names = {place.name for place in graph.places}
        assert all({edge.source, edge.target} <= names for edge in graph.edges)
        assert all(re.fullmatch(r"start|P|F|[A-Z]|L\d+", name) for name in names)
        drawn += 1
    assert drawn > 20
