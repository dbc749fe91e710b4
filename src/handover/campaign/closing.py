"""How the campaign of handovers closes its holes: by the model, and what no test can show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import structs

from handover.generator.model_based import ACTIONS, PROJECTED, instantiate
from handover.generator.out_of_turn import out_of_turn
from handover.model import handover_network
from rvmon.cdv.campaign import Closing, ClosingModel, Unreachable
from rvmon.cdv.close.witnesses import EDGES
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
"""The robot's states by the locations of the model's robot."""

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
    """What the campaign knows of its own holes."""
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
    """A test of a run of the model, whose signals are not lost: it is to show that run."""
    return structs.replace(instantiate(template, seed), startup_loss=False)


def query_of(group: str, item: str) -> str:
    """What the model is asked about an item of the coverage model; empty: it knows nothing of it.

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
        # The shortest run has a human of whom nothing is sensed; one who turns away is seen to.
        return "E<> robot.done and timedOut and pressureRead == OK"
    if group == "ending":
        return f"E<> {_OUTCOMES[item]}"
    if item in (JUST_BEFORE, AT):
        return _CLAIMS.get(group, "")
    return ""


_ONLY_LEGACY = "only the legacy robot does so"
_NO_DELAY = "the robot takes time from a message to its reaction"
_SOON = "the robot reacts in a fixed time, far from the limit"
_EXACT = "the robot waits exactly, to the nanosecond"
_APART = "instants that nothing ties together, of the human and of the arm's paths, do not coincide"
_HELD = "what does not slip on the way is held: a human who moves away lets go first"
_POLLS = "the robot gives up after many polls, never at the first"

UNREACHABLE = tuple(
    Unreachable(group, item, reason, robot="correct")
    for reason, places in {
        _ONLY_LEGACY: [
            ("", "if not self.behaviour.resubscribes: → self.gripper.open()"),
            ("", 'if not self.behaviour.shared_polls: → return "move"'),
            ("", 'limit = self.node.params["timeout_time"]'),
            ("", "elapsed = self.node.now() - self.informed_at"),
            ("statements of common", "self.node.subscribe(HUMAN_SIGNALS)"),
            ("branches of common", "self.node.subscribe(HUMAN_SIGNALS)"),
        ],
        _NO_DELAY: [
            (f"`{name}` edges", "start → P") for name in ("R1", "R3", "R4", "T11", "T19", "T27")
        ],
        "readings and `sensed` are of one instant; what was not read counts as bad": [
            ("R1", "`sensed` decides"),
            ("T5", "`fully_read` decides"),
            ("T57", "`fully_read` decides"),
            ("T57", "`sensed` decides"),
        ],
        _SOON: [
            *((name, JUST_BEFORE) for name in ("T5", "T11", "T30")),
            *((name, AT) for name in ("T5", "T11", "T30")),
            ("`T30` locations", "A"),
            ("`T30` edges", "start → A"),
            ("`T30` edges", "A → P"),
        ],
        _EXACT: [
            *(("`T28` locations", place) for place in ("B", "C")),
            *(("`T28` edges", edge) for edge in ("A → B", "A → C", "B → P")),
            ("T28", "`always[1 ns, 499999999 ns] not sensors_read` decides"),
            ("T28", "`eventually[1 ns, 500 ms] (sensors_read or timed_out)` decides"),
            *(("`T31` locations", place) for place in ("B", "C")),
            *(("`T31` edges", edge) for edge in ("A → C", "B → P", "C → P")),
            ("T31", "`for 1999999999 ns not done` decides"),
            ("T31", "`within 2100 ms done` decides"),
            *(
                (f"`{name}` {kind}", item)
                for name in ("T41", "T43", "T45")
                for kind, item in (
                    ("locations", "B"),
                    ("locations", "C"),
                    ("edges", "A → C"),
                    ("edges", "B → P"),
                )
            ),
            ("T41", "`for 499999999 ns not grip_closed` decides"),
            ("T41", "`within 500 ms grip_closed` decides"),
            ("T43", "`for 99999999 ns not decided` decides"),
            ("T43", "`within 100 ms decided` decides"),
            ("T45", "`for 299999999 ns not released` decides"),
            ("T45", "`within 300 ms released` decides"),
            ("`T42` locations", "C"),
            *(("`T42` edges", edge) for edge in ("A → C", "A → P", "B → C")),
            *(
                ("T42", f"`{part}` decides")
                for part in (
                    "for 49999999 ns (robot_gripper and not pressure_e1)",
                    "robot_gripper",
                    "not pressure_e1",
                    "always[50 ms, 99999999 ns] (robot_gripper and pressure_e1)",
                    "robot_gripper (2)",
                    "pressure_e1",
                    "eventually[100 ms, 100 ms] (not robot_gripper and pressure_e1)",
                    "not robot_gripper",
                    "pressure_e1 (2)",
                )
            ),
        ],
        _APART: [
            ("`T23` edges", "start → P"),
            ("`T25` edges", "start → P"),
            ("T25", AT),
            ("T27", AT),
        ],
        _HELD: [
            ("`T5` edges", "start → P"),
            ("T9", "`not gripper_holds since person_holds` decides"),
        ],
        "three plans take 6.6 s at most": [("T19", AT)],
        "what comes with the reset is not heard": [("`T21` edges", "start → P")],
        "who is not near does not hold: with location, pressure would be misread as well": [
            ("T3", "`location_ok and not true_location` decides")
        ],
        _POLLS: [
            ("pairs of transitions", "reset → receive_activation → done"),
            ("pairs of transitions", "send_signal → receive_readiness → done"),
            ("pairs of transitions", "receive_readiness → sense → done"),
        ],
        "no test of the model's human disturbs planner or piece": [
            (EDGES, "robot: move → done"),
            (EDGES, "robot: carry → done"),
        ],
    }.items()
    for group, item in places
)
"""What no test of the correct robot can show: a test that does is an error of this list."""
