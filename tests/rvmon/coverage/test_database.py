"""Coverage databases: what is written is read back completely, once, and by name."""

import pytest
from msgspec.structs import replace
from tests.tools.covered import door_model, dump, fill, hits_of
from tests.tools.hostile import hostile_names

from rvmon.coverage import (
    Ending,
    Group,
    Hit,
    Item,
    Subject,
    TestRecord,
    database_file,
    group_of,
    model_of,
)
from rvmon.coverage.analysis import Answers
from rvmon.coverage.database import Database, read
from rvmon.errors import CoverageError
from rvmon.language.checked.properties import BinKind
from rvmon.verdicts import Verdict


@pytest.fixture
def path(tmp_path):
    return tmp_path / "door.cov"


def test_what_is_written_is_read_back(path):
    with Database.open(path) as database:
        fill(database)
        before = dump(database)
    with Database.open(path) as database:
        assert dump(database) == before
    coverage = read([path])
    assert coverage.model == door_model()
    assert [entry.record.name for entry in coverage.entries] == [
        "calm-1",
        "calm-2",
        "wild-1",
        "wild-2",
    ]
    last = coverage.entries[-1].record
    assert (last.ending, last.error) == (Ending.CRASHED, "ZeroDivisionError: the gap is 0")
    assert coverage.reasons == {("near", "far"): ["the arm is 1 m long: `far` begins at 1 m"]}


def test_what_cannot_be_hit_is_no_goal(path):
    other = path.with_name("other.cov")
    for one, said in ((path, False), (other, True)):
        with Database.open(one) as database:
            fill(database)
            if said:
                database.exclude("near", "reach", "the arm is short")
    goals = [
        Answers(read(paths)).goals for paths in ([path], [other], [path, other], [other, path])
    ]
    assert [int(one.wanted.sum()) for one in goals] == [11, 10, 10, 10]
    assert read([other, path]).unreachable == {("near", "reach"): ["the arm is short"]}
    with Database.open(path) as database, pytest.raises(CoverageError, match="there is no item"):
        database.exclude("near", "nowhere", "why")


def test_a_test_is_written_once(path):
    """If a test is recorded again, the earlier record stays; another seed is another test."""
    test = TestRecord("t", "k", seed=2**70, when=5, seconds=1.0)
    hits = hits_of(("gaze", "yes"), first=3)
    with Database.open(path) as database:
        database.declare(door_model())
        for one in (test, replace(test, when=9, seconds=0.5), replace(test, when=2, seconds=3.0)):
            database.record(one, hits)
        [entry] = database.coverage().entries
        assert (entry.record.when, entry.record.seconds, entry.record.seed) == (2, 3.0, 2**70)
        assert entry.row.firsts.tolist() == [3]
        database.record(replace(test, seed=-1), hits)
        assert len(database.coverage().entries) == 2
        database.record(test, {})
        assert len(database.coverage().entries) == 3


def test_tests_are_in_the_order_of_their_campaigns():
    """Campaigns by their start; within one by number, then by time."""
    with Database.in_memory() as database:
        database.declare(door_model())
        for name, campaign, number, when in [
            ("d", "a", 0, 10),
            ("b", "z", 2, 1),
            ("a", "z", 1, 3),
            ("c", "z", 2, 2),
        ]:
            database.record(TestRecord(name, campaign, number=number, when=when), {})
        order = "".join(entry.record.name for entry in database.coverage().entries)
    assert order == "abcd"


