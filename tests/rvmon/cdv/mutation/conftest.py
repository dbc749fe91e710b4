"""A lift with its code in a file, so that it can be mutated, and tests of it."""

import importlib.util
import sys
from pathlib import Path

import pytest

from rvmon import cdv
from rvmon.cdv.mutation.baseline import record_suite
from rvmon.cdv.mutation.play import play_mutants
from rvmon.cdv.mutation.python_mutants import Mutant, code_mutants

CODE = '''\
TOP = 3
FLOORS = tuple(range(TOP))


class Lift:
    """Goes up floor by floor, and opens its door."""

    def ride(self, to):
        told = []
        floor = 0
        while floor in FLOORS and floor < min(to, TOP):
            floor += 1
            told.append(("floor", floor))
        if to > TOP:
            told.append(("refused", True))
        self.note(to)
        told.append(("door", True))
        return told

    def note(self, to):
        """Nobody sees what is noted."""
        self.noted = to
'''

SPEC = """
spec lift "A lift"
signal floor : int
event door, refused
requirement L1 "The door opens in three seconds"
  upon start
  then within 3 s door
requirement L2 "The door opens upstairs"
  upon door
  then immediately floor > 0
"""


class Ride(cdv.Test):
    """A ride to a floor."""

    to: int


class System:
    """Plays a ride: the lift's reports are a second apart."""

    def __init__(self, path):
        self.path = path

    def play(self, test, observer):
        with observer.code():
            told = lift_of(self.path).Lift().ride(test.to)
        for number, (name, value) in enumerate(told):
            observer(number * 10**9, {name: value})
        return cdv.Run(max(4, len(told)) * 10**9)


def lift_of(path):
    """The lift's module, loaded on first use."""
    name = f"lift_at_{abs(hash(str(path)))}"
    if name not in sys.modules:
        found = importlib.util.spec_from_file_location(name, path)
        sys.modules[name] = importlib.util.module_from_spec(found)
        found.loader.exec_module(sys.modules[name])
    return sys.modules[name]


def rides(count, seed):
    """Rides to the second floor, and with more tests to the third, and beyond."""
    floors = {"second": 2, "third": 3, "beyond": 9}
    made = [
        Ride(name=name, strategy="rides", seed=seed, to=to, expected={"L1": "P"})
        for name, to in floors.items()
    ]
    return made[:count]


@pytest.fixture
def campaign(tmp_path):
    path = tmp_path / "lift.py"
    path.write_text(CODE)
    (tmp_path / "lift.rv").write_text(SPEC)
    return cdv.Campaign(
        name="rides",
        test=Ride,
        strategies={"rides": rides},
        robots={"lift": cdv.Robot(lambda: System(path), tmp_path / "lift.rv")},
        code=cdv.Code(cdv.blocks_of(path), marked=True, constants={str(path): ["TOP"]}),
    )


@pytest.fixture
def tried(campaign):
    """Plays mutants: by default all of the campaign, in one process, with the first test."""

    def made(mutants=None, *, tests=1, jobs=1, **options):
        suite = record_suite(campaign, "lift", rides(tests, 1), jobs=1)
        chosen = code_mutants(campaign.code) if mutants is None else mutants
        return play_mutants(suite, chosen, jobs=jobs, **options)

    return made


@pytest.fixture
def changed(campaign):
    """Makes a mutant by hand: replaces a text in a function or constant."""
    path = Path(next(iter(campaign.code.constants)))

    def made(function, before, after):
        assert before in CODE
        line = CODE[: CODE.index(before)].count("\n") + 1
        source = CODE.replace(before, after)
        return Mutant(path, line, "by hand", before, after, source, function)

    return made
