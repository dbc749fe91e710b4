"""Long work shows its progress on a terminal."""

import io
from contextlib import redirect_stderr

import pytest

from rvmon.cli import main, output

pytestmark = pytest.mark.slow


class Screen(io.StringIO):
    """A terminal."""

    def isatty(self):
        return True


@pytest.fixture
def screen(tmp_path, monkeypatch):
    """A terminal that shows progress at once, in a folder with a specification and recordings."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.rv").write_text("spec s\nsignal p : bool\nrequirement R\n  always p\n")
    for name in ("one", "two"):
        rows = (f'{{"t": {number}, "p": true}}\n' for number in range(9000))
        (tmp_path / f"{name}.jsonl").write_text("".join(rows))
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(output, "PATIENCE_S", 0)
    return Screen()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("run s.rv one.jsonl two.jsonl --jobs 1", "recordings"),
        ("run s.rv one.jsonl two.jsonl --jobs 2", "recordings"),
        ("run s.rv one.jsonl", "one.jsonl"),
        ("check s.rv --analyse", "analysing s.rv"),
    ],
)
def test_progress_is_shown_for_long_work_only(screen, monkeypatch, words, told):
    """Several recordings are counted; one shows its share read. An analysis is named at once."""
    with redirect_stderr(screen):
        assert main(words.split()) == 0
    assert told in screen.getvalue()
    assert ("one.jsonl" in screen.getvalue()) is (told == "one.jsonl")
    monkeypatch.setattr(output, "PATIENCE_S", 1e9)
    with redirect_stderr(short := Screen()):
        assert main(words.split()) == 0
    assert (short.getvalue() == "") is words.startswith("run")
