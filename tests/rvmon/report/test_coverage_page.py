"""The page of coverage: its content, its links, and that names never become markup."""

import re

import pytest
from tests.rvmon.report.reader import Reader
from tests.tools.covered import SECOND, door_model, fill, hits_of
from tests.tools.hostile import hostile_names

from rvmon.coverage import Group, Item, Subject, TestRecord, combination, group_of, model_of
from rvmon.coverage.database import Database
from rvmon.report import coverage_page as pages
from rvmon.report.coverage_page import coverage_page
from rvmon.report.coverage_summary import Summary


@pytest.fixture
def door():
    with Database.in_memory() as database:
        fill(database)
        yield database


def page_of(database, earlier=None):
    before = None if earlier is None else earlier.coverage()
    return coverage_page(Summary("door.cov", database.coverage(), before, "old.cov"))


@pytest.mark.slow
def test_what_is_wrong_stands_first(door):
    read = Reader(page_of(door))
    parts = [
        "46 % covered, 1 illegal item hit, 2 of 4 tests with problems, 6 holes",
        "situation: no × touch 1 hit by 1 test, first wild-1 at 7 s",
        "crashed: ZeroDivisionError: the gap is 0: 1 test wild-2",
        "total 46 %",
        "Holes 6",
        "near: far never hit : the arm is 1 m long: far begins at 1 m",
        "Verdicts random 2 directed 2 P F NT I P F NT I D1 2 0 0 0 0 1 0 0",
        "3 of 4 tests suffice for the same coverage, the minimum: calm-2 wild-2 wild-1",
        "Number of tests: P passed F failed NT not triggered I inconclusive",
    ]
    places = [read.text.find(part) for part in parts]
    assert -1 not in places, dict(zip(parts, places, strict=True))
    assert places == sorted(places)


def test_every_link_leads_somewhere(door):
    page = page_of(door)
    read = Reader(page)
    assert read.dangling() == set()
    links = [attributes["href"] for tag, attributes in read.tags if tag == "a"]
    look = door.coverage().items.index(("gaze", "yes"))
    assert f"#i{look}" in links
    assert {"#t0", "#t1", "#t2", "#t3", "#g2"} <= set(links)
    assert not re.search(r"https?:|<script|<link|url\(", page)


def test_a_cross_is_a_heat_map(door):
    looks = [
        attributes.get("class")
        for tag, attributes in Reader(page_of(door)).tags
        if tag == "td" and attributes.get("class") in {"covered", "hole", "ignored", "illegal hit"}
    ]
    assert looks[:6] == ["covered", "hole", "ignored", "illegal hit", "hole", "hole"]


def test_the_growth_of_all_and_of_each_strategy(door):
    read = Reader(page_of(door))
    lines = [attributes for tag, attributes in read.tags if tag == "polyline"]
    assert [line["class"] for line in lines] == ["all", "s0", "s1"]
    assert lines[0]["points"].startswith("0,100 250,100 250,")
    dots = [a for tag, a in read.tags if tag == "a" and a.get("class", "").startswith("dot")]
    assert [(dot["class"], dot["href"]) for dot in dots] == [
        ("dot s0", "#t0"),
        ("dot s0", "#t1"),
        ("dot s1", "#t3"),
    ]
    assert "random alone: 33 % with 2 tests" in read.text


def test_campaigns_are_compared(door):
    with Database.in_memory() as later:
        later.declare(door_model())
        later.record(
            TestRecord("calm-1", "week 2", "random", seed=1, verdicts={"D1": "F"}),
            hits_of(("near", "far")),
        )
        read = Reader(page_of(later, door))
    assert "old.cov : 46 % → 8 %" in read.text
    assert "Newly covered 1 near: far" in read.text
    assert "calm-1: D1 P → F" in read.text
    assert read.dangling() == set()


def test_expected_failures_are_listed_apart(door):
    """With their reason; other failures of the same test count."""
    failed = {"D1": "F", "D2": "F", "D3": "P"}
    why = {"D1": "the grip is worn", "D3": "it may"}
    door.record(TestRecord("worn", "week 2", verdicts=failed, expected=why), {})
    door.record(TestRecord("old", "week 2", verdicts={"D1": "F"}, expected=why), {})
    read = Reader(page_of(door))
    assert "Failed as expected D1: the grip is worn: 2 tests worn old" in read.text
    assert "F D2: 1 test worn" in read.text
    assert "D3: it may" not in read.text
    assert "completed F D2, F D1 as expected, 1 P" in read.text
    assert read.dangling() == set()


def test_of_many_tests_those_have_a_line_that_are_spoken_of(door, monkeypatch):
    monkeypatch.setattr(pages, "MOST", 10)
    for number in range(50):
        record = TestRecord(f"dull-{number}", "week 2", number=number, when=90 * SECOND)
        door.record(record, hits_of(("gaze", "yes")))
    read = Reader(page_of(door))
    assert "Not listed: 50 tests without problems that added nothing" in read.text
    assert read.dangling() == set()


@pytest.mark.slow
def test_names_are_no_markup():
    def elements(names):
        axes = {names[0]: names[:9], names[1]: names[9:12], names[2]: names[:2]}
        crossed = [
            combination([one, two, three])
            for one in names[:9]
            for two in names[9:12]
            for three in names[:2]
        ]
        groups = [
            group_of(names[5], Subject.COVERPOINT, [Item(name) for name in names]),
            Group(names[6], Subject.CROSS, {name: Item(name) for name in crossed}, axes=axes),
        ]
        with Database.in_memory() as database:
            database.declare(model_of(groups))
            for when, name in enumerate(names):
                record = TestRecord(
                    name, name, name, error=name, ending="hung", verdicts={name: "F"}, when=when
                )
                database.record(record, hits_of((names[5], name)))
                database.explain(names[6], crossed[0], name)
            read = Reader(page_of(database))
        assert read.dangling() == set()
        return [tag for tag, _ in read.tags]

    hostile = list(hostile_names(40))
    assert elements(hostile) == elements([f"n{number:02}" for number in range(40)])


def test_nothing_is_a_page_too():
    with Database.in_memory() as database:
        assert "nothing to cover" in Reader(page_of(database)).text
        database.declare(door_model())
        read = Reader(page_of(database))
    assert "0 % covered, 11 holes" in read.text
    assert read.dangling() == set()
