"""The examples about many recordings work as described."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rvmon.cli import main

EXAMPLES = Path(__file__).parents[3] / "examples"
NIGHTLY = EXAMPLES / "nightly"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Two logs in which B1 and B2 fail once each."""
    (tmp_path / "logs").mkdir()
    for name in ("a", "b"):
        shutil.copy(EXAMPLES / "base.csv", tmp_path / "logs" / f"{name}.csv")
    shutil.copy(EXAMPLES / "base.rv", tmp_path)
    shutil.copy(NIGHTLY / "known.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.process
def test_logs_become_a_table_that_is_asked(folder):
    pytest.importorskip("duckdb")
    words = [sys.executable, str(NIGHTLY / "nightly.py"), "logs", "v.parquet"]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=120)  # noqa: S603
    assert done.stdout.splitlines() == [
        "B1 fails 1 of 1 times in a.csv, up to 0 s",
        "B2 fails 1 of 2 times in a.csv, up to 1.3 s",
        "B1 fails 1 of 1 times in b.csv, up to 0 s",
        "B2 fails 1 of 2 times in b.csv, up to 1.3 s",
    ]


def test_the_notebook_runs(folder, monkeypatch):
    pytest.importorskip("pandas")
    (folder / "nightly").mkdir()
    (folder / "logs").rename(folder / "nightly" / "logs")
    monkeypatch.chdir(folder / "nightly")
    book = json.loads((NIGHTLY / "failures.ipynb").read_text(encoding="utf-8"))
    names = {}
    for cell in book["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)  # noqa: S102 - ours
    assert names["failed"]["attempt"].tolist() == ["B1#1", "B2#2"] * 2


@pytest.mark.slow
def test_the_job_runs(folder, capsys):
    job = (NIGHTLY / "ci.yml").read_text(encoding="utf-8")
    commands = re.findall(r"- run: rvmon (.*)", job)
    assert len(commands) == 2
    for command in commands:
        words = shlex.split(command.replace("logs/*.csv", "logs/a.csv logs/b.csv"))
        assert main(words) == 0, command
    assert "B2 in logs/a.csv failed as known" in capsys.readouterr().err
    (folder / "known.toml").write_text("")
    assert main(words) == 1
    assert (folder / "pages" / "index.html").exists()
