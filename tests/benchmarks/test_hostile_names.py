"""Names that are hostile to some output come through all of them as names."""

from __future__ import annotations

import pytest
from benchmarks.hostile_names import WRITERS, Documents, main
from tests.tools.hostile import FORGERIES


@pytest.fixture(scope="module")
def documents() -> Documents:
    """What is made of each way that is known."""
    return Documents([name for name in FORGERIES if name.strip()])


@pytest.mark.slow
@pytest.mark.parametrize("writer", WRITERS, ids=lambda writer: writer.__name__)
def test_what_is_written_reads_back_as_names(documents, writer):
    """JSON, the terminal, JUnit XML, CSV, LaTeX, HTML, strings of DOT, UPPAAL's XML, messages."""
    assert writer(documents)


@pytest.mark.slow
def test_every_command_shows_names_and_obeys_none(capsys):
    """Also in what it refuses."""
    assert main(["--names", "40", "--through-commands", "40"]) == 0
    assert "run, json                40 names, 0 documents wrong" in capsys.readouterr().out
