"""The page about coverage shows what the commands really print, for the files as it writes them."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from rvmon.cli import main

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "how-to" / "measure-coverage.md").read_text(encoding="utf-8")
STEPS = re.findall(r"```(rv|csv|console)\n(.*?)```", PAGE, re.DOTALL)
FILES = {"rv": "base.rv", "csv": "second.csv"}


@pytest.mark.slow
def test_the_page_is_true(tmp_path, monkeypatch, capsys):
    """Files are written and commands run in the page's order; each prints what stands below it."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "examples" / "base.csv", tmp_path)
    commands = []
    for kind, text in STEPS:
        if kind != "console":
            Path(FILES[kind]).write_text(text, encoding="utf-8")
            continue
        command, _, output = text.removeprefix("$ ").partition("\n")
        commands.append(command.split()[1])
        main(shlex.split(command)[1:])
        shown = capsys.readouterr()
        lines = [line.rstrip() for line in (shown.err + shown.out).rstrip().splitlines()]
        assert lines == output.rstrip().splitlines(), command
    assert set(commands) == {"run", "cover"}
