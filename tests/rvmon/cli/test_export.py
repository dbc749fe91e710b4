"""`rvmon export` to automata, as a person uses it."""

import json
from pathlib import Path

import pytest

from rvmon.cli import main

SPEC = """
spec door
signal closed : bool
event knock
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2 "At last it is closed"
  upon knock
  then eventually closed
"""


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "door.rv"
    path.write_text(SPEC)
    return str(path)


def test_drawings_for_graphviz(spec, says):
    """Of each requirement, and of a model."""
    shown = says(0, "export", spec, "--to", "dot").out
    assert shown.count("digraph") == 2
    assert "within 2 s not closed" in shown
    drawn = says(0, "export", MODELS / "dock.ta", "--to", "dot").out
    assert drawn.startswith("digraph network {")
    assert "->" in drawn


def test_json(spec, tmp_path):
    path = tmp_path / "door.json"
    assert main(["export", spec, "--to", "json", "-o", str(path)]) == 0
    first, second = json.loads(path.read_text())
    assert [one["name"] for one in first["locations"]] == ["start", "A", "F", "P"]
    assert first["locations"][1]["clock_cuts_ns"] == [[2_000_000_001]]
    assert {edge["target"] for edge in second["edges"]} <= {"A", "P"}


def test_hoa(spec, says):
    """What has windows is left out with the reason."""
    told = says(0, "export", spec, "--to", "hoa")
    assert told.out.startswith('HOA: v1\nname: "D2: At last it is closed"')
    assert told.err.startswith("left out: D1 has windows of time")


@pytest.mark.parametrize("form", ["dot", "json", "hoa"])
def test_what_has_no_automaton_is_left_out_with_the_reason(form, tmp_path, says):
    path = tmp_path / "both.rv"
    path.write_text(
        "signal p : bool\nrequirement L\n  always p\n"
        "requirement N\n  upon p then once[0 s, 1 s] F[0 s, 1 s] p\n"
    )
    told = says(0, "export", path, "--to", form)
    assert (
        told.err
        == "left out: N has no automaton: something of the future below an operator of the past\n"
    )
    assert told.out
    assert "N has no automaton" in says(2, "export", path, "--to", form, "--only", "N").err


@pytest.mark.slow
def test_c_is_the_core_and_a_plan(spec, tmp_path, capsys):
    """The files are named; the core's are the same for each plan, whose requirements are chosen."""
    folder = tmp_path / "made"
    assert main(["export", spec, "--to", "c", "-o", str(folder)]) == 0
    names = ["rvmon_core.h", "rvmon_core.c", "rvmon_core.hpp", "door_plan.h", "door_plan.c"]
    assert capsys.readouterr().out.split() == [str(folder / name) for name in names]
    before = {name: (folder / name).read_text() for name in names}
    assert main(["export", spec, "--to", "c", "-o", str(folder), "--only", "D2"]) == 0
    changed = [name for name in names if (folder / name).read_text() != before[name]]
    assert changed == ["door_plan.h", "door_plan.c"]
    assert "DOOR_REQUIREMENT_D2 = 0, /* D2 */" in (folder / "door_plan.h").read_text()


MODELS = Path(__file__).parents[3] / "examples" / "models"


@pytest.mark.slow
def test_a_model_for_uppaal_comes_back(tmp_path):
    path = tmp_path / "fischer.xml"
    assert main(["export", str(MODELS / "fischer.ta"), "--to", "uppaal", "-o", str(path)]) == 0
    assert main(["verify", str(path), "--query", "exclusion"]) == 0


def test_queries_that_uppaal_has_not_are_named(tmp_path, says):
    out = ["-o", str(tmp_path / "d.xml")]
    (line,) = says(0, "export", MODELS / "dock.ta", "--to", "uppaal", *out).err.splitlines()
    assert line == (
        "warning: not a query of UPPAAL, left out: `soon`: robot.docked -->[<=20] charging"
    )
