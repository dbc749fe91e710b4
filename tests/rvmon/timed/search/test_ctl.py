"""Formulas of CTL have the answers that plain fixpoints on the region graph give."""

from random import Random

import pytest
from tests.tools.timed_ctl import holds_at_start, random_formulas
from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import TooManyRegionsError

from rvmon.timed.language.elaborate import query_on
from rvmon.timed.language.load import loads_network
from rvmon.timed.search.verify import verify

pytestmark = pytest.mark.law


@pytest.mark.parametrize("first", range(0, 10, 5))
def test_answers_agree(first):
    """Until, next, bounds, deadlock and nests of up to three operators on random networks."""
    compared = 0
    for seed in range(first, first + 5):
        network = loads_network(random_model(seed))
        states = [f"({query.text.partition(' ')[2]})" for query in network.queries[:4]]
        for text in random_formulas(Random(seed), [*states, "deadlock"], 6):
            query = query_on(network, text)
            try:
                expected = holds_at_start(network, query, limit=300)
            except TooManyRegionsError:
                continue
            compared += 1
            assert verify(network, query).holds == expected, (seed, text)
    assert compared > 20
