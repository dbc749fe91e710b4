"""Long work shows at a terminal how far it is."""

import io
from contextlib import redirect_stderr

import pytest

from rvmon.cli import main, output

pytestmark = pytest.mark.slow


class Screen(io.StringIO):
    """A terminal."""

    def isatty(self):
        """It is one."""
        return True


@pytest.fixture
def screen(tmp_path, monkeypatch):
    """A terminal whose user has no patience, beside a specification and recordings."""
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
def test_long_work_says_how_far_it_is_and_short_work_nothing(screen, monkeypatch, words, told):
    """Recordings are counted, a single one by what was read; what nobody can count is named.

    That at once, as it may last.
    """
    with redirect_stderr(screen):
        assert main(words.split()) == 0
    assert told in screen.getvalue()
    assert ("one.jsonl" in screen.getvalue()) is (told == "one.jsonl")
    monkeypatch.setattr(output, "PATIENCE_S", 1e9)
    with redirect_stderr(short := Screen()):
        assert main(words.split()) == 0
    assert (short.getvalue() == "") is words.startswith("run")
