"""A specification shared by tests of several commands: a door has to open after a knock."""

import pytest

DOOR = """
spec door "A door"
signal closed : bool input
event knock input
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
"""
LABELLED = DOOR.replace("requirement D1", "requirement D0") + (
    "  severity high\n  tags safety, knocks\n"
    "requirement D1\n  always closed\n  severity low\n  tags safety\n"
    "requirement D2\n  always not closed\n"
)


@pytest.fixture
def door(tmp_path, monkeypatch):
    """The current folder, with `door.rv`."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "door.rv").write_text(DOOR)
    return tmp_path


@pytest.fixture
def put(tmp_path, monkeypatch):
    """Make an empty folder the current one; a call writes a file there and returns its name."""
    monkeypatch.chdir(tmp_path)

    def written(name, text):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return name

    return written
