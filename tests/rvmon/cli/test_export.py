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


def test_dot(spec, says):
    shown = says(0, "export", spec, "--to", "dot").out
    assert shown.count("digraph") == 2
    assert "within 2 s not closed" in shown


def test_json(spec, tmp_path):
    path = tmp_path / "door.json"
    assert main(["export", spec, "--to", "json", "-o", str(path)]) == 0
    first, second = json.loads(path.read_text())
    assert [one["name"] for one in first["locations"]] == ["start", "A", "F", "P"]
    assert first["locations"][1]["clock_cuts_ns"] == [[2_000_000_001]]
    assert {edge["target"] for edge in second["edges"]} <= {"A", "P"}


def test_hoa(spec, capsys, says):
    """What has windows is left out with the reason; where nothing is left, that is an error."""
    told = says(0, "export", spec, "--to", "hoa")
    assert told.out.startswith('HOA: v1\nname: "D2: At last it is closed"')
    assert told.err.startswith("left out: D1 has windows of time")
    assert main(["export", spec, "--to", "hoa", "--only", "D1"]) == 2
    assert capsys.readouterr().err.startswith("error: D1 has windows of time")


def test_c_wants_a_folder(spec, tmp_path, capsys):
    """A file in its place is named with what to name instead; no folder is made in vain."""
    place = tmp_path / "door.c"
    place.write_text("")
    for output in ([], ["-o", str(place)]):
        assert main(["export", spec, "--to", "c", *output]) == 2
        assert "C is several files: name a folder with -o DIR" in capsys.readouterr().err
    refused = tmp_path / "refused.rv"
    refused.write_text(SPEC.replace("upon knock\n", "upon knock\n  let c = nothing\n", 1))
    assert main(["export", str(refused), "--to", "c", "-o", str(tmp_path / "made")]) == 2
    assert not (tmp_path / "made").exists()


def test_c_takes_samples_in_order(spec, tmp_path, capsys):
    late = tmp_path / "late.rv"
    late.write_text(SPEC.replace("\nsignal", "\nmax delay 1 s\nsignal", 1))
    assert "max delay" in late.read_text()
    assert main(["export", str(late), "--to", "c", "-o", str(tmp_path / "made")]) == 2
    assert "leave out `max delay` and give it samples in order" in capsys.readouterr().err
    assert not (tmp_path / "made").exists()


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


def test_unknown_requirements_are_named(spec, says):
    assert "there are D1, D2" in says(2, "export", spec, "--to", "dot", "--only", "D7").err


@pytest.mark.parametrize("form", ["dot", "hoa", "json"])
def test_a_spec_without_requirements_has_no_automata(tmp_path, says, form):
    (tmp_path / "door.rv").write_text(SPEC.partition("requirement")[0])
    shown = says(2, "export", tmp_path / "door.rv", "--to", form)
    assert shown.out == ""
    assert "no requirement" in shown.err


MODELS = Path(__file__).parents[3] / "examples" / "models"


@pytest.mark.slow
def test_a_model_for_uppaal_comes_back(tmp_path):
    path = tmp_path / "fischer.xml"
    assert main(["export", str(MODELS / "fischer.ta"), "--to", "uppaal", "-o", str(path)]) == 0
    assert main(["verify", str(path), "--query", "exclusion"]) == 0


def test_a_model_for_graphviz(says):
    assert main(["export", str(MODELS / "dock.ta"), "--to", "dot", "--const", "X=1"]) == 2
    drawn = says(0, "export", MODELS / "dock.ta", "--to", "dot").out
    assert drawn.startswith("digraph network {")
    assert "->" in drawn


def test_queries_that_uppaal_has_not_are_named(tmp_path, says):
    out = ["-o", str(tmp_path / "d.xml")]
    (line,) = says(0, "export", MODELS / "dock.ta", "--to", "uppaal", *out).err.splitlines()
    assert line == (
        "warning: not a query of UPPAAL, left out: `soon`: robot.docked -->[<=20] charging"
    )


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([str(MODELS / "dock.ta"), "--to", "c"], "--to c is of specifications"),
        ([str(MODELS / "dock.ta"), "--to", "dot", "--const", "X=a"], "expected NAME=NUMBER"),
        ([str(MODELS / "dock.ta"), "--to", "dot", "-o", "/nowhere/a.dot"], "No such file"),
        (["door.rv", "--to", "uppaal"], "is no model"),
    ],
)
def test_what_cannot_be_exported_is_said(words, told, says):
    assert told in says(2, "export", *words).err
