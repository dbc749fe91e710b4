"""The page about explanations shows what the commands really print."""

import re
import shlex
from pathlib import Path

import pytest

from rvmon.cli import main

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "know-your-spec.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```console\n\$ (.+?)\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize(("command", "output"), EXAMPLES, ids=[one[0] for one in EXAMPLES])
def test_examples_of_the_page(command, output, monkeypatch, capsys):
    """Every command on the page prints what stands below it."""
    monkeypatch.chdir(ROOT)
    assert main(shlex.split(command)[1:]) == 0
    shown = [line.rstrip() for line in capsys.readouterr().out.rstrip().splitlines()]
    assert shown == output.rstrip().splitlines()


def test_there_are_examples():
    """The page shows all four commands but the one whose findings go to standard error."""
    assert {shlex.split(command)[1] for command, _ in EXAMPLES} == {"init", "explain", "why"}
