"""The model checker agrees with the region graph, which shares no code with its search."""

import pytest
from tests.rvmon.models.search.timed_ctl import holds_at_start
from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import Steps, TooManyRegionsError, shows

from rvmon.models.language.load import loads_network
from rvmon.models.search.budget import Policy
from rvmon.models.search.verify import verify

pytestmark = pytest.mark.law


@pytest.mark.parametrize("first", range(0, 30, 6))
def test_random_answers_agree_with_the_region_graph(first):
    for seed in range(first, first + 6):
        network, steps = loads_network(random_model(seed)), Steps()
        for query in network.queries:
            outcome = verify(network, query, policy=tuple(Policy)[seed % 3])
            assert outcome.run is None or shows(network, outcome), (seed, query.text)
            try:
                expected = holds_at_start(network, query, 400, steps)
            except TooManyRegionsError:
                continue
            assert outcome.holds == expected, (seed, query.text)


def test_random_models_have_all_kinds_of_parts():
    text = "".join(map(random_model, range(100)))
    for part in ("urgent chan", "broadcast chan", "committed location", "urgent location",
                 "invariant x < ", "== ", " > ", "= 1", "v = ", "b = "):  # fmt: skip
        assert part in text


@pytest.mark.parametrize(
    ("seed", "query"),
    [
        (730, 7),  # `right` holds just after the bound: the run left the segment before its end
        (1163, 5),
        (2995, 8),  # two strict bounds were taken for tighter than one
        (3108, 9),
        (4929, 8),
    ],
)
def test_answers_that_once_were_wrong(seed, query):
    network = loads_network(random_model(seed))
    asked = network.queries[query]
    outcome = verify(network, asked)
    assert outcome.holds == holds_at_start(network, asked)
    assert outcome.run is None or shows(network, outcome)
