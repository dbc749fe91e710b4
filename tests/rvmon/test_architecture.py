"""The page on the architecture names existing functions and their types."""

import inspect
import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
PASSES = re.findall(r"\| `(\S+)\.py`<br>`(\w+)` \| `(\w+)` →<br>`(\w+)` \|", PAGE)


def test_every_row_of_the_table_is_understood():
    assert len(PASSES) == PAGE.count("\n| ") - 1 > 10


@pytest.mark.parametrize(("path", "function", "taken", "given"), PASSES)
def test_a_pass_has_the_types_of_its_row(path, function, taken, given):
    found = getattr(import_module(f"rvmon.{path.replace('/', '.')}"), function)
    signature = inspect.signature(found)
    parameters = " ".join(str(one.annotation) for one in signature.parameters.values())
    assert re.search(rf"\b{taken}\b", parameters)
    assert re.search(rf"\b{given}\b", str(signature.return_annotation))
