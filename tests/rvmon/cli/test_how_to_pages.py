"""How-to pages show what the commands really print, for the files as they write them."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from rvmon.cli import main

ROOT = Path(__file__).parents[3]
PAGES = {
    "measure-coverage": (["base.rv", "second.csv"], {"run", "cover"}),
    "judge-many-recordings": (
        ["base.rv", "monday/a.csv", "monday/b.csv", "tuesday/a.csv", "tuesday/b.csv", "known.toml"],
        {"run", "compare"},
    ),
    "after-an-incident": (["base.rv"], {"clip", "run"}),
    "keep-evidence": (
        ["base.rv", "monday/a.csv", "monday/b.csv", "monday/b.csv"],
        {"run", "evidence"},
    ),
    "watch-a-running-robot": (["base.rv", "robot.jsonl"], {"watch"}),
}
"""The files that a page writes, in its order, and the commands that it shows."""


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_the_page_is_true(tmp_path, monkeypatch, capsys, name):
    """Files are written, commands and programs run in the page's order, and print what it says."""
    page = (ROOT / "docs" / "how-to" / f"{name}.md").read_text(encoding="utf-8")
    files, shown = PAGES[name]
    left = iter(files)
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "examples" / "base.csv", tmp_path)
    commands = set()
    blocks = r"```(rv|csv|jsonl|toml|console|python)\n(.*?)```"
    for kind, text in re.findall(blocks, page, re.DOTALL):
        if kind == "python":
            exec(text, {})  # noqa: S102 - our page
            capsys.readouterr()
        elif kind == "console":
            command, _, output = text.removeprefix("$ ").partition("\n")
            commands.add(command.split()[1])
            main(shlex.split(command)[1:])
            told = capsys.readouterr()
            lines = [line.rstrip() for line in (told.err + told.out).rstrip().splitlines()]
            assert lines == output.rstrip().splitlines(), command
        else:
            path = tmp_path / next(left)
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
    assert commands == shown
    assert next(left, None) is None
