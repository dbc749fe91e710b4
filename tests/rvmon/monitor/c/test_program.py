"""`rvmon run --engine c` on one file: by a program, with the words of the arrays."""

import json
import os

import pytest

from rvmon.cli import main
from rvmon.monitor.c import batch

pytestmark = pytest.mark.compiler

SPEC = """
spec cell "A cell"
signal closed : bool input
signal parts : int
signal unread : bool
event knock input
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2 "It is filled"
  always parts < 100
"""
HEAD = "t,closed,parts,knock\n"
PLAIN = f"{HEAD}0,1,5,0\n1,1,6,1\n2.0000123,0,7,\n5,,,\n6,1,-8,1\n9.5,,,1\n"
COMMAND = ["run", "cell.rv", "x.csv", "--engine", "c", "--format", "json"]


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A cache that the tests share: there is one program to compile for each way to ask."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def folder(tmp_path, monkeypatch, home):
    """Where the specification is."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(home))
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cell.rv").write_text(SPEC)
    return tmp_path


@pytest.fixture
def by_arrays(monkeypatch):
    """The recordings that arrays have judged."""
    seen = []
    for name in ("evaluate_columns", "evaluate_samples"):
        known = getattr(batch, name)

        def told(*given, known=known):
            seen.append(given)
            return known(*given)

        monkeypatch.setattr(batch, name, told)
    return seen


@pytest.mark.parametrize(
    ("text", "is_judged"),
    [
        (PLAIN, True),
        (PLAIN.replace("\n", "\r\n"), True),
        ("t,other,closed,parts,knock,more\n0,a/b,1,5,1,\n1, 7 ,1,6,0,x\n", True),
        (f"{HEAD}0,1,5,1\n1,1,100,0\n1.5,0,99,0\n", True),
        (f"{HEAD.replace('t,', 't_ns,')}-7,1,5,1\n3,0,5,0\n2000000011,0,5,1\n", True),
        ("t,knock,closed,parts\n0,1,true,\n3,False,TRUE,\n", True),
        (f"{HEAD}0,1,5,0\n", True),
        (f"{HEAD}0,1,,0\n1,1,,0\n", True),
        (f"{HEAD}0,,,0\n", True),
        (f"{HEAD}0,1,5,1\n0,0,5,0\n", False),
        (f'{HEAD}0,"1",5,1\n', False),
        (f"{HEAD}0,1,5,1\n1,maybe,5,1\n", False),
        (f"{HEAD}1,1,5,1\n0,1,5,1\n", False),
        (f"{HEAD}0,1,5,1\n9000000,1,5,1\n", False),
        (HEAD + "".join(f"{20 * k},1,5,1\n" for k in range(30)), True),
    ],
    ids=[
        "plain",
        "crlf",
        "undeclared",
        "fails",
        "ticks",
        "gaps",
        "not-triggered",
        "nothing-known",
        "nothing-said",
        "equal-stamps",
        "quoted",
        "wrong",
        "backwards",
        "long",
        "milliseconds",
    ],
)
def test_prints_what_arrays_print(folder, capfd, by_arrays, monkeypatch, text, is_judged):
    """The same bytes and the same exit code; what there is more to say of is left to arrays."""
    (folder / "x.csv").write_bytes(text.encode())
    code = main(COMMAND)
    found = capfd.readouterr()
    assert not by_arrays or not is_judged
    monkeypatch.setenv("RVMON_CACHE", "off")
    assert code == main(COMMAND)
    assert by_arrays
    wanted = capfd.readouterr()
    assert (found.out, found.err) == (wanted.out, wanted.err)


def test_what_is_chosen_and_overridden_counts(folder, capfd, by_arrays):
    """Each choice of requirements and each changed text has a program of its own."""
    (folder / "x.csv").write_text(PLAIN)
    assert main(COMMAND) == 1
    assert '"D1"' in capfd.readouterr().out
    assert main([*COMMAND, "--only=D2"]) == 0
    assert '"D1"' not in capfd.readouterr().out
    (folder / "cell.rv").write_text(SPEC.replace("< 100", "< 7"))
    assert main(COMMAND) == 1
    assert json.loads(capfd.readouterr().out)["requirements"]["D2"]["verdict"] == "F"
    assert not by_arrays


@pytest.mark.parametrize(
    "more",
    [
        ["--until", "3"],
        ["x.csv"],
        ["--map", "parts=other"],
        ["--time", "t:ms"],
        ["--nan", "no-update"],
    ],
    ids=" ".join,
)
def test_a_program_judges_one_whole_recording_as_it_is(folder, by_arrays, capfd, more):
    """Several are judged by arrays, and so is what is cut, or to be read otherwise."""
    (folder / "x.csv").write_text(PLAIN.replace("\n", ",1\n").replace(",1\n", ",other\n", 1))
    main([*COMMAND[:3], *more, *COMMAND[3:]])
    assert by_arrays


def test_a_name_that_may_be_missing_is_left_to_arrays(folder, by_arrays, capfd):
    """The program knows of no sources."""
    (folder / "x.csv").write_text("t,closed,knock\n0,1,1\n9,1,0\n")
    assert main([*COMMAND, "--allow-missing"]) == 1
    assert by_arrays
    assert json.loads(capfd.readouterr().out)["requirements"]["D2"]["verdict"] == "I"


def test_a_damaged_program_is_made_anew(folder, monkeypatch, by_arrays):
    """It is looked at before it is run."""
    (folder / "x.csv").write_text(PLAIN)
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    code = main(COMMAND)
    (program,) = (folder / "rvmon").glob("*.program")
    whole = program.read_bytes()
    program.write_bytes(b"#!/bin/sh\nexit 0\n")
    os.chmod(program, 0o700)
    assert main(COMMAND) == code == 1
    assert program.read_bytes() == whole
    assert not by_arrays
