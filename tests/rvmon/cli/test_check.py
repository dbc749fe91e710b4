"""`rvmon check`: findings, forms, exit codes."""

import io
import json
import os
import subprocess
import sys

import pytest

from rvmon.cli import main

GOOD = "spec demo\nevent a, b\nrequirement R upon a then within 3 s b\n"
WARNED = "spec demo\nevent a, b, c\nrequirement R upon a then within 3 s b\n"
WRONG = "spec demo\nevent a, b\nrequirement R upon a then within 3 s bb\n"


@pytest.fixture
def write(tmp_path):
    """Write a file, return its path as text."""

    def written(name, text):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return str(path)

    return written


def test_file_in_order(write, capsys):
    """Nothing to report is 0."""
    assert main(["check", write("a.rv", GOOD)]) == 0
    assert capsys.readouterr().out == "1 file: nothing to report\n"


def test_warnings_and_strict(write, capsys):
    """Warnings are printed and cost nothing, unless asked."""
    path = write("a.rv", WARNED)
    assert main(["check", path]) == 0
    shown = capsys.readouterr()
    assert "warning[RV046 never-read]: event `c`" in shown.err
    assert shown.out == "1 file: 1 warning\n"
    assert main(["check", "--strict", path]) == 1


def test_errors_of_several_files(write, capsys):
    """All files are checked, and errors are 2."""
    paths = [write("a.rv", WRONG), write("b.rv", GOOD), write("c.rv", WRONG)]
    assert main(["check", *paths]) == 2
    shown = capsys.readouterr()
    assert shown.err.count("error[RV012 unknown-signal]: no signal or event named `bb`") == 2
    assert shown.out == "3 files: 2 errors\n"


def test_concise_and_json(write, capsys):
    """One line per finding, or JSON on standard output."""
    path = write("a.rv", WRONG)
    assert main(["check", "--format", "concise", path]) == 2
    assert capsys.readouterr().err.startswith(f"{path}:3:38: error[RV012 unknown-signal]")
    assert main(["check", "--format", "json", path]) == 2
    (finding,) = json.loads(capsys.readouterr().out)
    assert finding["spans"][0]["start"]["line"] == 3
    assert main(["check", "--format", "json", write("b.rv", GOOD)]) == 0
    assert json.loads(capsys.readouterr().out) == []


def test_an_imported_file_is_reported_once(write, capsys):
    """An error in a file that two others import is one error, with the place in that file."""
    write("names.rv", "signal a : boool\n")
    paths = [write(name, f'import "names.rv"\nevent e{name[0]}\n') for name in ("a.rv", "b.rv")]
    assert main(["check", *paths]) == 2
    shown = capsys.readouterr()
    assert shown.err.count("error[RV001 syntax]") == 1
    assert "names.rv:1:12" in shown.err
    assert "did you mean `bool`?" in shown.err


def test_an_empty_file_is_said(write, capsys):
    """A file in which there is nothing is a warning, not a success."""
    assert main(["check", write("a.rv", "# nothing\n")]) == 0
    shown = capsys.readouterr()
    assert "warning[RV007 empty-file]: there is nothing in this file" in shown.err
    assert shown.out == "1 file: 1 warning\n"


@pytest.mark.parametrize("content", [b"\xff\xfe\x00\x01", None])
def test_unreadable_files(write, tmp_path, capsys, content):
    """A binary or missing file is one line and 2."""
    path = write("a.rv", content) if content else str(tmp_path / "missing.rv")
    assert main(["check", path]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_constants(write, capsys):
    """Constants are overridden; a malformed override is said."""
    path = write("a.rv", "const T = 3 s\nevent a\nrequirement R upon a then within T not a\n")
    assert main(["check", "--const", "T=2 s", path]) == 0
    assert main(["check", "--const", "T=2 m", path]) == 2
    assert "no-duration" in capsys.readouterr().err
    assert main(["check", "--const", "T", path]) == 2
    assert "expected NAME=VALUE" in capsys.readouterr().err


def test_standard_input(monkeypatch, capsys):
    """`-` is standard input."""
    monkeypatch.setattr("sys.stdin", io.StringIO(WRONG))
    assert main(["check", "-"]) == 2
    assert "<stdin>:3:38" in capsys.readouterr().err


@pytest.mark.parametrize("seconds", ["nan", "-1", "inf", "x"])
def test_the_budget_is_a_number_of_seconds(write, capsys, seconds):
    """A budget that is none is refused before anything is read."""
    assert main(["check", write("a.rv", GOOD), "--analyse", f"--seconds={seconds}"]) == 2
    assert "--seconds" in capsys.readouterr().err


@pytest.mark.process
def test_a_narrow_terminal_encoding_costs_signs_only(tmp_path):
    """What the terminal's encoding lacks is replaced; there is no traceback and no other code."""
    path = tmp_path / "a.rv"
    path.write_text("signal größe : real\nrequirement R always größe > 1\n", encoding="utf-8")
    command = [sys.executable, "-m", "rvmon", "explain", str(path), "R"]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(command, capture_output=True, env=environment, check=False)  # noqa: S603
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"gr??e is above 1" in done.stdout