def test_a_model_may_grow(path):
    small = group_of("g", Subject.COVERPOINT, [Item("b")])
    large = group_of("g", Subject.COVERPOINT, [Item("a"), Item("b"), Item("c")])
    with Database.open(path) as database, Database.open(path) as other:
        database.declare(model_of([small]))
        database.record(TestRecord("t", when=0), hits_of(("g", "b")))
        other.declare(model_of([large]))
        database.record(TestRecord("u", when=1), hits_of(("g", "a"), ("g", "c")))
    coverage = read([path])
    hit = [[coverage.items[place][1] for place in one.row.items] for one in coverage.entries]
    assert hit == [["b"], ["a", "c"]]
    assert sorted(coverage.model.groups["g"].items) == ["a", "b", "c"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("other", "told"),
    [
        (group_of("g", Subject.COVERPOINT, [Item("a", goal=2)]), "item `a` of group `g` is a goal"),
        (group_of("g", Subject.COVERPOINT, [Item("a", BinKind.ILLEGAL)]), "is illegal here"),
        (group_of("g", Subject.STATES, [Item("a")]), "is about states here, coverpoint in"),
        (group_of("g", Subject.COVERPOINT, [Item("a")], weight=3), "has weight 3 here, 1 in"),
        (
            Group("g", Subject.COVERPOINT, {"a": Item("a")}, 1, {"x": ["a"]}),
            "has the axes x here, none in",
        ),
    ],
)
def test_a_contradiction_is_refused_by_name(tmp_path, other, told):
    own = group_of("g", Subject.COVERPOINT, [Item("a")])
    for name, group in (("own.cov", own), ("other.cov", other)):
        with Database.open(tmp_path / name) as database:
            database.declare(model_of([group]))
    new = group_of("new", Subject.COVERPOINT, [Item("n")])
    with Database.open(tmp_path / "own.cov") as database:
        with pytest.raises(CoverageError, match=told):
            database.declare(model_of([new, other]))
        assert database.coverage().model == model_of([own])
    with pytest.raises(CoverageError, match="other.cov: .*" + told):
        read([tmp_path / "own.cov", tmp_path / "other.cov"])


def test_what_makes_no_sense_is_refused():
    with Database.in_memory() as database:
        with pytest.raises(CoverageError, match="hit `yes` of `gaze`, which no declared model has"):
            database.record(TestRecord("t"), hits_of(("gaze", "yes")))
        database.declare(door_model())
        with pytest.raises(CoverageError, match="0 times"):
            database.record(TestRecord("t"), hits_of(("gaze", "yes"), count=0))
        with pytest.raises(CoverageError, match="beyond 2"):
            database.record(TestRecord("t"), {"gaze": {"yes": Hit(2**64)}})
        with pytest.raises(CoverageError, match="beyond 2"):
            database.record(TestRecord("t", number=2**64), {})
        with pytest.raises(CoverageError, match="nan s"):
            database.record(TestRecord("t", seconds=float("nan")), {})
        for group, told in [
            (group_of("g", Subject.STATES, [Item("a", goal=0)]), "item `a` of `g` has goal 0"),
            (group_of("g", Subject.STATES, [], weight=-1), "group `g` has weight -1"),
        ]:
            with pytest.raises(CoverageError, match=told):
                database.declare(model_of([group]))
        with pytest.raises(CoverageError, match="no item `x` of `gaze`"):
            database.explain("gaze", "x", "why")
        assert database.coverage().entries == []


def test_names_are_data(path):
    names = [*hostile_names(60), "'; DROP TABLE tests; --", '"', "%s", "NULL", ""]
    group = group_of(names[-5], Subject.COVERPOINT, [Item(name) for name in names])
    with Database.open(path) as database:
        database.declare(model_of([group]))
        for when, name in enumerate(names):
            record = TestRecord(
                name, name, name, name, system=name, error=name, when=when, verdicts={name: "P"}
            )
            database.record(record, hits_of((group.name, name)))
            database.explain(group.name, name, name)
            database.exclude(group.name, name, name)
    coverage = read([path])
    assert coverage.model == model_of([group])
    assert [entry.record.name for entry in coverage.entries] == names
    assert [*coverage.entries[3].record.verdicts.items()] == [(names[3], Verdict.PASS)]


def test_a_name_of_a_file_that_is_no_text_is_kept_readable():
    with Database.in_memory() as database:
        database.record(TestRecord("t", recording="a\udcff.csv"), {})
        [entry] = database.coverage().entries
    assert entry.record.recording == "a\\udcff.csv"


def test_a_name_that_is_no_text_is_refused():
    group = group_of("g", Subject.COVERPOINT, [Item("a"), Item("\udc00")])
    with Database.in_memory() as database:
        with pytest.raises(CoverageError, match=r"'\\udc00' has characters that are not valid"):
            database.declare(model_of([group]))
        database.declare(door_model())
        with pytest.raises(CoverageError, match="not valid Unicode"):
            database.explain("gaze", "yes", "\udc00")


def test_a_database_on_a_read_only_medium_is_read(path, monkeypatch):
    """SQLite then creates no further files beside it."""
    with Database.open(path) as database:
        fill(database)
    monkeypatch.setattr(database_file.os, "access", lambda *_: False)
    before = path.read_bytes()
    assert len(read([path]).entries) == 4
    assert path.read_bytes() == before


def test_a_closed_database_says_so(path):
    with Database.open(path) as database:
        pass
    with pytest.raises(CoverageError, match="until it is closed"):
        database.declare(door_model())
