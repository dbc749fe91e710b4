"""Help lists the commands, and its examples run."""

import glob
import re
import shlex
import shutil
from pathlib import Path

import pytest

import handover.cli
from rvmon.cli import COMMANDS, _parser, main

ROOT = Path(__file__).parents[3]
PARSED = {"lsp", "watch"}
"""Commands whose examples are parsed only: they need an editor or a stream."""
HANDOVER = ("run", "demo", "close", "replay", "shrink", "mutate", "evidence")


def examples(program, words, capsys):
    """The command lines that help shows as examples."""
    assert program([*words.split(), "--help"]) == 0
    shown = capsys.readouterr().out
    assert len(shown.splitlines()[0]) <= 80
    lines = re.split(r"\nexamples?:\n", shown)[1].splitlines()
    return [one for line in lines for one in re.split(r" && | \| | > .+? && ", line.strip())]


def test_all_commands_but_that_for_editors_fit_a_screen_of_24_lines(says):
    lines = says(0, "--help").out.splitlines()
    assert len(lines) <= 24
    assert max(map(len, lines)) <= 80
    assert {line.split()[0] for line in lines if line.startswith("  ")} == {
        *COMMANDS,
        "rvmon",  # of the example
    } - {"lsp"}


@pytest.mark.slow
@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_every_example_of_help_runs(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    for name in ("examples", "specs"):
        shutil.copytree(ROOT / name, tmp_path / name)
    own = 0
    if command == "evidence":
        main(["run", "examples/base.rv", "examples/base.csv", "--evidence", "base.zip"])
        capsys.readouterr()
    for one in examples(main, command, capsys):
        words = [found for word in shlex.split(one) for found in glob.glob(word) or [word]]
        if words[0] == "rvmon":
            own += 1
            assert _parser(words[1:]).parse_args(words[1:])
            if command not in PARSED and "monday.bag" not in words:
                assert main(words[1:]) in (0, 1), one
    assert own


@pytest.mark.parametrize("command", HANDOVER)
def test_every_example_of_handover_is_understood(command, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    for one in examples(handover.cli.main, command, capsys):
        program, *words = shlex.split(one)
        assert (program, " ".join(words).startswith(("run", command))) == ("handover", True)
        assert handover.cli._parser().parse_args(words)
