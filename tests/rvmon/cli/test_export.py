"""`rvmon export`: automata for Graphviz, JSON, HOA and UPPAAL, and monitors in C."""

import json
from pathlib import Path

import pytest
from tests.tools.each import each

from rvmon.cli import main

MODELS = Path(__file__).parents[3] / "examples" / "models"
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


def test_each_requirement_and_a_model_are_drawn_for_graphviz(spec, says):
    shown = says(0, "export", spec, "--to", "dot").out
    assert shown.count("digraph") == 2
    assert "within 2 s not closed" in shown
    drawn = says(0, "export", MODELS / "dock.ta", "--to", "dot").out
    assert drawn.startswith("digraph network {")
    assert "->" in drawn


def test_json_has_locations_and_edges(spec, tmp_path):
    path = tmp_path / "door.json"
    assert main(["export", spec, "--to", "json", "-o", str(path)]) == 0
    first, second = json.loads(path.read_text())
    assert [location["name"] for location in first["locations"]] == ["start", "A", "F", "P"]
    assert first["locations"][1]["clock_cuts_ns"] == [[2_000_000_001]]
    assert {edge["target"] for edge in second["edges"]} <= {"A", "P"}


def test_requirements_with_windows_are_left_out_of_hoa(spec, says):
    told = says(0, "export", spec, "--to", "hoa")
    assert told.out.startswith('HOA: v1\nname: "D2: At last it is closed"')
    assert told.err.startswith("left out: D1 has windows of time")


@each("form", ["dot", "json", "hoa"])
def test_a_requirement_without_automaton_is_left_out_with_the_reason(form, put, says):
    path = put(
        "both.rv",
        "signal p : bool\nrequirement L\n  always p\n"
        "requirement N\n  upon p then once[0 s, 1 s] F[0 s, 1 s] p\n",
    )
    told = says(0, "export", path, "--to", form)
    why = "N has no automaton: something of the future below an operator of the past"
    assert told.err == f"left out: {why}\n"
    assert told.out
    assert "N has no automaton" in says(2, "export", path, "--to", form, "--only", "N").err


@pytest.mark.slow
def test_c_is_the_core_and_a_plan_of_the_chosen_requirements(spec, tmp_path, capsys):
    """The files of the core are the same for every plan."""
    folder = tmp_path / "made"
    assert main(["export", spec, "--to", "c", "-o", str(folder)]) == 0
    names = ["rvmon_core.h", "rvmon_core.c", "rvmon_core.hpp", "door_plan.h", "door_plan.c"]
    assert capsys.readouterr().out.split() == [str(folder / name) for name in names]
    before = {name: (folder / name).read_text() for name in names}
    assert main(["export", spec, "--to", "c", "-o", str(folder), "--only", "D2"]) == 0
    changed = [name for name in names if (folder / name).read_text() != before[name]]
    assert changed == ["door_plan.h", "door_plan.c"]
    assert "DOOR_REQUIREMENT_D2 = 0, /* D2 */" in (folder / "door_plan.h").read_text()


@pytest.mark.slow
def test_a_model_exported_to_uppaal_is_read_back(tmp_path):
    path = tmp_path / "fischer.xml"
    assert main(["export", str(MODELS / "fischer.ta"), "--to", "uppaal", "-o", str(path)]) == 0
    assert main(["verify", str(path), "--query", "exclusion"]) == 0


def test_queries_unknown_to_uppaal_are_left_out(tmp_path, says):
    out = ["-o", str(tmp_path / "d.xml")]
    (line,) = says(0, "export", MODELS / "dock.ta", "--to", "uppaal", *out).err.splitlines()
    assert line == (
        "warning: not a query of UPPAAL, left out: `soon`: robot.docked -->[<=20] charging"
    )
