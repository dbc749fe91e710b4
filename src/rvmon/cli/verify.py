"""`rvmon verify`: model-check a network of timed automata."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rvmon.cli.options import budget_of, model_constants_of, named_values
from rvmon.cli.output import busy, rendered, say, say_json, warn
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.models import describe
from rvmon.models.language.elaborate import chosen_queries
from rvmon.models.language.load import load_network
from rvmon.models.network import Chance, Extremes, Mean, Network, Query, Simulation
from rvmon.models.runs import Run
from rvmon.models.runs.statistics import ERROR, Sampled, sample, trajectories
from rvmon.models.search.budget import Budget, Meter, Outcome, Policy, Watch
from rvmon.models.search.extremes import Extreme, extremes
from rvmon.models.search.verify import verify
from rvmon.texts import counted

if TYPE_CHECKING:
    from rvmon.models.requirement_check import Observation
    from rvmon.session import Spec


def run_verify(arguments: argparse.Namespace) -> int:
    """Decide the queries on a model, print the answers, and return the exit code."""
    _refuse_unused(arguments)
    network = load_network(arguments.model, constants=model_constants_of(arguments.const))
    if network.warnings:
        warn(rendered(network.warnings))
    budget = budget_of(arguments)
    if arguments.spec is not None:
        with _progress_shown() as watch:
            return check_spec(network, arguments, budget, watch)
    if arguments.suite is not None:
        return _show_suite(network, arguments, budget)
    return _decide(network, arguments, budget)


def _refuse_unused(arguments: argparse.Namespace) -> None:
    by_query = not (arguments.spec or arguments.suite)
    for option, value, used, why in (
        ("--query", arguments.query, by_query, "with --spec or --suite"),
        ("--bind", arguments.bind, arguments.spec, "without --spec"),
    ):
        if value and not used:
            raise RvmonError(f"{option} does nothing {why}")


def _decide(network: Network, arguments: argparse.Namespace, budget: Budget) -> int:
    data: dict[str, list[dict[str, Any]]] = {"queries": [], "simulated": [], "extremes": []}
    in_words = arguments.format == "text"
    failed = False
    with _progress_shown() as watch:
        for extended, query in chosen_queries(network, arguments.query):
            match query.formula:
                case Chance() | Mean():
                    going = Meter(budget, watch).look
                    one = sample(extended, query, seed=arguments.seed, watch=going)
                    failed |= bool(one.margin) and not one.holds
                    data["simulated"].append(describe.sampled_data(one))
                    if in_words:
                        _print_sampled(one)
                case Simulation():
                    going = Meter(budget, watch).look
                    drawn = trajectories(extended, query, seed=arguments.seed, watch=going)
                    data["simulated"].append(describe.simulation_data(query, drawn))
                    if in_words:
                        _print_query(query, "simulated")
                        for number, run in enumerate(drawn, start=1):
                            say(f"    run {number}:")
                            for line in describe.trajectory_lines(extended, query, run):
                                say(f"      {line}")
                        say(flush=True)
                case Extremes():
                    values = list(extremes(extended, query, budget=budget, watch=watch))
                    failed |= not all(extreme.exact for extreme in values)
                    data["extremes"] += [
                        describe.extreme_data(extended, extreme) for extreme in values
                    ]
                    if in_words:
                        _print_extremes(extended, values)
                case _:
                    policy = Policy(arguments.trace)
                    outcome = verify(extended, query, budget=budget, watch=watch, policy=policy)
                    failed |= not outcome.holds
                    data["queries"].append(describe.outcome_data(extended, outcome))
                    if in_words:
                        _print_outcome(extended, outcome)
    if not in_words:
        always = {"queries": data.pop("queries")}
        others = {key: results for key, results in data.items() if results}
        say_json(json.dumps(always | others, indent=2))
    return int(failed)


def _print_query(query: Query, word: str) -> None:
    name = f"{query.id}: " if query.id else ""
    say(f"{name}{word}: {' '.join(query.text.split())}")
    if query.remark:
        say(f'    "{query.remark}"')


def _print_run(network: Network, run: Run | None, kind: str) -> None:
    if run is not None:
        say(f"    {kind}:")
        for line in describe.run_lines(network, run):
            say(f"      {line}")


def _print_outcome(network: Network, outcome: Outcome) -> None:
    word = {True: "holds", False: "does not hold", None: "not decided"}[outcome.holds]
    _print_query(outcome.query, word)
    statistics = outcome.statistics
    say(f"    {statistics.visited:,} states, {statistics.seconds:.2f} s", end="")
    say(f"; {outcome.remark}" if outcome.remark else "")
    kind = "witness" if outcome.holds else "counterexample"
    policy = f", {outcome.policy}" if outcome.policy is not None else ""
    _print_run(network, outcome.run, kind + policy)
    say(flush=True)


def _print_extremes(network: Network, values: Sequence[Extreme]) -> None:
    _print_query(
        values[0].query, "answered" if all(extreme.exact for extreme in values) else "not decided"
    )
    for extreme in values:
        statistics = extreme.statistics
        say(f"    {describe.extreme_text(extreme)}")
        say(f"    {statistics.visited:,} states, {statistics.seconds:.2f} s")
        _print_run(network, extreme.run, "there" if extreme.attained else "near it")
    say(flush=True)


def _print_sampled(sampled: Sampled) -> None:
    by = "by a statistical test"
    words = {True: f"holds, {by}", False: f"does not hold, {by}", None: "simulated"}
    word = "not decided" if sampled.margin and sampled.holds is None else words[sampled.holds]
    _print_query(sampled.query, word)
    say(f"    {sampled.value:.4f} of {sampled.runs:,} simulated runs; ", end="")
    if sampled.low is not None:
        say(f"with {100 * (1 - ERROR):g} % confidence from {sampled.low:.4f} to {sampled.high:.4f}")
    else:
        error = f"error probability {100 * ERROR:g} %"
        say(f"{error}, unless the probability is within {sampled.margin:g} of the level")
    say(flush=True)


def _show_suite(network: Network, arguments: argparse.Namespace, budget: Budget) -> int:
    from rvmon.models.search.suite import Criterion, build_suite, item_text

    criterion = Criterion(arguments.suite)
    with _progress_shown() as watch:
        suite = build_suite(network, criterion, budget=budget, watch=watch)
    if arguments.format == "json":
        say_json(json.dumps(describe.suite_data(network, suite), indent=2))
        return int(bool(suite.stopped))
    for number, (shown, items) in enumerate(suite.runs, start=1):
        say(f"run {number}, {len(items)} new:")
        for line in describe.run_lines(network, shown):
            say(f"  {line}")
    total = suite.covered + len(suite.missing)
    cover = "covers" if len(suite.runs) == 1 else "cover"
    say(f"{counted(len(suite.runs), 'run')} {cover} {suite.covered} of {total} {criterion}")
    for item in suite.missing:
        say(f"  not reached: {item_text(network, item, criterion)}")
    if suite.stopped:
        say(f"  the search was cut short: {suite.stopped}")
    return int(bool(suite.stopped))


@contextmanager
def _progress_shown() -> Iterator[Watch | None]:
    """Show the progress of a search in a line on standard error, if that is a terminal."""
    with busy("starting") as show:
        yield show and (
            lambda progress: show(
                f"{progress.visited:,} states, {progress.waiting:,} waiting, "
                f"{progress.seconds:.0f} s"
            )
        )


def check_spec(
    network: Network, arguments: argparse.Namespace, budget: Budget, watch: Watch | None
) -> int:
    """Check the requirements of `--spec` on all runs of a model; returns the exit code."""
    from rvmon.models.requirement_check import observe
    from rvmon.session import load

    spec = load(arguments.spec)
    form = "NAME=EXPRESSION, such as 'open=Door.open'"
    bindings = {name: text.strip() for name, text in named_values("--bind", arguments.bind, form)}
    for name in bindings.keys() - spec.checked.signals.keys():
        known = ", ".join(spec.checked.signals) or "none"
        raise UnknownNameError(
            f"--bind {name}: no signal of that name is declared: there are {known}"
        )
    observations = []
    for observation in observe(
        network, spec.checked, bindings=bindings, budget=budget, watch=watch
    ):
        observations.append(observation)
        if arguments.format == "text":
            _print_observation(observation, spec)
    if arguments.format == "json":
        say_json(
            json.dumps(
                {"requirements": [describe.observation_data(o) for o in observations]}, indent=2
            )
        )
    return int(any(not observation.holds for observation in observations))


def _print_observation(observation: Observation, spec: Spec) -> None:
    from rvmon.models.requirement_check import UNDECIDED_IN_THE_END

    word = {True: "holds on all runs", False: "fails on some run", None: ""}[observation.holds]
    if observation.remark == UNDECIDED_IN_THE_END:
        word = "holds on all finite runs"
    say(f"{observation.requirement}: {'; '.join(filter(None, (word, observation.remark)))}")
    if observation.text:
        say(f'    "{observation.text}"')
    say(f"    {observation.statistics.visited:,} states, {observation.statistics.seconds:.2f} s")
    named = (
        ("triggered", observation.triggered),
        ("passes", observation.passing),
        ("fails", observation.failing),
    )
    for name, shown in named:
        if shown is None:
            continue
        say(f"    {name}:")
        for line in describe.run_lines(observation.network, shown):
            say(f"      {line}")
        if name != "triggered":
            for line in _timeline(observation, shown, spec):
                say(f"      {line}")
    say(flush=True)


def _timeline(observation: Observation, shown: Run, spec: Spec) -> list[str]:
    """The timeline of a requirement along a run, judged as a recording."""
    from rvmon.analysis.example import Example
    from rvmon.models.conform import recording_of
    from rvmon.models.requirement_check import signals_of
    from rvmon.report.explain_text import picture_of
    from rvmon.report.printer import plain
    from rvmon.report.tracks import names_of_requirement
    from rvmon.trace.sample import Sample
    from rvmon.trace.schema import Kind

    names = names_of_requirement(spec.requirements[observation.requirement])
    declared = spec.checked.signals
    truths = {name for name, signal in declared.items() if signal.type.kind is Kind.BOOL}
    signals = {
        name: read for name, read in signals_of(observation.network).items() if name in declared
    }
    recorded, end = recording_of(observation.network, shown, signals)
    samples: list[Sample] = []
    last: dict[str, object] = {}
    for record in recorded:
        values = {
            name: bool(value) if name in truths else value
            for name, value in record.values.items()
            if name in names and (name not in signals or last.get(name) != value)
        }
        last.update(values)
        # The first sample marks the start of the run, even if it updates nothing.
        if values or not samples:
            samples.append(Sample(record.t, values))
    monitor = spec.monitor(only=[observation.requirement])
    for record in samples:
        monitor.step_ns(record.t, record.values)
    if shown.steps and shown.steps[-1].action is None:
        end += 1  # what time alone decides is decided one tick after its window
    monitor.advance_ns(end + 1)
    report = monitor.finish_ns(end)
    example = Example(
        tuple(samples), end, {observation.requirement: report.verdicts[observation.requirement]},
        tuple(report.attempts),
    )  # fmt: skip
    return [*map(plain, picture_of(example, spec.checked, names))]
