"""What the model says, for the page: claims about all of its runs, and runs held against it."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from handover.checker.conformance import check_run
from handover.driver import run_test
from handover.generator.abstract_test import AbstractTest
from rvmon.cdv import Test
from rvmon.cdv.presentation import RobotTest
from rvmon.execute import parallel
from rvmon.report.markup import Child, e
from rvmon.report.percent import counted
from rvmon.report.table import checked_text

if TYPE_CHECKING:
    from rvmon.timed.conformance.outcome import Conformance

SUFFIX = "_all"
"""Ends the names of queries that say of all runs what a requirement demands."""

ROBOT = "correct"
"""The robot that the model is of."""

Addresses = Mapping[RobotTest, str]
"""Of pages."""


def model_sections(
    tests: Mapping[RobotTest, Test], addresses: Addresses, count: int
) -> list[ET.Element]:
    """The section of a campaign's page, unless no run is to be held against the model.

    Args:
        tests: that were played.
        addresses: of its pages.
        count: of the runs of each strategy the first so many are held against the model.
    """
    strategies: dict[str, list[AbstractTest]] = {}
    for (robot, _), test in tests.items():
        if robot == ROBOT and test.mutation is None and isinstance(test, AbstractTest):
            strategies.setdefault(test.strategy, []).append(test)
    if not count or not strategies:
        return []
    chosen = [test for several in strategies.values() for test in several[:count]]
    jobs = os.cpu_count() or 1
    rows = list(parallel.execute(claims(), _verifier, jobs=jobs, what="query"))
    found = list(parallel.execute(chosen, _conformer, jobs=jobs, what="run"))
    lines = [
        _line([pair for pair in zip(chosen, found, strict=True) if pair[0] in several], addresses)
        for several in strategies.values()
    ]
    titles = ("", "some run shows it", "all runs keep to it", "that is")
    head = e("tr", None, *(e("th", None, title) for title in titles))
    return [
        e(
            "section",
            None,
            e("h2", None, "The model"),
            e("div", {"class": "scroll", "tabindex": 0, "role": "group"},
              e("table", {"class": "verdicts"}, e("thead", None, head), e("tbody", None, *rows))),
            e("p", {"class": "soft"}, "Runs of the correct robot held against it, of each strategy "
              f"the first {count}; when the human is ready is an input:"),
            e("ul", None, *lines),
        )
    ]  # fmt: skip


def claims() -> list[str]:
    """The names of the queries about all runs.

    >>> claims()
    ['R1_all', 'R2_all', 'R3_all', 'R4_all']
    """
    from handover.model import handover_network

    return [query.id for query in handover_network().queries if query.id.endswith(SUFFIX)]


def _verifier() -> Callable[[str], ET.Element]:
    from handover.model import handover_network
    from rvmon.timed.search.verify import verify

    network = handover_network()
    queries = {query.id: query for query in network.queries}

    def row(name: str) -> ET.Element:
        requirement = name.removesuffix(SUFFIX)
        answers = (verify(network, queries[query]).holds for query in (requirement, name))
        claim = queries[name]
        return e(
            "tr",
            None,
            e("th", {"scope": "row"}, requirement),
            *(e("td", None, checked_text(holds)) for holds in answers),
            e("td", {"class": "text", "title": claim.text}, claim.remark),
        )

    return row


def _conformer() -> Callable[[AbstractTest], Conformance]:
    from handover.model import handover_network

    network = handover_network()
    return lambda test: check_run(network, run_test(test, robot=ROBOT))


def _line(pairs: Sequence[tuple[AbstractTest, Conformance]], addresses: Addresses) -> ET.Element:
    """How many runs of a strategy conform, and where the others leave the model."""
    conforming = sum(found.conforms is True for _, found in pairs)
    text = f"{pairs[0][0].strategy}: {conforming} of {counted(len(pairs), 'run')} conform"
    parts: list[Child] = [text]
    for test, found in pairs:
        if found.conforms is not True:
            address = addresses.get((ROBOT, test.name))
            name: Child = test.name if address is None else e("a", {"href": address}, test.name)
            parts += ["; ", name, f" does not: {_where(found)}"]
    return e("li", None, *parts)


def _where(found: Conformance) -> str:
    if found.divergence is None:
        return f"not decided, {found.undecided}"
    what = f"`{found.divergence.label}`" if found.divergence.label else "nothing more"
    return f"at {found.divergence.at / 1e9:.2f} s the model has no run with {what}"
