"""Runs and results of queries as text, and as plain data for JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from fractions import Fraction
from typing import Any

from rvmon.models.network import Network, Query, Simulation
from rvmon.models.network.expressions import Variable
from rvmon.models.network.fractions import number_of
from rvmon.models.requirement_check import Observation
from rvmon.models.runs import Action, Ending, Position, Run, RunStep, Window
from rvmon.models.runs.statistics import ERROR, Sampled, Trajectory
from rvmon.models.search.budget import Outcome
from rvmon.models.search.extremes import Extreme
from rvmon.models.search.suite import Suite, item_text
from rvmon.trace.time import TICKS_PER_SECOND


def action_text(network: Network, action: Action | None) -> str:
    """The edges of an action, each with its automaton. The sender comes first."""
    if action is None:
        return "(time passes)"
    return ", ".join(f"{network.automata[a].name}: {edge.text}" for a, edge in action.edges)


def location_text(network: Network, position: Position) -> str:
    """The location of each automaton."""
    return ", ".join(
        f"{automaton.name}.{automaton.locations[place].name}"
        for automaton, place in zip(network.automata, position.locations, strict=True)
    )


def change_text(network: Network, before: Position, after: Position) -> str:
    """The variables that changed, with their new values."""
    return ", ".join(
        f"{variable.name} = {value_text(variable, new)}"
        for variable, old, new in zip(network.variables, before.values, after.values, strict=True)
        if old != new
    )


def value_text(variable: Variable, value: int) -> str:
    """A value as the model's language writes it."""
    return json.dumps(_number(variable, value))


def _number(variable: Variable, value: int) -> float:
    if variable.is_real:
        return number_of(value)
    return bool(value) if variable.is_bool else value


def time_text(network: Network, units: Fraction | int) -> str:
    """A time in seconds if the model has a unit, else as a number of units."""
    if network.unit is None:
        return f"{float(units):g}"
    return f"{float(Fraction(units) * network.unit / TICKS_PER_SECOND):g} s"


def window_text(network: Network, window: Window) -> str:
    """A range of durations, in seconds if the model has a unit of time."""
    left, right = "(" if window.low_strict else "[", ")" if window.high_strict else "]"
    if window.high is None:
        return f"{left}{time_text(network, window.low)}, ∞)"
    return f"{left}{time_text(network, window.low)}, {time_text(network, window.high)}{right}"


def run_lines(network: Network, run: Run) -> Iterator[str]:
    """A run as lines: the instant, the action, the window of the wait before it, the changes."""
    now, before = Fraction(0), run.start
    yield f"{time_text(network, 0):>9}  start in {location_text(network, run.start)}"
    for number, step in enumerate(run.steps):
        if number == run.loop:
            yield f"{'':>9}  from here on, forever:"
        now += step.delay
        if step.action is None and step.window.high == 0 and number + 1 < len(run.steps):
            continue  # this instant only serves the query, and shows no change
        text = f"{time_text(network, now):>9}  {action_text(network, step.action)}"
        if step.window.low or step.window.high != 0:
            text += f"   (after {window_text(network, step.window)})"
        changed = change_text(network, before, step.position)
        yield text + (f"   {changed}" if changed else "")
        before = step.position
    if run.ending is not Ending.REACHED:
        yield f"{'':>9}  {_ENDINGS[run.ending]}"


_ENDINGS = {
    Ending.DEADLOCK: "no edge can be taken any more",
    Ending.TIME_LOCK: "time stops here: no edge can be taken, and time may not pass",
    Ending.IDLE: "it may stay here forever",
    Ending.LOOP: "and round again",
    Ending.ZENO_LOOP: "and again, although time does not advance (a Zeno loop)",
}


def position_data(network: Network, position: Position) -> dict[str, Any]:
    """A position of a run for JSON: locations by automaton, values by variable."""
    return {
        "locations": {
            automaton.name: automaton.locations[place].name
            for automaton, place in zip(network.automata, position.locations, strict=True)
        },
        "variables": {
            variable.name: _number(variable, value)
            for variable, value in zip(network.variables, position.values, strict=True)
        },
    }


def step_data(network: Network, step: RunStep) -> dict[str, Any]:
    """A step: `delay` in units of the model, its `window`, `edge`, and the `state` after it."""
    return {
        "delay": float(step.delay),
        "window": asdict(step.window),
        "edge": None if step.action is None else action_text(network, step.action),
        "state": position_data(network, step.position),
    }


def run_data(network: Network, run: Run | None) -> list[dict[str, Any]] | None:
    """The steps of a run as plain data."""
    return None if run is None else [step_data(network, step) for step in run.steps]


