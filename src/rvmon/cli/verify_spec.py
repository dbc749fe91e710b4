"""`rvmon verify MODEL --spec SPEC`: requirements on all runs of a network."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from rvmon.cli.say import say, say_json
from rvmon.errors import RvmonError, UnknownNameError

if TYPE_CHECKING:
    from rvmon.session import Spec
    from rvmon.timed.model.network import Network
    from rvmon.timed.observation.outcome import Observation
    from rvmon.timed.runs.run import Run
    from rvmon.timed.search.problem import Budget, Watch


def check_spec(
    network: Network, arguments: argparse.Namespace, budget: Budget, watch: Watch | None
) -> int:
    """Decide, show, and return the exit code."""
    from rvmon.loading import load
    from rvmon.timed.describe import observation_data
    from rvmon.timed.observation.observe import observe

    spec = load(arguments.spec)
    bindings = dict(_binding(text) for text in arguments.bind)
    for name in bindings.keys() - spec.checked.signals.keys():
        known = ", ".join(spec.checked.signals) or "none"
        raise UnknownNameError(f"--bind {name}: no signal of that name is declared: {known}")
    observations = []
    for one in observe(network, spec.checked, bindings=bindings, budget=budget, watch=watch):
        observations.append(one)
        if arguments.format == "text":
            _print_observation(one, spec)
    if arguments.format == "json":
        say_json(
            json.dumps({"requirements": [observation_data(o) for o in observations]}, indent=2)
        )
    return int(any(not one.holds for one in observations))


def _binding(text: str) -> tuple[str, str]:
    name, _, value = text.partition("=")
    if not name.strip() or not value.strip():
        raise RvmonError(f"--bind {text}: expected NAME=EXPRESSION, such as 'open=Door.open'")
    return name.strip(), value.strip()


def _print_observation(one: Observation, spec: Spec) -> None:
    from rvmon.timed.describe import run_lines
    from rvmon.timed.observation.observe import UNDECIDED_IN_THE_END

    word = {True: "holds on all runs", False: "fails on some run", None: ""}[one.holds]
    if one.remark == UNDECIDED_IN_THE_END:
        word = "holds on all finite runs"
    say(f"{one.requirement}: {'; '.join(filter(None, (word, one.remark)))}")
    if one.text:
        say(f'    "{one.text}"')
    say(f"    {one.statistics.visited:,} states, {one.statistics.seconds:.2f} s")
    named = (("triggered", one.triggered), ("passes", one.passing), ("fails", one.failing))
    for name, shown in named:
        if shown is None:
            continue
        say(f"    {name}:")
        for line in run_lines(one.network, shown):
            say(f"      {line}")
        if name != "triggered":
            for line in _timeline(one, shown, spec):
                say(f"      {line}")
    say(flush=True)


def _timeline(one: Observation, shown: Run, spec: Spec) -> list[str]:
    """What the requirement reads along a run, judged by the monitor that judges recordings."""
    from rvmon.explain.example import Example
    from rvmon.report.explain_text import picture_of
    from rvmon.report.tracks import concerned_names
    from rvmon.timed.conformance.recordings import recording_of
    from rvmon.timed.observation.observe import signals_of
    from rvmon.trace.sample import Sample
    from rvmon.trace.schema import Kind

    names = concerned_names(spec.requirements[one.requirement])
    declared = spec.checked.signals
    truths = {name for name, signal in declared.items() if signal.type.kind is Kind.BOOL}
    signals = {name: read for name, read in signals_of(one.network).items() if name in declared}
    recorded, end = recording_of(one.network, shown, signals)
    samples: list[Sample] = []
    last: dict[str, object] = {}
    for sample in recorded:
        values = {
            name: bool(value) if name in truths else value
            for name, value in sample.values.items()
            if name in names and (name not in signals or last.get(name) != value)
        }
        last.update(values)
        if values or not samples:
            samples.append(Sample(sample.t, values))
    monitor = spec.monitor(only=[one.requirement])
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    if shown.steps and shown.steps[-1].action is None:
        end += 1  # what only time decides is decided a tick after its window
    monitor.advance_ns(end + 1)
    report = monitor.finish_ns(end)
    example = Example(
        tuple(samples), end, {one.requirement: report.verdicts[one.requirement]},
        tuple(report.attempts),
    )  # fmt: skip
    return [line.plain for line in picture_of(example, spec.checked, names)]
