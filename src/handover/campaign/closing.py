"""How the handover campaign closes its holes: queries to the model, and unreachable items."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import structs

from handover.generator.model_based import ACTIONS, PROJECTED, instantiate
from handover.generator.out_of_turn import out_of_turn
from handover.model import handover_network
from rvmon.cdv.campaign import Closing, ClosingModel, Unreachable
from rvmon.cdv.close.goals import EDGES
from rvmon.coverage.requirements import AT, JUST_BEFORE

if TYPE_CHECKING:
    from handover.generator.abstract_test import AbstractTest
    from rvmon.cdv.template import Template

STATES = {
    "reset": "reset",
    "recv1": "receive_activation",
    "move": "move",
    "carry": "move",
    "send": "send_signal",
    "recv2": "receive_readiness",
    "sense": "sense",
    "decide": "decide",
    "release": "release",
    "done": "done",
}
"""The robot's state for each location of the model's robot."""

_READ = {"yes": "OK", "no": "BAD"}
_OUTCOMES = {"given": "released", "kept": "withheld", "gave_up": "timedOut"}
_ALL_OK = "gazeRead == OK and pressureRead == OK and locationRead == OK"
_SENSED_IN_PART = ("robot: sense → done", "robot: reading → sense", "sensors: avail → idle")
_CLAIMS = {
    # Released within 2.65 s, so never in the last tenth of the 3 s.
    "R1": f"robot.decide and {_ALL_OK} -->[<=53] released",
    # Decided or given up within 26.95 s, so never in the last tenth of the 30 s.
    "R3": "robot.recv2 -->[<=539] (robot.judged or timedOut)",
}


def closing() -> Closing:
    """How the campaign closes its holes."""
    return Closing(
        strategies=("pseudorandom", "constrained", "disturbed"),
        written=("directed",),
        fixed=("horizon_s", "faults.noise_m"),
        biased=out_of_turn,
        model=ClosingModel(
            network=handover_network,
            automata=PROJECTED,
            actions=ACTIONS,
            make=_test,
            query=query_of,
            automaton="robot",
            states=STATES,
            robots=("correct",),
        ),
        unreachable=UNREACHABLE,
    )


def _test(template: Template[Any], seed: int) -> AbstractTest:
    """A test that follows a run of the model; no signals are lost, as the model loses none."""
    return structs.replace(instantiate(template, seed), startup_loss=False)


def query_of(group: str, item: str) -> str:
    """The model's query for an item of the coverage model; empty if there is none.

    >>> query_of("ending", "kept")
    'E<> withheld'
    """
    if group == "situation":
        gaze, pressure, location, outcome = item.split(" × ")
        return (
            f"E<> gazeRead == {_READ[gaze]} and pressureRead == {_READ[pressure]} "
            f"and locationRead == {_READ[location]} and {_OUTCOMES[outcome]}"
        )
    if group == EDGES and item in _SENSED_IN_PART:
        # In the shortest run, nothing is ever sensed of the human. Ask for one whose pressure is
        # sensed, while gaze or location is not.
        return "E<> robot.done and timedOut and pressureRead == OK"
    if group == "ending":
        return f"E<> {_OUTCOMES[item]}"
    if item in (JUST_BEFORE, AT):
        return _CLAIMS.get(group, "")
    return ""


def _unreachable() -> tuple[Unreachable, ...]:
    text = Path(__file__).with_name("unreachable.toml").read_text("utf-8")
    return tuple(
        Unreachable(group, item, entry["reason"], robot="correct")
        for entry in tomllib.loads(text)["unreachable"]
        for group, items in entry["items"].items()
        for item in items
    )


UNREACHABLE = (
    *_unreachable(),
    *(
        Unreachable(name, item, f"the model proves it: {query}", robot="correct", by_model=True)
        for name, query in _CLAIMS.items()
        for item in (JUST_BEFORE, AT)
    ),
)
"""Items that no test of the correct robot can hit; a hit reveals an error in this list."""
