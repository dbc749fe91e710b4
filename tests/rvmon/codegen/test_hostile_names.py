"""Names of a specification are nothing but names in the code that is made of it."""

import json

import pytest
from tests.tools.hostile import FORGERIES

import rvmon
from rvmon.cli import main

NAMES = [name for name in FORGERIES if name.strip() == name]

SPEC = (
    "spec `"
    + '"""; raise SystemExit("run"); """'
    + "`\nsignal b : bool\n"
    + "".join(f"requirement `{name}`\n  always b\n" for name in NAMES)
)


def test_python_that_is_generated_runs_no_name():
    """Neither a docstring nor a comment is ended by an id."""
    spec = rvmon.loads(SPEC)
    monitor = spec.monitor(engine="python")
    monitor.step(0.0, {"b": False})
    assert dict(monitor.verdicts) == dict.fromkeys(NAMES, "F")


@pytest.fixture
def files(tmp_path, monkeypatch):
    """The specification without ends of lines in names, which no file has, and a recording."""
    monkeypatch.chdir(tmp_path)
    names = [name for name in NAMES if "\r" not in name]
    text = "spec s\nsignal `x\x1b` : real\n" + "".join(
        f"requirement `{name}`\n  always `x\x1b` > 0\n" for name in names
    )
    (tmp_path / "s.rv").write_text(text, encoding="utf-8")
    (tmp_path / "r\x1b\x9b.csv").write_text("t,x\x1b,y\x1b\x9b\n0,1,1\n1,0,1\n", encoding="utf-8")
    return names


def test_what_run_prints_by_the_core_parses(files, tmp_path, capfd):
    """Also where it tells of columns that are ignored."""
    (tmp_path / "r.csv").write_text("t,x\x1b,y\x1b\n0,1,1\n1,0,1\n", encoding="utf-8")
    for path in ("r.csv", "r\x1b\x9b.csv"):
        main(["run", "s.rv", path, "--engine", "c", "--format", "json"])
        report = json.loads(capfd.readouterr().out)
        assert list(report["requirements"]) == files
        assert report["health"][0]["name"].startswith("y\x1b")
