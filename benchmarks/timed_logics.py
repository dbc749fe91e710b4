"""Formulas of CTL and LTL on random networks against explicit fixpoints on the region graph.

    python -m benchmarks.timed_logics --networks 200

Prints how many formulas of each logic were compared, by answer, how many runs were shown and
replayed, of those how many only by time that stops, and disagreements, which must be none.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from random import Random

from tests.tools.timed_ctl import holds_at_start, random_formulas
from tests.tools.timed_generate import random_model
from tests.tools.timed_ltl import LinearTruth, random_linear, satisfied_by
from tests.tools.timed_regions import TooManyRegionsError

from rvmon.errors import ModelError
from rvmon.timed.language.elaborate import query_on
from rvmon.timed.language.load import loads_network
from rvmon.timed.model.expressions import UnaryOperation
from rvmon.timed.model.guards import compares_of, is_linear
from rvmon.timed.model.network import Chance, LeadsToFormula, Mean, Network
from rvmon.timed.model.operators import UnaryOp
from rvmon.timed.runs.concrete import replay
from rvmon.timed.runs.run import Ending
from rvmon.timed.search.verify import verify

FORMULAS = 6
"""Of each logic on each network."""


def main() -> int:
    """Compare, print, and return 1 if anything disagreed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--networks", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first network")
    arguments = parser.parse_args()
    counted: Counter[str] = Counter()
    for seed in range(arguments.first, arguments.first + arguments.networks):
        network = loads_network(random_model(seed), name=f"random-{seed}")
        states = [f"({query.text.partition(' ')[2]})" for query in network.queries[:4]]
        random = Random(seed)
        nested = list(random_formulas(random, [*states, "deadlock"], FORMULAS))
        linear = [random_linear(random, states, 3) for _ in range(FORMULAS)]
        for text in (*nested, *linear):
            try:
                said = _compare(network, text)
            except TooManyRegionsError:
                said = ["left out: too many regions"]
            except ModelError:
                said = ["left out: the network cannot start"]
            counted.update(said)
            if "DISAGREES" in said:
                print(f"seed {seed}: {text}", file=sys.stderr)
    for kind, count in sorted(counted.items()):
        print(f"{kind:45} {count:>8,}")
    print(f"{counted['DISAGREES']} disagreements")
    return int(counted["DISAGREES"] > 0)


def _compare(network: Network, text: str) -> list[str]:
    query = query_on(network, text)
    formula, outcome = query.formula, verify(network, query)
    if isinstance(formula, LeadsToFormula | Chance | Mean) or not is_linear(formula):
        agrees = outcome.holds == holds_at_start(network, query, 300)
        return [f"CTL, {outcome.holds}", *([] if agrees else ["DISAGREES"])]
    denied = UnaryOperation(UnaryOp.NOT, formula)
    agrees = outcome.holds != LinearTruth(network, denied, False, 3_000).some_run()
    said = [f"LTL, {outcome.holds}"]
    if outcome.run is not None:
        replay(network, outcome.run)
        said.append("LTL, runs replayed")
        if not list(compares_of(denied)):
            agrees = agrees and satisfied_by(network, outcome.run, denied)
            said.append("LTL, runs that refute the formula by its own meaning")
        stops = outcome.run.ending in (Ending.ZENO_LOOP, Ending.TIME_LOCK)
        said += ["LTL, only by time that stops"] if stops else []
        agrees = agrees and stops != LinearTruth(network, denied, True, 6_000).some_run()
    return [*said, *([] if agrees else ["DISAGREES"])]


if __name__ == "__main__":
    sys.exit(main())
