"""Packing plans: what must hold of the bytes whatever is specified."""

import random
import subprocess
from enum import IntEnum
from pathlib import Path

import pytest
from tests.tools.gcc import STRICT
from tests.tools.plan_reader import (
    HEADER,
    SECTIONS,
    Plan,
    enumerators,
    layouts,
    size_of,
    walk,
)

import rvmon
from rvmon.core.atoms import AtomOp
from rvmon.core.forms import Operator
from rvmon.core.nodes import NodeOp
from rvmon.core.plan import pack
from rvmon.core.programs import DEPTH, Code
from rvmon.core.sections import HEADER as HEADER_RECORD
from rvmon.core.sections import RECORDS, Section
from rvmon.errors import RvmonError
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.testing.generate.spec import Profile, random_spec

ROOT = Path(__file__).parents[3]
WRITTEN = sorted([*ROOT.glob("specs/*.rv"), *ROOT.glob("examples/**/*.rv")])


def packed(text: str):
    """The plan of a specification."""
    return pack(plan_alone(rvmon.loads(text)._compiled))


def plan_of(seed: int):
    """The plan of a random specification; `None` if it is refused."""
    rng = random.Random(seed)
    checked = random_spec(rng, Profile(many=20))
    try:
        return plan_alone(CompiledSpec(checked))
    except RvmonError:
        return None


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.stem)
def test_every_index_of_a_written_specification_is_in_its_bounds(path):
    """What the demonstration and the examples specify is packed whole."""
    spec = rvmon.load(path)
    if not spec.requirements:
        pytest.skip("it has no requirements")
    walk(Plan(pack(plan_alone(spec._compiled)).data))


@pytest.mark.law
@pytest.mark.parametrize("seed", range(60))
def test_every_index_of_a_random_specification_is_in_its_bounds(seed):
    """Every record leads where it should."""
    plan = plan_of(seed)
    if plan is not None:
        walk(Plan(pack(plan).data))
