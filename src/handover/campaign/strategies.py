"""The test generation strategies by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from handover.generator.abstract_test import AbstractTest, directed
from handover.generator.disturbed import disturbed
from handover.generator.model_based import model_based
from handover.generator.pseudorandom import constrained, pseudorandom
from rvmon.cdv import Strategy


def _directed(_count: int, _seed: int) -> Sequence[AbstractTest]:
    """The directed tests are files: all of them, always the same."""
    return directed()


STRATEGIES: Mapping[str, Strategy] = {
    "pseudorandom": pseudorandom,
    "constrained": constrained,
    "model-based": model_based,
    "model-based-shortest": partial(model_based, policy="shortest"),
    "model-based-fastest": partial(model_based, policy="fastest"),
    "disturbed": disturbed,
    "directed": _directed,
}
"""In the order of the columns of a table."""
