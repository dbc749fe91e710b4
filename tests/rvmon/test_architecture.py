"""The page of representations names functions and types that are there."""

import inspect
import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
PASSES = re.findall(r"\| `(\S+)\.py`<br>`(\w+)` \| `(\w+)` →<br>`(\w+)` \|", PAGE)


def test_every_row_is_read():
    """No row of the table has a form that the next test would pass over."""
    assert len(PASSES) == PAGE.count("\n| ") - 1 > 10


@pytest.mark.parametrize(("path", "function", "taken", "given"), PASSES)
def test_a_pass_takes_and_gives_what_its_row_says(path, function, taken, given):
    found = getattr(import_module(f"rvmon.{path.replace('/', '.')}"), function)
    signature = inspect.signature(found)
    parameters = " ".join(str(one.annotation) for one in signature.parameters.values())
    assert re.search(rf"\b{taken}\b", parameters)
    assert re.search(rf"\b{given}\b", str(signature.return_annotation))
