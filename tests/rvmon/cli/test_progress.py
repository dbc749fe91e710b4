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


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_recordings_are_counted(screen, jobs):
    with redirect_stderr(screen):
        assert main(["run", "s.rv", "one.jsonl", "two.jsonl", "--jobs", jobs]) == 0
    assert "recordings" in screen.getvalue()
    assert "one.jsonl" not in screen.getvalue()


def test_a_single_recording_shows_how_far_it_is_read(screen):
    with redirect_stderr(screen):
        assert main(["run", "s.rv", "one.jsonl"]) == 0
    assert "one.jsonl" in screen.getvalue()


def test_short_work_and_files_show_no_bar(screen, monkeypatch):
    monkeypatch.setattr(output, "PATIENCE_S", 1e9)
    with redirect_stderr(screen):
        assert main(["run", "s.rv", "one.jsonl", "two.jsonl"]) == 0
    assert screen.getvalue() == ""


def test_what_nobody_can_count_is_named_while_it_lasts(screen):
    with redirect_stderr(screen):
        assert main(["check", "s.rv", "--analyse"]) == 0
    assert "analysing s.rv" in screen.getvalue()
