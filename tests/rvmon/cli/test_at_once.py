"""`rvmon run --engine c --format json` by a program that was compiled before."""

import json
import os

import pytest

from rvmon.cli import main
from rvmon.cli.at_once import judged_at_once

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


def command(trace, *more):
    """The words of the command line."""
    return ["run", "cell.rv", trace, "--engine", "c", "--format", "json", *more]


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        PLAIN.replace("\n", "\r\n"),
        "t,other,closed,parts,knock,more\n0,a/b,1,5,1,\n1, 7 ,1,6,0,x\n",
        f"{HEAD}0,1,5,1\n1,1,100,0\n1.5,0,99,0\n",
        f"{HEAD.replace('t,', 't_ns,')}-7,1,5,1\n3,0,5,0\n2000000011,0,5,1\n",
        "t,knock,closed,parts\n0,1,true,\n3,False,TRUE,\n",
    ],
    ids=["plain", "crlf", "undeclared", "fails", "ticks", "gaps"],
)
def test_prints_what_the_ordinary_way_prints(folder, capfd, text):
    """The same bytes and the same exit code, with warnings on standard error."""
    (folder / "x.csv").write_bytes(text.encode())
    code = judged_at_once(command("x.csv"))
    found = capfd.readouterr()
    assert code is not None
    assert code == main(command("x.csv"))
    wanted = capfd.readouterr()
    assert (found.out, found.err) == (wanted.out, wanted.err)
    assert "unread" in found.err


@pytest.mark.parametrize(
    "text",
    [
        HEAD,
        f"{HEAD}0,1,5,0\n",
        f"{HEAD}0,1,5,1\n0,0,5,0\n",
        f'{HEAD}0,"1",5,1\n',
        f"{HEAD}0,1,9007199254740993,1\n",
        f"{HEAD}0,1,5,1\n1,maybe,5,1\n",
        f"{HEAD}1,1,5,1\n0,1,5,1\n",
        f"{HEAD}0,1,5,1\r1,1,5,1\n",
        f"{HEAD}0,1,5,1\n9000000,1,5,1\n",
        "t,closed,knock,x,x\n0,1,1,,\n",
        "t,closed,knock,\u00e9\n0,1,1,\n",
    ],
    ids=[
        "no-row",
        "not-triggered",
        "equal-stamps",
        "quoted",
        "large",
        "wrong",
        "backwards",
        "returns",
        "long",
        "twice",
        "not-ascii",
    ],
)
def test_leaves_what_there_is_more_to_say_of(folder, capfd, text):
    """Nothing is printed, and the ordinary way is left to say what there is to say."""
    (folder / "x.csv").write_bytes(text.encode())
    assert judged_at_once(command("x.csv")) is None
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "words",
    [
        ["run", "cell.rv", "x.csv", "--engine", "c"],
        ["run", "cell.rv", "x.csv", "--format", "json"],
        command("x.csv", "--strict"),
        command("x.csv", "--until", "3"),
        command("x.csv", "y.csv"),
        command("x.jsonl"),
        command("none.csv"),
        command("x.csv", "--only", "D9"),
        command("x.csv", "--only"),
        ["check", "cell.rv"],
        [],
    ],
    ids=" ".join,
)
def test_other_command_lines_go_the_ordinary_way(folder, capfd, words):
    """Only one recording as JSON, by C, without more to find."""
    (folder / "x.csv").write_text(PLAIN)
    (folder / "x.jsonl").write_text('{"t": 0, "knock": true}\n')
    assert judged_at_once(words) is None
    assert capfd.readouterr() == ("", "")


def test_nothing_is_kept_where_the_cache_is_off(folder, capfd, monkeypatch):
    """Without a cache there is no program."""
    (folder / "x.csv").write_text(PLAIN)
    monkeypatch.setenv("RVMON_CACHE", "off")
    assert judged_at_once(command("x.csv")) is None


def test_what_is_chosen_and_overridden_counts(folder, capfd):
    """Each choice of requirements and each changed text has a program of its own."""
    (folder / "x.csv").write_text(PLAIN)
    assert judged_at_once(command("x.csv")) == 1
    assert '"D1"' in capfd.readouterr().out
    assert judged_at_once([*command("x.csv"), "--only=D2"]) == 0
    assert '"D1"' not in capfd.readouterr().out
    (folder / "cell.rv").write_text(SPEC.replace("< 100", "< 7"))
    assert judged_at_once(command("x.csv")) == 1


def test_a_specification_that_comes_through_a_pipe_is_left_as_it_is(folder):
    """Nobody else could read it again."""
    os.mkfifo(folder / "pipe.rv")
    (folder / "plain.csv").write_text(PLAIN)
    words = ["run", "pipe.rv", "plain.csv", "--engine", "c", "--format", "json"]
    assert judged_at_once(words) is None


def test_what_is_compiled_is_the_text_that_was_read(folder, monkeypatch, capfd):
    """A file that changes meanwhile changes nothing that is kept."""
    (folder / "plain.csv").write_text(PLAIN)
    path = folder / "cell.rv"
    path.write_text(SPEC.replace("parts < 100", "parts < 101"))
    read = type(path).read_text

    def read_and_change(self, *given, **options):
        text = read(self, *given, **options)
        if self.name == "cell.rv":
            path.write_text(SPEC.replace("parts < 100", "parts > 101"))
        return text

    monkeypatch.setattr(type(path), "read_text", read_and_change)
    judged_at_once(command("plain.csv"))
    assert json.loads(capfd.readouterr().out)["requirements"]["D2"]["verdict"] == "P"


@pytest.mark.parametrize(
    "text",
    [
        "t,closed,knock\n0,1,0\n1,1,1\n",
        HEAD + "".join(f"{20 * k},1,5,0\n" for k in range(30)),
    ],
    ids=["lacks a name", "milliseconds"],
)
def test_what_there_is_to_say_of_a_recording_is_left_to_the_ordinary_way(folder, capfd, text):
    """A name without a column is an error, and stamps that look like milliseconds are doubted."""
    (folder / "x.csv").write_text(text)
    assert judged_at_once(command("x.csv")) is None
    assert not capfd.readouterr().out


def test_a_damaged_program_is_made_anew(folder, capfd, monkeypatch):
    """It is looked at before it is run."""
    (folder / "x.csv").write_text(PLAIN)
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    code = judged_at_once(command("x.csv"))
    (program,) = (folder / "rvmon").glob("*.program")
    whole = program.read_bytes()
    program.write_bytes(b"#!/bin/sh\nexit 0\n")
    assert judged_at_once(command("x.csv")) == code == 1
    assert program.read_bytes() == whole