def observation_data(observation: Observation) -> dict[str, Any]:
    """The result of a requirement on all runs as plain data."""
    network = observation.network
    return {
        "requirement": observation.requirement, "holds": observation.holds,
        "remark": observation.remark, "triggered": run_data(network, observation.triggered),
        "passing": run_data(network, observation.passing),
        "failing": run_data(network, observation.failing), "states": observation.statistics.visited,
        "seconds": round(observation.statistics.seconds, 6),
    }  # fmt: skip


def suite_data(network: Network, suite: Suite) -> dict[str, Any]:
    """A suite as plain data."""
    criterion = suite.criterion
    return {
        "criterion": str(criterion),
        "runs": [
            {
                "trace": run_data(network, run),
                "items": [item_text(network, item, criterion) for item in items],
            }
            for run, items in suite.runs
        ],
        "missing": [item_text(network, item, criterion) for item in suite.missing],
        "remark": suite.stopped,
    }


def sampled_data(sampled: Sampled) -> dict[str, Any]:
    """The result of a sampled query as plain data."""
    data = {
        "query": sampled.query.text,
        "id": sampled.query.id,
        "runs": sampled.runs,
        "value": sampled.value,
    }
    if sampled.margin is not None:
        return {**data, "holds": sampled.holds, "error": ERROR, "margin": sampled.margin}
    return {**data, "low": sampled.low, "high": sampled.high, "confidence": 1 - ERROR}


def trajectory_lines(network: Network, query: Query, trajectory: Trajectory) -> Iterator[str]:
    """A simulated run as lines: instants with the values that changed."""
    assert isinstance(query.formula, Simulation), "runs are of such queries"
    before: tuple[Fraction | None, ...] = (None,) * len(query.formula.terms)
    for now, row in zip(trajectory.times, trajectory.values, strict=True):
        changed = [
            f"{term.text} = {float(value):g}"
            for term, value, old in zip(query.formula.terms, row, before, strict=True)
            if value != old
        ]
        if changed or now == trajectory.times[-1]:
            yield f"{time_text(network, now):>9}  {', '.join(changed)}".rstrip()
        before = row


def simulation_data(query: Query, found: Sequence[Trajectory]) -> dict[str, Any]:
    """Simulated runs as plain data, times in units of the model."""
    assert isinstance(query.formula, Simulation), "runs are of such queries"
    terms = [term.text for term in query.formula.terms]
    runs = [
        {"times": [float(t) for t in trajectory.times]}
        | {
            term: [float(value) for value in values]
            for term, values in zip(terms, zip(*trajectory.values, strict=True), strict=True)
        }
        for trajectory in found
    ]
    return {"query": query.text, "id": query.id, "runs": runs}


def extreme_text(extreme: Extreme) -> str:
    """An extreme value of a term as text."""
    term, value, largest = extreme.term, extreme.value, extreme.largest
    if value is None:
        return f"{term}: {extreme.remark}"
    if not extreme.exact:
        side = "above" if largest else "below"
        why = extreme.remark or "no bound was found up to there"
        return f"{term} reaches {value:,}, perhaps {side} it ({why})"
    if not extreme.attained:
        side = "below" if largest else "above"
        return f"{term} stays {side} {value:,}, but comes arbitrarily close to it"
    return f"{term} is at {'most' if largest else 'least'} {value:,}"


def extreme_data(network: Network, extreme: Extreme) -> dict[str, Any]:
    """An extreme value of a term as plain data."""
    return {
        "id": extreme.query.id, "query": extreme.query.text, "term": extreme.term,
        "end": "sup" if extreme.largest else "inf", "value": extreme.value,
        "attained": extreme.attained, "exact": extreme.exact, "remark": extreme.remark,
        "trace": run_data(network, extreme.run), "states": extreme.statistics.visited,
        "seconds": round(extreme.statistics.seconds, 6),
    }  # fmt: skip


def outcome_data(network: Network, outcome: Outcome) -> dict[str, Any]:
    """The answer to a query as plain data; `trace` is `None` if there is no run to show."""
    run = outcome.run
    return {
        "id": outcome.query.id, "query": outcome.query.text, "holds": outcome.holds,
        "remark": outcome.remark, "policy": None if outcome.policy is None else str(outcome.policy),
        "start": None if run is None else position_data(network, run.start),
        "trace": run_data(network, run), "ending": None if run is None else str(run.ending),
        "loop": None if run is None else run.loop, "states": outcome.statistics.visited,
        "stored": outcome.statistics.stored, "seconds": round(outcome.statistics.seconds, 6),
    }  # fmt: skip
