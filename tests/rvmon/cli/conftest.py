"""What tests of several commands begin with: a door that is to open when somebody knocks."""

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
    """The current folder, with the specification."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "door.rv").write_text(DOOR)
    return tmp_path
