"""Cases in which the model checker once was wrong, found by comparison with the region graph."""

import pytest
from tests.rvmon.models.search.timed_ctl import holds_at_start
from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import shows

from rvmon.models.language.load import loads_network
from rvmon.models.search.verify import verify

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("seed", "query"),
    [
        (730, 7),  # `right` comes just behind the bound: the run left the piece before its end
        (1163, 5),
        (2995, 8),  # a difference of two strict bounds was taken for tighter than one strict bound
        (3108, 9),
        pytest.param(4929, 8, marks=pytest.mark.slow),
    ],
)
def test_it_is_right_now(seed, query):
    network = loads_network(random_model(seed))
    asked = network.queries[query]
    outcome = verify(network, asked)
    assert outcome.holds == holds_at_start(network, asked)
    assert outcome.run is None or shows(network, outcome)
