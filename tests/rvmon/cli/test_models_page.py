"""The page about models shows what the commands really print."""

import re
import shlex
from pathlib import Path

import pytest

from rvmon.cli import main

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "timed-models.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```console\n\$ (.+?)\n(.*?)```", PAGE, re.DOTALL)


def without_times(text):
    """The lines without what a search cost in seconds, which differs."""
    return [re.sub(r"states, [\d.]+ s", "states", line).rstrip() for line in text.splitlines()]


@pytest.mark.parametrize(("command", "output"), EXAMPLES, ids=[one[0] for one in EXAMPLES])
def test_examples_of_the_page(command, output, monkeypatch, capsys):
    """Every command on the page prints what stands below it."""
    monkeypatch.chdir(ROOT)
    main(shlex.split(command)[1:])
    shown = capsys.readouterr()
    assert without_times((shown.out + shown.err).rstrip()) == without_times(output.rstrip())


def test_there_are_examples():
    """The page shows both commands."""
    assert {shlex.split(command)[1] for command, _ in EXAMPLES} == {"verify", "conform"}
    assert len(EXAMPLES) == 6


def test_the_model_of_the_page_is_the_example():
    """The model is shown as it stands in its file."""
    model = (ROOT / "examples" / "models" / "dock.ta").read_text(encoding="utf-8")
    assert f"```\n{model}```" in PAGE


def test_its_links_lead_somewhere():
    """Every file that the page links to exists."""
    for address in re.findall(r"\]\(([^)#]+)\)", PAGE):
        assert address.startswith("https:") or (ROOT / "docs" / address).exists(), address
