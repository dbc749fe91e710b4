"""Test templates: the steps of a model's witness that concern a test, with limits on their times.

`templates_of` makes them from queries, by model checking; `choose_times` picks times within the
limits.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Mapping, Sequence
from math import floor, inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar

import msgspec

from rvmon.cdv.test import TestError
from rvmon.files import write_whole

if TYPE_CHECKING:
    from rvmon.models.network import Edge as NetworkEdge
    from rvmon.models.network import Network
    from rvmon.models.runs import Run


Action = TypeVar("Action")
"""An action of a test at an instant; each type of test has its own."""

PolicyName = Literal["shortest", "fastest", "likely"]
"""How a witness is chosen among several."""


class Wait(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The time between two instants, in units of the model; `at_most=None` is unbounded."""

    at_least: int
    at_most: int | None = None


class TemplateStep(
    msgspec.Struct, Generic[Action], frozen=True, forbid_unknown_fields=True, omit_defaults=True
):
    """A step of a witness in which an automaton controlled by the test takes an edge."""

    does: str  # the edge, as text
    wait: Wait  # since the previous step, or since the start
    action: Action | None = None  # the action of the test; `None` if the step only limits times


class Limit(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A limit on the time between two steps that are not consecutive; step 0 is the start.

    Limits that follow from others in between are left out.
    """

    first: int
    last: int
    wait: Wait


class Template(
    msgspec.Struct, Generic[Action], frozen=True, forbid_unknown_fields=True, omit_defaults=True
):
    """A witness of a query, projected to the automata that a test controls."""

    name: str  # the query's id
    remark: str  # the query in words
    query: str  # its text
    policy: PolicyName  # how the witness was chosen
    unit_s: float  # seconds per unit of time
    steps: tuple[TemplateStep[Action], ...]  # in order
    limits: tuple[Limit, ...] = ()  # in addition to the waits of the steps


def load_template(path: str | Path, action: Any) -> Template[Any]:
    """Read a template.

    Raises:
        TestError: the file cannot be read, or does not hold a template.
    """
    try:
        return msgspec.json.decode(Path(path).read_bytes(), type=Template[action])
    except OSError as error:
        raise TestError(f"{path}: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise TestError(f"{path}: not a test template: {error}") from None


def save_template(template: Template[Any], folder: str | Path) -> Path:
    """Write a template to `folder/<name>.json` and return that path."""
    path = Path(folder) / f"{template.name}.json"
    write_whole(path, msgspec.json.format(msgspec.json.encode(template), indent=2) + b"\n")
    return path


def choose_times(template: Template[Any], rng: random.Random, patience: int) -> list[int]:
    """Draw instants for all steps, in units since the start; the first is the start itself.

    The instants are drawn in order, each within the limits that the earlier ones leave. A wait is
    at most `patience` units longer than necessary.

    Raises:
        TestError: the limits contradict each other.
    """
    import numpy as np  # here, as most campaigns do not need it

    from rvmon.models.runs import close

    size = len(template.steps) + 1
    # A difference bound matrix: `most[i, j]` is the most time from step i to step j.
    most = np.where(np.eye(size, dtype=bool), 0.0, inf)
    neighbours = [
        Limit(last - 1, last, step.wait) for last, step in enumerate(template.steps, start=1)
    ]
    for limit in (*neighbours, *template.limits):
        first, last, wait = limit.first, limit.last, limit.wait
        most[last, first] = min(most[last, first], -wait.at_least)
        if wait.at_most is not None:
            most[first, last] = min(most[first, last], wait.at_most)
    close(most)
    if (most.diagonal() < 0).any():
        raise TestError(f"template {template.name}: no times satisfy all of its limits")
    times = [0]
    # As the matrix is closed, no choice within these limits can leave a later step without a time.
    for step in range(1, size):
        low = max(times - most[step, :step])
        high = min(times + most[:step, step])
        times.append(rng.randint(int(low), int(min(high, low + patience))))
    return times


Edge = tuple[str, str, str] | tuple[str, str, str, str]
"""An edge of a network: automaton, source location, target location. If this is ambiguous, the
fourth entry is the label of the edge, or its channel if it has no label."""


def templates_of(
    network: Network,
    queries: Collection[str],
    automata: Collection[str],
    actions: Mapping[Edge, Action],
    policy: PolicyName,
) -> tuple[Template[Action], ...]:
    """Make templates from the witnesses of a model's queries.

    Args:
        network: the model.
        queries: ids of the queries.
        automata: names of the automata that tests control, such as people and sensors.
        actions: the action of a test for each edge of these automata; other edges need no action.
        policy: how a witness is chosen.

    Raises:
        TestError: a query has no witness, or see `project`.
    """
    from rvmon.models.search.budget import Policy
    from rvmon.models.search.verify import verify

    found = []
    for query in network.queries:
        if query.id in queries:
            run = verify(network, query, policy=Policy(policy)).run
            if run is None:
                raise TestError(f"the model has no run that shows {query.id}")
            steps, limits = project(network, run, automata, actions)
            unit_s = (network.unit or 0) / 1e9
            text = " ".join(query.text.split())
            found.append(Template(query.id, query.remark, text, policy, unit_s, steps, limits))
    return tuple(found)


def project(
    network: Network, run: Run, automata: Collection[str], actions: Mapping[Edge, Action]
) -> tuple[tuple[TemplateStep[Action], ...], tuple[Limit, ...]]:
    """The steps of a run in which some automata take part, with all limits between their instants.

    The limits are exact: they are the difference constraints of the run, closed and restricted to
    those instants.

    Raises:
        TestError: `actions` names an edge that does not exist, or that is ambiguous.
    """
    does = _actions_by_edge(network, actions)
    timing = run.timing
    assert timing is not None, "the model checker knows the timing of its runs"
    instants, texts, taken = [0], [""], list[Action | None]([None])
    for number, step in enumerate(run.steps, start=1):
        for index, edge in [] if step.action is None else step.action.edges:
            automaton = network.automata[index]
            if automaton.name not in automata:
                continue
            source, target = (automaton.locations[i].name for i in (edge.source, edge.target))
            instants.append(number)
            texts.append(f"{automaton.name}: {source} → {target}")
            taken.append(does.get((index, edge)))
    # A test acts at whole units, so fractional limits are rounded inwards.
    within = [
        [floor(bound / timing.scale) if bound < inf else inf for bound in row]
        for row in timing.relation(instants).tolist()
    ]
    steps = tuple(
        TemplateStep(texts[now], _wait_between(within, now - 1, now), taken[now])
        for now in range(1, len(instants))
    )
    limits = tuple(
        Limit(first, last, wait)
        for first in range(len(instants))
        for last in range(first + 2, len(instants))
        if (wait := _wait_between(within, first, last)) != Wait(0)
    )
    return steps, limits


def _actions_by_edge(
    network: Network, actions: Mapping[Edge, Action]
) -> dict[tuple[int, NetworkEdge], Action]:
    """The action for each edge that has one, by the index of its automaton and the edge."""
    found: dict[tuple[int, NetworkEdge], Action] = {}
    for name, action in actions.items():
        matches = {
            (place, edge): full
            for place, automaton in enumerate(network.automata)
            for edge in automaton.edges
            if name in ((full := _name_of(network, place, edge))[:3], full)
        }
        if not matches:
            raise TestError(f"actions of a model: it has no edge {name}")
        if len(several := dict.fromkeys(matches.values())) > 1:
            listed = ", ".join(map(str, several))
            raise TestError(f"actions of a model: it has several edges {name}: name each: {listed}")
        found |= dict.fromkeys(matches, action)
    return found


def _name_of(network: Network, place: int, edge: NetworkEdge) -> tuple[str, str, str, str]:
    automaton = network.automata[place]
    source, target = (automaton.locations[i].name for i in (edge.source, edge.target))
    channel = "" if edge.sync is None else network.channels[edge.sync.slot.first].name
    return automaton.name, source, target, edge.label or channel


def _wait_between(within: Sequence[Sequence[float]], first: int, last: int) -> Wait:
    """The limits between two instants, without those implied by an instant in between."""
    middle = range(first + 1, last)
    low, high = -within[last][first], within[first][last]
    if any(-within[k][first] - within[last][k] == low for k in middle):
        low = 0
    if any(within[first][k] + within[k][last] == high for k in middle):
        high = inf
    return Wait(int(low), None if high == inf else int(high))
