"""What readers of LCOV and Cobertura get: lines and branches that are goals, and who ran them."""

import xml.etree.ElementTree as ET

import pytest

from rvmon import cdv
from rvmon.cdv.code_coverage import cobertura, code_groups, lcov
from rvmon.coverage import Hit, model_of, without

HITS = {
    "statements of Toy.climb": {"4": Hit(3), "6": Hit(2)},
    "branches of Toy.climb": {"4 → 6": Hit(2)},
}
LCOV = """TN:
SF:{path}
BRDA:4,0,0,0
BRDA:4,0,1,2
BRF:2
BRH:1
DA:4,3
DA:5,0
DA:6,2
DA:9,0
DA:12,0
LF:5
LH:2
end_of_record
"""


@pytest.fixture
def measured(code, monkeypatch):
    """The blocks of a file, and what there is to be covered of them."""
    monkeypatch.chdir(code.parent)
    blocks = cdv.Code(cdv.blocks_of(code))
    return blocks, model_of(code_groups(blocks))


def test_lcov(measured, code):
    """Lines with the number of tests; a way not gone is 0, `-` of a line that never ran."""
    blocks, model = measured
    assert lcov(blocks, model, HITS) == LCOV.format(path=code.name)
    assert "BRDA:4,0,0,-" in lcov(blocks, model, {})
    assert "DA:9" not in lcov(blocks, without(model, [("statements of Toy.high", "9")]), HITS)


def test_cobertura(measured, code):
    """The same figures, as rates and per line."""
    root = ET.fromstring(cobertura(*measured, HITS))  # noqa: S314 - our own
    assert (root.get("line-rate"), root.get("lines-covered"), root.get("lines-valid")) == (
        "0.4",
        "2",
        "5",
    )
    assert (root.get("branch-rate"), root.get("branches-valid")) == ("0.5", "2")
    (one,) = root.iter("class")
    assert one.get("filename") == code.name
    lines = {line.get("number"): line for line in one.iter("line")}
    assert lines["4"].get("condition-coverage") == "50% (1/2)"
    assert [lines[number].get("hits") for number in ("4", "5", "6")] == ["3", "0", "2"]
