"""Blocks of code, and their executed statements and branches."""

import importlib.util
import xml.etree.ElementTree as ET

import pytest

from rvmon import cdv
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.code_coverage import Meter, cobertura, code_groups, lcov
from rvmon.cdv.play import player
from rvmon.coverage import Hit, model_of, without
from rvmon.errors import RvmonError, UnknownNameError


def loaded(path):
    found = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_each_function_is_a_block_unless_they_are_grouped(code):
    blocks = {block.name: sorted(block.lines) for block in cdv.blocks_of(code)}
    assert blocks == {"Toy.climb": [4, 5, 6], "Toy.high": [9], "helper": [12]}
    names = {"Toy.climb": "climbing", "Toy.high": "climbing"}
    blocks = {block.name: sorted(block.lines) for block in cdv.blocks_of(code, names)}
    assert blocks == {"climbing": [4, 5, 6, 9], "common": [12]}


@pytest.mark.slow
def test_what_ran_is_hit(code):
    toy = loaded(code).Toy()
    measured = cdv.Code(cdv.blocks_of(code))
    groups = {group.name: list(group.items) for group in code_groups(measured)}
    assert groups == {
        "statements of Toy.climb": ["4", "5", "6"],
        "branches of Toy.climb": ["4 → 5", "4 → 6"],
        "statements of Toy.high": ["9"],
        "statements of helper": ["12"],
    }
    meter = Meter(measured)
    found = []
    for level in (1, 6):
        meter.start()
        with meter:
            toy.climb(level)
        found.append({group: list(items) for group, items in meter.hits().items()})
    assert found == [
        {"statements of Toy.climb": ["4", "6"], "branches of Toy.climb": ["4 → 6"]},
        {
            "statements of Toy.climb": ["4", "5"],
            "branches of Toy.climb": ["4 → 5"],
            "statements of Toy.high": ["9"],
        },
    ]


@pytest.mark.slow
def test_only_the_marked_code_is_measured_where_it_is_marked(campaign, code):
    toy = loaded(code).Toy()

    class System:
        def play(self, test, observer):
            toy.high()
            with observer.code():
                toy.climb(1)
            return cdv.Run(0)

    def statements(*, marked):
        measured = cdv.Code(cdv.blocks_of(code), branches=False, marked=marked)
        chosen = campaign(("a", {}), robots={"toy": cdv.Robot(System, None)})
        (job,) = plan(chosen).jobs()
        outcome, _ = player(chosen.robots, measured, None)(job)
        return {group: list(items) for group, items in outcome.hits.items()}

    climbing = {"statements of Toy.climb": ["4", "6"]}
    assert statements(marked=True) == climbing
    assert statements(marked=False) == {**climbing, "statements of Toy.high": ["9"]}


def test_blocks_with_the_same_name_are_refused(code):
    """Their hits could not be distinguished."""
    with pytest.raises(RvmonError, match=r"two blocks are called `Toy.climb`, in .*toy.py"):
        cdv.Code((*cdv.blocks_of(code), *cdv.blocks_of(code)))


@pytest.mark.parametrize(
    ("text", "names", "told"),
    [
        (None, None, "No such file"),
        ("def f(:", None, "not Python"),
        ("def f():\n  pass\n", {"g": "x"}, "no function `g`: there are f"),
    ],
)
def test_wrong_code_is_told(tmp_path, text, names, told):
    path = tmp_path / "x.py"
    if text is not None:
        path.write_text(text)
    with pytest.raises((RvmonError, UnknownNameError), match=told) as caught:
        cdv.blocks_of(path, names)
    assert "x.py" in str(caught.value)


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
    """The blocks of a file and their items of coverage."""
    monkeypatch.chdir(code.parent)
    blocks = cdv.Code(cdv.blocks_of(code))
    return blocks, model_of(code_groups(blocks))


def test_lcov(measured, code):
    """Lines with the number of tests; a branch not taken is 0, or `-` if its line never ran."""
    blocks, model = measured
    assert lcov(blocks, model, HITS) == LCOV.format(path=code.name)
    assert "BRDA:4,0,0,-" in lcov(blocks, model, {})
    assert "DA:9" not in lcov(blocks, without(model, [("statements of Toy.high", "9")]), HITS)


def test_cobertura(measured, code):
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
