"""A person beside the robot's way has a forearm and another hand there, each with its own force."""

import math
import random

import pytest
from msgspec import structs

from handover.driver import run_test
from handover.driver.play import set_up
from handover.generator.abstract_test import directed
from handover.world import parameters as p
from handover.world.faults import SceneFaults
from handover.world.measures import contact_forces, person_distances
from handover.world.world import World

TESTS = {test.name: test for test in directed()}
FORCES = ("hand_force", "other_hand_force", "forearm_force")


def most(test: str, mutation: str | None = None) -> dict[str, float]:
    run = run_test(TESTS[test], robot="correct", mutation=mutation)
    found = dict.fromkeys(FORCES, 0.0)
    for _, values in run.samples:
        for name in FORCES:
            found[name] = max(found[name], values.get(name) or 0.0)
    return found


@pytest.mark.parametrize("far_hand", [False, True])
def test_the_forearm_follows_the_hand(*, far_hand: bool) -> None:
    scene_faults = SceneFaults(beside_m=0.6, far_hand=far_hand)
    world = World(random.Random(1), scene_faults=scene_faults)
    arms = world.scene.arms
    assert arms is not None
    other = arms.other_hand.position
    world.human.reach(*p.LOCATION_OK, near=True)
    middle = sum(p.LOWER_ARM) / 2
    for tenths in range(1, 30):
        world.run(tenths * p.NS // 10)
        to_hand = world.scene.hand.position - arms.forearm.position
        assert to_hand.length == pytest.approx(middle, abs=0.002)
        assert math.cos(to_hand.angle - arms.forearm.angle) == pytest.approx(1.0, abs=1e-3)
        assert (arms.other_hand.position - other).length < 0.001
    assert (world.scene.hand.position - world.scene.hand_target.position).length < 0.005


def test_the_nearest_part_is_the_one_that_counts() -> None:
    """In front of a person it is the hand, beside one it is here the other hand."""
    faults = {at: SceneFaults(beside_m=at, far_hand=True) for at in (0.5, 0.7)}
    near, far = (
        person_distances(World(random.Random(1), scene_faults=one).scene)[1]
        for one in faults.values()
    )
    in_front = person_distances(World(random.Random(1)).scene)[1]
    assert near < far < in_front


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("test", "struck"),
    [
        ("mutant-strikes-a-forearm", {"forearm_force"}),
        ("mutant-strikes-a-hand", {"hand_force", "other_hand_force"}),
        ("beside-in-the-way", set()),
    ],
)
def test_each_part_feels_its_own_contacts(test: str, struck: set[str]) -> None:
    forces = most(test, TESTS[test].mutation)
    assert {name for name, force in forces.items() if force > 10} == struck


@pytest.mark.campaign
def test_contacts_of_a_struck_forearm_are_told_by_pair() -> None:
    test = TESTS["mutant-strikes-a-forearm"]
    world = set_up(test).world
    scene = world.scene
    assert scene.arms is not None
    pairs: set[int] = set()
    for tenths in range(120, 220):
        world.run(tenths * p.NS // 10)
        by_body = contact_forces(scene.arms.forearm)
        felt = world.human.arm_forces()[0]
        robot = [by_body.get(one, 0.0) for one in (scene.links[2], *scene.fingers, scene.piece)]
        assert felt == max(robot)
        pairs |= {index for index, force in enumerate(robot) if force > 1.0}
    assert pairs


@pytest.mark.campaign
def test_a_person_out_of_the_plane_feels_nothing() -> None:
    """The same fault strikes nobody where the person stands in front."""
    test = structs.replace(TESTS["mutant-strikes-a-forearm"], scene=SceneFaults())
    run = run_test(test, robot="correct")
    assert not any(values.get(name) for _, values in run.samples for name in FORCES)
