"""Names of a specification are nothing but names in the code that is made of it."""

import json
import subprocess

import pytest
from tests.tools.hostile import FORGERIES, STEERING

import rvmon
from rvmon.cli import main
from rvmon.codegen.python_file import python_file

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
    exec(compile(python_file(spec.plan()), "generated", "exec"), {"__name__": "generated"})  # noqa: S102


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


@pytest.mark.compiler
def test_the_report_of_a_program_has_the_ids_and_nothing_else(files):
    """It parses, and forges no requirement."""
    assert main(["build", "s.rv", "-o", "judge"]) == 0
    done = subprocess.run(["./judge", "r\x1b\x9b.csv"], capture_output=True, check=False)
    report = json.loads(done.stdout)
    assert report["trace"] == "r\x1b\x9b.csv"
    assert {name: one["verdict"] for name, one in report["requirements"].items()} == dict.fromkeys(
        files, "F"
    )
    assert not STEERING.search(done.stdout.decode())


@pytest.mark.compiler
def test_what_run_prints_of_compiled_monitors_parses(files, tmp_path, capfd):
    """Also where a program that was compiled before prints it, with columns that are ignored."""
    (tmp_path / "r.csv").write_text("t,x\x1b,y\x1b\n0,1,1\n1,0,1\n", encoding="utf-8")
    for path in ("r.csv", "r\x1b\x9b.csv"):
        main(["run", "s.rv", path, "--engine", "c", "--format", "json"])
        report = json.loads(capfd.readouterr().out)
        assert list(report["requirements"]) == files
        assert report["health"][0]["name"].startswith("y\x1b")


@pytest.mark.compiler
def test_a_program_shows_what_would_steer_a_terminal(files, tmp_path):
    """In the file's name, the column's and the cell."""
    assert main(["build", "s.rv", "-o", "judge"]) == 0
    name = tmp_path / "w\x1b\u202e.csv"
    name.write_text("t,x\x1b\n0,\x1b[31mred\n", encoding="utf-8")
    done = subprocess.run(["./judge", name.name], capture_output=True, check=False)  # noqa: S603
    assert done.returncode == 2
    assert done.stderr.decode() == (
        "w\\x1b\\u202e.csv: line 2: `x\\x1b`: expected a number, found `\\x1b[31mred`\n"
    )
