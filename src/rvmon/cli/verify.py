"""`rvmon verify`: model-check a network of timed automata."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rvmon.errors import RvmonError

if TYPE_CHECKING:
    from rvmon.timed.model import Network
    from rvmon.timed.outcome import Outcome
    from rvmon.timed.search import Watch


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "verify",
        help="model-check a network of timed automata",
        description="Decide queries on a network of timed automata (.ta, or UPPAAL's .xml), each "
        "with a timed run that shows why. Exit code 0: all hold; 1: some do not, or the budget "
        "ended first.",
        epilog="example: rvmon verify model.ta --query 'A[] not deadlock' --trace fastest",
    )
    parser.add_argument("model", metavar="MODEL", help="a .ta or .xml file")
    parser.add_argument(
        "--query", metavar="Q", action="append", help="a query or the id of one (default: all)"
    )
    parser.add_argument(
        "--trace",
        choices=("shortest", "fastest", "likely"),
        default="shortest",
        help="which run to show if several do (default: shortest)",
    )
    parser.add_argument(
        "--const", metavar="NAME=N", action="append", default=[], help="set a constant of the model"
    )
    parser.add_argument("--format", choices=("text", "json"), default="text")
    parser.add_argument("--max-states", metavar="N", type=int, help="give up after N states")
    parser.add_argument("--max-seconds", metavar="S", type=float, help="give up after S seconds")
    parser.add_argument(
        "--max-memory", metavar="MB", type=int, default=2048, help="give up beyond (default: 2048)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Decide, show, and return the exit code."""
    from rvmon.timed.load import load_network
    from rvmon.timed.outcome import Policy
    from rvmon.timed.queries import chosen_queries
    from rvmon.timed.search import Budget
    from rvmon.timed.verify import verify

    constants = dict(_constant(text) for text in arguments.const)
    network = load_network(arguments.model, constants=constants)
    _show_warnings(network)
    queries = chosen_queries(network, arguments.query)
    budget = Budget(arguments.max_states, arguments.max_seconds, arguments.max_memory)
    outcomes = []
    with _shown() as watch:
        for query in queries:
            outcome = verify(
                network, query, budget=budget, watch=watch, policy=Policy(arguments.trace)
            )
            outcomes.append(outcome)
            if arguments.format == "text":
                _print_outcome(network, outcome)
    if arguments.format == "json":
        _print_json(network, outcomes)
    return int(any(not outcome.holds for outcome in outcomes))


def _constant(text: str) -> tuple[str, int]:
    name, _, value = text.partition("=")
    if not name or not value.strip().removeprefix("-").isdecimal():
        raise RvmonError(f"--const {text}: expected NAME=NUMBER, such as N=4")
    return name.strip(), int(value)


def _show_warnings(network: Network) -> None:
    if network.warnings:
        from rvmon.diagnostics.render import render_full

        print(render_full(network.warnings), file=sys.stderr)


def _print_outcome(network: Network, outcome: Outcome) -> None:
    from rvmon.timed.describe import run_lines

    word = {True: "holds", False: "does not hold", None: "not decided"}[outcome.holds]
    name = f"{outcome.query.id}: " if outcome.query.id else ""
    statistics = outcome.statistics
    print(f"{name}{word}: {' '.join(outcome.query.text.split())}")
    if outcome.query.remark:
        print(f'    "{outcome.query.remark}"')
    print(f"    {statistics.visited:,} states, {statistics.seconds:.2f} s", end="")
    print(f"; {outcome.remark}" if outcome.remark else "")
    if outcome.run is not None:
        kind = "witness" if outcome.holds else "counterexample"
        policy = f", {outcome.policy}" if outcome.policy is not None else ""
        print(f"    {kind}{policy}:")
        for line in run_lines(network, outcome.run):
            print(f"      {line}")
    print(flush=True)


def _print_json(network: Network, outcomes: Sequence[Outcome]) -> None:
    from rvmon.timed.describe import outcome_data

    print(json.dumps({"queries": [outcome_data(network, o) for o in outcomes]}, indent=2))


@contextmanager
def _shown() -> Iterator[Watch | None]:
    """A line on a terminal's standard error that says how far a search is."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console

    with Console(stderr=True).status("starting") as status:
        yield lambda progress: status.update(
            f"{progress.visited:,} states, {progress.waiting:,} waiting, {progress.seconds:.0f} s"
        )
