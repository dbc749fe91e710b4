"""Faults for `python -m benchmarks.testbench faults`: what is written instead of what.

Each is a change of `handover.robot.handover`, written with that file alone at hand.
"""

from __future__ import annotations

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

SLIPS = {
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
        "arrived = yield from self.arm.follow",
        "arrived = True\n                self.arm.follow",
    ),
    "counts no polls of the second wait": (
        "return self.give_up(\"never_ready\")",
        "self.polls = 0",
    ),
}  # fmt: skip
"""A line forgotten, two in the wrong order, a rule misunderstood."""

DRAW_BACK = "next(self.arm.follow(self.arm.interpolate(self.node.params['start_pose'], 2.0)))"

WELL_MEANT = {
    "skips the zero pose": (
        '(("zero_pose", 0.2), ("start_pose", 0.8))',
        '(("start_pose", 1.0),)',
    ),
    "opens again after the reset, to be sure": (
        'return "receive_activation"\n\n    def receive_activation',
        'self.gripper.open()\n        return "receive_activation"\n\n    def receive_activation',
    ),
    "ignores calls in its first second": (
        "if signal in self.behaviour.activation:",
        "if signal in self.behaviour.activation and self.polls > 10:",
    ),
    "a wrong signal starts the first wait anew": (
        'return "receive_activation"\n\n    def move',
        "if signal is not None:\n            self.polls = 0\n"
        '        return "receive_activation"\n\n    def move',
    ),
    "a wrong signal starts the second wait anew": (
        'return "receive_readiness"\n\n    def sense',
        "if signal is not None:\n            self.polls = 0\n"
        '        return "receive_readiness"\n\n    def sense',
    ),
    "looks twice for a hidden piece": (
        "found = self.sensors.piece()\n        if found is None:",
        "found = self.sensors.piece() or self.sensors.piece()\n        if found is None:",
    ),
    "comes to the piece from the side": (
        "self.go_to(x, z + GRIP_ABOVE_CENTRE + height)",
        "self.go_to(x - height / 2, z + GRIP_ABOVE_CENTRE + height)",
    ),
    "opens once more before it grips": (
        "self.gripper.close()",
        "self.gripper.open()\n        self.gripper.close()",
    ),
    "waits between the look for a hand and the grip": (
        "self.gripper.close()",
        "yield 0.5\n        self.gripper.close()",
    ),
    "lifts the piece high before it holds it out": (
        "x, z = HANDOVER_POINT\n        arrived",
        "yield from self.go_to(x, z + 0.3)\n        x, z = HANDOVER_POINT\n        arrived",
    ),
    "says first that it presses": (
        'self.node.publish("robot_gripper", True)',
        'self.node.publish("pressure_e1", True)\n'
        '        self.node.publish("robot_gripper", True)',
    ),
    "informs again every five seconds": (
        "if signal in self.behaviour.readiness:",
        'if self.polls % 50 == 0:\n            self.node.publish("informed", latched=True)\n'
        "        if signal in self.behaviour.readiness:",
    ),
    "takes a held piece for readiness": (
        "if signal in self.behaviour.readiness:",
        "if signal in self.behaviour.readiness or self.sensors.sense().pressure:",
    ),
    "reads the sensors twice": (
        "reading = self.sensors.sense()",
        "self.sensors.sense()\n        reading = self.sensors.sense()",
    ),
    "starts the clock of sensing with each reading": (
        "reading = self.sensors.sense()",
        "reading = self.sensors.sense()\n        self.entered = self.node.now()",
    ),
    "counts the time of sensing by polls": (
        "elapsed = self.node.now() - self.entered",
        "self.polls += 1\n        elapsed = self.polls * self.behaviour.sense_poll_s",
    ),
    "looks again before it withholds": (
        "if not reading.location:",
        "self.sensors.sense()\n        if not reading.location:",
    ),
    "waits for a steadier hand before it releases": (
        'if ready:\n            return "release"',
        'if ready:\n            yield 0.5\n            return "release"',
    ),
    "closes again where the piece stays": (
        'self.node.publish("pressure_e1", False)\n        self.node.publish("resetpiece")',
        "if self.has_piece():\n            self.gripper.close()\n"
        '        self.node.publish("pressure_e1", False)\n        self.node.publish("resetpiece")',
    ),
    "draws back while the person takes the piece": (
        "yield self.behaviour.release_s",
        f"{DRAW_BACK}\n        yield self.behaviour.release_s",
    ),
    "draws back with what it withholds": (
        'self.node.publish("withheld")',
        f'self.node.publish("withheld")\n        {DRAW_BACK}',
    ),
    "draws back as it gives up": (
        'self.node.publish("timed_out")',
        f'self.node.publish("timed_out")\n        {DRAW_BACK}',
    ),
    "starts over when it is done": (
        "yield 0.0\n        return END",
        'yield 0.0\n        return "reset"',
    ),
    "forgives a signal that came a second too early": (
        "message.stamp < self.entered",
        "message.stamp < self.entered - 1.0",
    ),
    "a hidden piece counts as held": (
        "found is not None\n            and",
        "found is None\n            or",
    ),
    "tries a higher place where there is no path": (
        "path = yield from self.arm.plan(x, z)",
        "path = (yield from self.arm.plan(x, z)) or (yield from self.arm.plan(x, z + 0.05))",
    ),
    "goes twice as fast": (
        "if path is not None:",
        "if path is not None:\n"
        "                path = type(path)(path.start, path.goal, path.duration / 2)",
    ),
    "goes on after it stopped before a person": ("return arrived", "return True"),
    "minds nobody on its way": ("minds_people=self.behaviour.minds_hand", "minds_people=False"),
    "knows places to the centimetre": (
        "x, z = found",
        "x, z = round(found[0], 2), round(found[1], 2)",
    ),
}  # fmt: skip
"""What somebody adds who means well: to be sure, to be quick, to be kind."""

FAULTS = SLIPS | WELL_MEANT
