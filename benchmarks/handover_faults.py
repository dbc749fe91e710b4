"""Thirty faults written into the robot's code, none of them with the requirements at hand.

    python -m benchmarks.handover_faults --tests 60

Each is what somebody may write who reads `handover.robot.handover` alone: a line forgotten, two in
the wrong order, a rule misunderstood. Directed and disturbed tests are played on each until a
requirement fails. Prints what sees it: a requirement, a signal that nobody judges, or nothing.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import os
from pathlib import Path

from handover.campaign.campaign import handover_campaign
from handover.robot import handover
from handover.robot.handover import HandoverRobot
from rvmon.cdv.mutation.baseline import record_suite
from rvmon.cdv.mutation.mutant import Mutant
from rvmon.cdv.mutation.play import play_mutants
from rvmon.cdv.plan import plan

GIVE_UP = 'self.node.publish("timed_out")\n        return "done"'
INFORMED = 'self.node.publish("informed", latched=True)'
ARRIVED = """if not arrived:
            return self.give_up("no_path_to_person")"""
MISSING = "missing = None in (reading.gaze, reading.pressure, reading.location)"
CLOSE = "self.gripper.close()\n        yield self.behaviour.grip_pause_s"
READY = "all((reading.gaze, reading.pressure, reading.location))"
RELEASE = """self.gripper.open()
        yield self.behaviour.open_s
        self.node.publish("pressure_e1", False)"""

FAULTS = {
    "start pose first, then the zero pose": (
        '(("zero_pose", 0.2), ("start_pose", 0.8))',
        '(("start_pose", 0.2), ("zero_pose", 0.8))',
    ),
    "the handover point's coordinates swapped": ("(0.20, 0.22)", "(0.22, 0.20)"),
    "one approach height left out": ("(0.18, 0.06, 0.0)", "(0.18, 0.0)"),
    "a single attempt to plan": ("PLAN_ATTEMPTS = 3", "PLAN_ATTEMPTS = 1"),
    "the piece may be anywhere": ("PIECE_TOLERANCE = 0.05", "PIECE_TOLERANCE = 0.5"),
    "a hand has to be nearer to count": ("HAND_CLEARANCE = 0.06", "HAND_CLEARANCE = 0.02"),
    "old signals count": ("message.stamp < self.entered", "message.stamp < 0"),
    "closes where it is": ("in APPROACH_HEIGHTS:", "in APPROACH_HEIGHTS[:2]:"),
    "closes again as it counts as closed": (CLOSE, f"{CLOSE}\n        self.gripper.close()"),
    "goes on without a path to the person": (ARRIVED, "pass"),
    "does not settle": ("yield self.behaviour.settle_s", "yield 0.0"),
    "informs before it fetches": (
        "found = self.sensors.piece()\n        if found is None:\n            return self.give_up",
        f"{INFORMED}\n        found = self.sensors.piece()\n        if found is None:\n"
        "            return self.give_up",
    ),
    "its message is not latched": (INFORMED, 'self.node.publish("informed")'),
    "any signal means ready": ("if signal in self.behaviour.readiness:", "if signal is not None:"),
    "says sensed at each look": (
        MISSING,
        f'self.node.publish("sensed")\n        {MISSING}',
    ),
    "decides by a new reading": ("reading = self.reading\n", "reading = self.sensors.sense()\n"),
    "waits for pressure alone": (MISSING, "missing = reading.pressure is None"),
    "one good reading is enough": (READY, READY.replace("all", "any")),
    "gaze is forgotten": (READY, "all((reading.pressure, reading.location))"),
    "away and empty mixed up": ('publish("hand_away")', 'publish("hand_empty")'),
    "says released before it opens": (
        RELEASE,
        f'self.node.publish("released")\n        {RELEASE}',
    ),
    "gives no time to take the piece": ("yield self.behaviour.release_s", "yield 0.0"),
    "closes when the piece is gone": (
        "yield self.behaviour.release_s",
        "yield self.behaviour.release_s\n        self.gripper.close()",
    ),
    "ends without a word when it gives up": (GIVE_UP, GIVE_UP.replace('"done"', "END")),
    "opens when it gives up": (GIVE_UP, f"self.gripper.open()\n        {GIVE_UP}"),
    "gives up twice": (GIVE_UP, f'self.node.publish("timed_out")\n        {GIVE_UP}'),
    "looks for the piece at the right side only": (
        "math.hypot(found[0] - x, found[1] + GRIP_ABOVE_CENTRE - z)",
        "abs(found[0] - x)",
    ),
    "a dead sensor means a hand": (
        "distance is not None and distance < HAND_CLEARANCE",
        "distance is None or distance < HAND_CLEARANCE",
    ),
    "does not wait until it has arrived": (
        "yield from self.arm.follow(path)\n                return True",
        "next(self.arm.follow(path))\n                return True",
    ),
    "counts no polls of the second wait": (
        "return self.give_up(\"never_ready\")",
        "self.polls = 0",
    ),
}  # fmt: skip
"""What is written instead of what."""


def main() -> int:
    """Plant, play, print; 1 if a fault cannot be planted."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", type=int, default=60, help="disturbed ones")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    campaign = handover_campaign(("correct",))
    strategies = ("directed", "disturbed")
    chosen = plan(campaign, strategies, tests=arguments.tests, seed=arguments.seed).tests
    jobs = os.cpu_count() or 1
    tests = [test for several in chosen.values() for test in several]
    suite = record_suite(campaign, "correct", tests, jobs=jobs)
    tried = play_mutants(suite, [_mutant(name) for name in FAULTS], jobs=jobs)
    unseen = 0
    for name, one in zip(FAULTS, tried, strict=True):
        seen = next((found for found in one.findings), None)
        unseen += seen is None
        if one.invalid:
            what = f"invalid: {one.invalid}"
        elif seen is not None:
            what = f"{seen.how} {', '.join(seen.what)} ({seen.test})"
        elif one.difference is not None:
            what = f"a signal that nothing judges: {one.difference}"
        else:
            what = f"nothing, {one.reaching} tests run it"
        print(f"{name:45} {what}", flush=True)
    print(f"{len(tried) - unseen} of {len(tried)} faults are seen")
    return int(any(one.invalid for one in tried))


def _mutant(name: str) -> Mutant:
    path = Path(inspect.getsourcefile(handover) or "")
    source = path.read_text(encoding="utf-8")
    before, after = FAULTS[name]
    at = source.index(before)
    line = source.count("\n", 0, at) + 1
    whole = source[:at] + after + source[at + len(before) :]
    return Mutant(path, line, "fresh", before, after, whole, _place(source, line))


def _place(source: str, line: int) -> str:
    """The qualified name of the function that a line is in; else that of its constant."""
    for part in ast.parse(source).body:
        for inner in part.body if isinstance(part, ast.ClassDef) else ():
            is_function = isinstance(inner, ast.FunctionDef)
            if is_function and inner.lineno <= line <= (inner.end_lineno or 0):
                return f"{HandoverRobot.__name__}.{inner.name}"
    return source.splitlines()[line - 1].split()[0]


if __name__ == "__main__":
    raise SystemExit(main())
