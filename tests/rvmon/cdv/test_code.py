"""Blocks of code, and which of their statements and branches ran."""

import importlib.util

import pytest

from rvmon import cdv
from rvmon.cdv.code_coverage import Meter, code_groups
from rvmon.errors import RvmonError, UnknownNameError


def loaded(path):
    """The file as a module."""
    found = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_each_function_is_a_block(code):
    """By its qualified name, without the line that defines it."""
    blocks = {block.name: sorted(block.lines) for block in cdv.blocks_of(code)}
    assert blocks == {"Toy.climb": [4, 5, 6], "Toy.high": [9], "helper": [12]}


def test_functions_can_be_grouped(code):
    """Those that are not named are common."""
    names = {"Toy.climb": "climbing", "Toy.high": "climbing"}
    blocks = {block.name: sorted(block.lines) for block in cdv.blocks_of(code, names)}
    assert blocks == {"climbing": [4, 5, 6, 9], "common": [12]}


def test_what_ran_is_hit(code):
    """Statements by line, branches by the lines that they lead from and to, test by test."""
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
        meter.begin()
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


def test_only_the_marked_code_is_measured_where_it_is_marked(campaign, code):
    """What else runs the file counts for nothing."""
    from rvmon.cdv.play import player

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
        outcome, _ = player(chosen.robots, measured, None)(_job(chosen))
        return {group: list(items) for group, items in outcome.hits.items()}

    climbing = {"statements of Toy.climb": ["4", "6"]}
    assert statements(marked=True) == climbing
    assert statements(marked=False) == {**climbing, "statements of Toy.high": ["9"]}


def _job(campaign):
    from rvmon.cdv.plan import plan

    return plan(campaign).jobs()[0]


def test_blocks_of_one_name_are_told(code):
    """Their hits could not be told apart."""
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
    """With the file, before anything is played."""
    path = tmp_path / "x.py"
    if text is not None:
        path.write_text(text)
    with pytest.raises((RvmonError, UnknownNameError), match=told) as caught:
        cdv.blocks_of(path, names)
    assert "x.py" in str(caught.value)
