"""Files stay short: one that does not fit a few screens has more than one job, and is split."""

from pathlib import Path

SOURCES = Path(__file__).parents[1] / "src"
MOST_LINES = 400


def test_no_file_is_long():
    """No file of `src` has more lines than 400."""
    lines = {
        path.relative_to(SOURCES).as_posix(): len(path.read_text(encoding="utf-8").splitlines())
        for path in SOURCES.rglob("*.py")
    }
    assert lines
    assert not {name: n for name, n in lines.items() if n > MOST_LINES}
