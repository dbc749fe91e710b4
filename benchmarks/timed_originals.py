"""UPPAAL models of public repositories: how many are read, and how many of their queries decided.

    python -m benchmarks.timed_originals FOLDER [--seconds 2] [--most 200]

FOLDER holds clones of the repositories of `uppaal_originals.txt`, which has a line for each
repository (its name, and the commit that was looked at) and below it one for each model: the first
16 digits of its SHA-256, and its path. A file is known by its content, wherever it lies; the models
themselves are not ours and stand in no repository of ours. Prints the models read and refused, by
reason, and the queries decided, undecided within the time, and left out.
"""

from __future__ import annotations

import argparse
import hashlib
import re
from collections import Counter
from pathlib import Path

from rvmon.errors import ModelError
from rvmon.timed.language.load import load_network
from rvmon.timed.model.network import Chance, Extremes, Mean, Network, Query
from rvmon.timed.runs.statistics import sample
from rvmon.timed.search.extremes import extremes
from rvmon.timed.search.meter import Meter
from rvmon.timed.search.outcome import Budget
from rvmon.timed.search.verify import verify

MANIFEST = Path(__file__).with_name("uppaal_originals.txt")
_WORDS = re.compile(r" \(\d+ places\)|`[^`]*`|\d+")
"""What differs between findings of one kind."""

_MODEL = re.compile(r"  ([0-9a-f]{16}) (.+)")


def known() -> dict[str, str]:
    """The path of each model of the manifest, by its hash."""
    lines = MANIFEST.read_text("utf-8").splitlines()
    return {found[1]: found[2] for line in lines if (found := _MODEL.fullmatch(line))}


def _end(network: Network, query: Query, budget: Budget) -> str:
    """What comes of a query."""
    try:
        match query.formula:
            case Chance() | Mean():
                sample(network, query, watch=Meter(budget, None).goes_on)
                return "simulated"
            case Extremes():
                exact = all(one.exact for one in extremes(network, query, budget=budget))
                return "decided" if exact else "undecided"
            case _:
                outcome = verify(network, query, budget=budget)
                return "undecided" if outcome.holds is None else "decided"
    except ModelError:
        return "refused"


def main() -> None:
    """Read, decide, count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seconds", type=float, default=2.0, help="for each query")
    parser.add_argument("--most", type=int, help="models to look at")
    arguments = parser.parse_args()
    models, seen = known(), set[str]()
    read, reasons, queries = 0, Counter[str](), Counter[str]()
    for path in sorted(arguments.folder.rglob("*.xml")):
        if not path.is_file() or (arguments.most and len(seen) >= arguments.most):
            continue
        name = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        if name not in models or name in seen:
            continue
        seen.add(name)
        try:
            network = load_network(path)
        except ModelError as error:
            reasons.update({(d.code, _WORDS.sub("", d.message)) for d in error.diagnostics})
            continue
        read += 1
        queries["left out"] += sum(warning.code == "TA020" for warning in network.warnings)
        for query in network.queries:
            queries[_end(network, query, Budget(seconds=arguments.seconds))] += 1
    print(f"{len(models)} models in the manifest, {len(seen)} found, {read} read")
    for (code, reason), count in reasons.most_common(20):
        print(f"  {count:5}  {code} {reason}")
    for end, count in queries.most_common():
        print(f"{count:6} queries {end}")


if __name__ == "__main__":
    main()
