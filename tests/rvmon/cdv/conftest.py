"""A tiny system under test for campaigns of about a second."""

import multiprocessing
import os
import time
from pathlib import Path

import pytest

from rvmon import cdv

needs_fork = pytest.mark.skipif(
    multiprocessing.get_start_method() != "fork", reason="needs forked processes"
)

SPEC = """
spec toy "A toy"
signal level : real
event  over
requirement T1 "It stays low"
  always level < 5
requirement T2 "What is high comes down"
  upon level > 2
  then within 1 s level < 1
requirement T3 "It ends"
  eventually over
"""

CODE = """
class Toy:
    def climb(self, to):
        if to > 4:
            return self.high()
        return to

    def high(self):
        return 6

def helper(level):
    return level
"""


class Climb(cdv.Test):
    """Climbs to a level, or does something bad."""

    level: float = 0.0
    does: str = ""


class Toy:
    """Plays a climb: two samples, a second apart."""

    def play(self, test, observer):
        if test.mutation is not None:
            raise cdv.TestError(f"no mutation `{test.mutation}`")
        observer(0, {"level": 0.0, "unknown to the requirements": 1.0})
        match test.does:
            case "hang":
                time.sleep(600)
            case "kill":
                os.kill(os.getpid(), 9)
            case "exit":
                raise SystemExit(5)
            case "crash":
                raise ZeroDivisionError("by zero")
            case "go back":
                observer(-1, {"level": 0.0})
        observer(1_000_000_000, {"level": test.level})
        observer(2_000_000_000, {"level": 0.0})
        observer(3_000_000_000, {"over": True})
        early = test.does == "end early"
        states = [(0, "down"), (1_000_000_000, "up"), (2_000_000_000, "down")]
        return cdv.Run(1 if early else 3_000_000_000, states=states, figures={"metres": 2.0})


def climbs(*tests):
    """A strategy of these tests, `(name, options)`."""

    def made(count, seed):
        return [Climb(name=name, strategy="climbs", seed=seed, **more) for name, more in tests]

    return made


@pytest.fixture
def spec(tmp_path) -> Path:
    path = tmp_path / "toy.rv"
    path.write_text(SPEC)
    return path


@pytest.fixture
def campaign(spec):
    """Makes a campaign of tests, `(name, options)`."""

    def made(*tests, **options):
        robots = {"toy": cdv.Robot(Toy, spec)}
        return cdv.Campaign(
            **{
                "name": "toys",
                "test": Climb,
                "strategies": {"climbs": climbs(*tests)},
                "robots": robots,
                **options,
            }
        )

    return made


@pytest.fixture
def code(tmp_path) -> Path:
    path = tmp_path / "measured_toy.py"
    path.write_text(CODE)
    return path
