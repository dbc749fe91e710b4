"""Tests of the base in a simulated corridor: `python campaign.py run --tests 50 --out out`."""

import random
import sys
from functools import partial
from math import hypot
from pathlib import Path
from typing import Annotated

import msgspec
from base import Base, BrakesLate

from rvmon import cdv
from rvmon.cli.campaign import main

HERE = Path(__file__).parent
STEP_NS, HORIZON_NS = 50_000_000, 60_000_000_000
CORRIDOR_M = 12.0


class Person(msgspec.Struct, frozen=True):
    """A person who crosses the corridor."""

    start_s: Annotated[float, msgspec.Meta(ge=-10, le=60)]
    at_m: Annotated[float, msgspec.Meta(ge=0, le=CORRIDOR_M)]
    pace: Annotated[float, msgspec.Meta(ge=0.3, le=2)]

    def distance(self, x_m: float, seconds: float) -> float:
        """The distance from the base in metres; 100 while the person is not in the corridor."""
        y_m = self.pace * (seconds - self.start_s) - 3
        return hypot(self.at_m - x_m, y_m) if abs(y_m) <= 3 else 100.0


class Walk(cdv.Test):
    """A test: the people who cross, with place and time."""

    people: tuple[Person, ...]
    removable = ("people",)


class Corridor:
    """The system under test; a campaign only needs its method `play`."""

    def play(self, test: Walk, observer: cdv.Observer) -> cdv.Run:
        """Drive until the base has arrived, or until the horizon."""
        base = BrakesLate(CORRIDOR_M) if test.mutation == "brakes-late" else Base(CORRIDOR_M)
        states = []
        for t_ns in range(0, HORIZON_NS, STEP_NS):
            people = (one.distance(base.x_m, t_ns / 1e9) for one in test.people)
            person = min(people, default=100.0)
            base.step(person, STEP_NS / 1e9)
            if not states or states[-1][1] != base.state:
                states.append((t_ns, base.state))
            observer(t_ns, {"speed": base.speed, "person": person})
            if base.state == "arrived" and base.speed == 0:
                observer(t_ns + 1, {"arrived": True})
                return cdv.Run(end_ns=t_ns + 1, states=states, figures={"metres": base.x_m})
        return cdv.Run(end_ns=HORIZON_NS, states=states, figures={"metres": base.x_m})


def walks(strategy: str, count: int, seed: int) -> list[Walk]:
    """Tests with up to three people, who cross anywhere and at any time, or near the base."""
    tests = []
    for number in range(count):
        rng = random.Random(f"{strategy}/{seed}/{number}")
        people = []
        for _ in range(rng.randint(1, 3)):
            at_m = rng.uniform(0, CORRIDOR_M)
            start_s = rng.uniform(0, 60) if strategy == "anyone" else at_m - rng.uniform(1, 5)
            people.append(Person(start_s, at_m, rng.uniform(0.5, 1.5)))
        name = f"{strategy}-{number:03}"
        tests.append(Walk(name=name, strategy=strategy, seed=number, people=tuple(people)))
    return tests


def directed(_count: int, _seed: int) -> list[Walk]:
    """Tests with people in the way and at the goal; one has a planted fault, which B2 must find."""
    crossing = (Person(0.0, 5.0, 0.4), Person(2.0, 3.4, 0.4))
    good = Walk(
        name="gives-way",
        strategy="directed",
        seed=0,
        people=crossing,
        expected={"B1": "P", "B2": "P", "B3": "P"},
    )
    make = partial(msgspec.structs.replace, good, expected={"B3": "P"})
    leaves, comes = Person(11.8, CORRIDOR_M, 1.0), Person(10.6, CORRIDOR_M, 0.5)
    slow = {"transitions": ["slow → arrived"]}
    late = {"transitions": ["wait → arrived"]}  # it reaches its goal while it brakes to wait
    return [
        good,
        make(name="brakes-late", mutation="brakes-late", expected={"B2": "F"}),
        make(name="slow-at-the-goal", people=(leaves,), reaches=slow),
        make(name="waits-at-the-goal", people=(comes,), reaches=late),
    ]


UNREACHABLE = {
    "it stays at its goal": {
        "transitions": ("arrived → drive", "arrived → slow", "arrived → wait")
    },
    "nobody moves 1.5 m in a step of 50 ms": {"transitions": ("drive → wait", "wait → drive")},
    "it is slow before anybody is near, and brakes in 0.2 s": {
        "situation": ("near × fast", "beside × slow"),
        "B2": ("just before the deadline", "at the deadline"),
    },
    "it starts far from its goal": {"`B3` edges": ("start → P",)},
}


campaign = cdv.Campaign(
    name="base and people",
    test=Walk,
    strategies={
        "anyone": partial(walks, "anyone"),
        "in-the-way": partial(walks, "in-the-way"),
        "directed": directed,
    },
    robots={"base": cdv.Robot(Corridor, HERE / "people.rv")},
    code=cdv.Code(cdv.blocks_of(HERE / "base.py")),
    states=("drive", "slow", "wait", "arrived"),
    closing=cdv.Closing(
        written=("directed",),
        unreachable=[
            cdv.Unreachable(group, item, reason)
            for reason, groups in UNREACHABLE.items()
            for group, items in groups.items()
            for item in items
        ],
    ),
    sources=(HERE,),
)

if __name__ == "__main__":
    sys.exit(main(campaign))
