"""The page on testing one's own system shows what the example is and prints."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
HERE = ROOT / "docs" / "how-to"
PAGE = (HERE / "test-your-own-system.md").read_text(encoding="utf-8")
EXAMPLE = (ROOT / "examples" / "base_and_people" / "campaign.py").read_text(encoding="utf-8")


def without_times(text):
    """The lines without what the tests took in seconds, which differs."""
    return [re.sub(r"in [\d.]+ s", "in", line).rstrip() for line in text.splitlines()]


@pytest.mark.process
def test_the_command_prints_what_stands_below_it():
    """The table of the page is that of the example."""
    ((command, output),) = re.findall(r"```console\n\$ (.+?)\n(.*?)```", PAGE, re.DOTALL)
    words = [sys.executable, *shlex.split(command)[1:]]
    done = subprocess.run(  # noqa: S603 - our own program
        words, capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert without_times(done.stdout) == without_times(output)


def test_the_code_of_the_page_is_the_examples():
    """Each line stands there as it is, but for what is left out."""
    lines = {line.strip() for line in EXAMPLE.splitlines()}
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    shown = {line.strip() for block in blocks for line in block.splitlines()}
    assert len(blocks) == 3
    assert shown - lines <= {"", "..."}


def test_its_links_lead_somewhere():
    """Every file that the page links to exists."""
    for address in re.findall(r"\]\(([^)#]+)", PAGE):
        assert (HERE / address).exists(), address
