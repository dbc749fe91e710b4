"""The page about monitors in long-running programs does what it says."""

import re
from pathlib import Path

import pytest

from rvmon.cli import main

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "online.md").read_text(encoding="utf-8")


@pytest.mark.process
def test_the_code_runs(capsys):
    """The blocks run one after the other; the timer finds the missed deadline a tick behind it."""
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(block, names)  # noqa: S102 - our own page
    assert capsys.readouterr().out == "D1 F 2000000001\n"


def test_the_table_of_costs_is_what_the_command_prints(capsys):
    """What is shown is the output."""
    [shown] = re.findall(r"```console\n\$ rvmon compile .*?\n(.*?)```", PAGE, re.DOTALL)
    assert main(["compile", str(ROOT / "specs" / "handover.rv"), "--to", "costs"]) == 0
    assert capsys.readouterr().out == shown
