"""The page of a run: what it opens first, its content, its safety and its size."""

import json
import math
import re
from dataclasses import replace

import pytest
from msgspec import structs
from tests.rvmon.report.reader import Reader
from tests.tools.hostile import FORGERIES, STEERING
from tests.tools.looked_at import dumped

import rvmon
from rvmon.report.attempt_panels import JudgedRun, RunPage, opening
from rvmon.report.run_html import run_page
from rvmon.report.run_pages import write_run_pages
from rvmon.report.run_text import print_reports
from rvmon.report.tracks import Outline, Scene
from rvmon.trace.sample import Health, HealthKind
from rvmon.trace.time import TICKS_PER_SECOND

SPEC = """
spec door "A door"
signal closed : bool   input
signal gap    : real [m] input
event  knock  input

requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed

requirement D2 "Nobody is squeezed"
  upon closed
  then immediately gap >= 5 cm

requirement D3 "The door closes in the end"
  upon start
  then eventually closed
"""


def judged(name, samples, spec=None, end=20.0):
    """The report of a run given as `(seconds, values)`."""
    spec = spec or rvmon.loads(SPEC, name="door.rv")
    trace = spec.recording(samples)
    report = spec.evaluate(trace, until=end)
    return spec, JudgedRun(name, report, tuple(trace))


def door(name="monday", answer=None, gap=0.2):
    """A knock at 5 s, answered after some seconds or never; the door is closed at 0 s."""
    samples = [(0.0, {"closed": True, "gap": gap}), (5.0, {"knock": True})]
    if answer is not None:
        samples.append((5.0 + answer, {"closed": False}))
    return judged(name, samples)


def content(run=None, **more):
    """The page of a run."""
    spec, one = run or door()
    return RunPage(run=one, spec=spec.checked, command="again --please", **more)


def section_of(shown, attempt):
    """The section of one attempt."""
    return re.search(f'<section id="{attempt}".*?</section>', run_page(shown), re.DOTALL)[0]


def opened(page):
    """The id of the attempt on which a page opens."""
    return next(a["data-open"] for tag, a in Reader(page).tags if tag == "main")


def test_it_opens_the_first_failure_with_one_sentence_and_the_cause_underlined():
    """With requirement, run, instant and cause, also in the title; the line has its number."""
    page = run_page(content())
    assert opened(page) == "D1-1"
    read = Reader(page)
    assert re.match("D1 failed, monday, 7 s: .*closed", read.texts["title"])
    assert ": <code>closed</code> had to become false between" in page
    assert "within 2 s not closed" in read.texts["mark"]
    assert read.texts["pre"].count("upon knock") == 1
    assert "  9  " in page


@pytest.mark.slow
def test_hostile_names_steer_nothing_and_scripts_find_them():
    for number, hostile in enumerate(FORGERIES):
        spec, run = door(name=hostile)
        names = {name: f"{hostile}{number}" if name == "D1" else name for name in spec.requirements}
        report = replace(
            run.report,
            verdicts={names[n]: v for n, v in run.report.verdicts.items()},
            counts={names[n]: v for n, v in run.report.counts.items()},
            attempts=tuple(
                replace(a, requirement=names[a.requirement]) for a in tuple(run.report.attempts)
            ),
        )
        checked = structs.replace(
            spec.checked,
            requirements={
                names[n]: replace(r, id=names[n], text=hostile)
                for n, r in spec.checked.requirements.items()
            },
        )
        page = run_page(
            RunPage(
                structs.replace(run, report=report),
                checked,
                hostile,
                back=hostile,
                facts=((hostile, hostile),),
            )
        )
        assert not STEERING.search(page)
        tags = Reader(page).tags
        assert "img" not in {tag for tag, _ in tags}
        assert sum(tag == "script" for tag, _ in tags) == 2
        assert not any(name.startswith("on") for _, attributes in tags for name in attributes)
        data = json.loads(re.search(r'id="run">(.*?)</script>', page).group(1))
        sections = [a["id"] for tag, a in tags if tag == "section"]
        assert set(sections) <= data["panels"].keys()
        tracks = {a["data-track"] for tag, a in tags if "data-track" in a}
        assert tracks <= {name for one in data["panels"].values() for name in one["tracks"]}


@pytest.mark.slow
def test_without_failures_it_opens_open_attempts():
    """Requirements never triggered are marked; passed ones are folded."""
    samples = [(0.0, {"closed": True, "gap": 1.0})]
    assert opened(run_page(content(judged("t", samples)))) == "D2-1"
    samples.append((19.0, {"knock": True}))
    assert opened(run_page(content(judged("t", samples)))) == "D1-1"
    spec, run = judged("quiet", [(0.0, {"gap": 1.0})], end=3.0)
    page = run_page(RunPage(run, spec.checked, "x"))
    assert "D1 was not triggered, quiet" in page
    assert "D1" in Reader(page).ids
    assert '<details class="parts">' in run_page(content(door(answer=1.0)))
    with pytest.raises(rvmon.RvmonError, match="the specification has none: add one"):
        opening(rvmon.loads("signal p : bool\n").evaluate([(0.0, {"p": True})]))


def test_page_and_text_say_the_same_of_the_input(capsys):
    spec, run = door()
    found = (
        Health(HealthKind.NAN, "gap", 3, 2 * TICKS_PER_SECOND, ("D2",)),
        Health(HealthKind.CUT, "the last line", remark="it has no end"),
        Health(HealthKind.DROPPED, "knock", remark="the pipe broke"),
        *(Health(HealthKind.IGNORED, f"x{n}", remark="not declared") for n in range(14)),
    )
    run = structs.replace(run, report=replace(run.report, health=found))
    print_reports([run.report], spec.checked)
    text = capsys.readouterr().out.partition("input health:")[2]
    page = run_page(content((spec, run)))
    listed = re.search("<h2>Input health</h2><ul>(.*?)</ul>", page, re.DOTALL)[1]
    assert "".join(text.split()) == "".join(re.sub("<.*?>", "", listed).split())
    assert "  gap  nan 3 times, first at 2 s  (D2)\n" in text
    assert "x11, … and 2 more  ignored: not" in text


def test_each_part_of_an_attempt_has_a_row():
    """Trigger and consequent, when they were true and where nobody knows, open where it failed.

    The door stays closed: `not closed` is never true; the consequent is not known near the end.
    """
    section = section_of(content(), "D1-1")
    rows = re.search(r'<details class="parts" open.*?</details>', section, re.DOTALL)[0]
    rows = rows.split('<div class="row">')[1:]
    shown = {re.search(r"<code[^>]*>(.*?)</code>", row)[1]: row for row in rows[:-1]}
    assert list(shown) == ["knock", "within 2 s not closed", "not closed"]
    assert [row.count('class="on"') for row in shown.values()] == [1, 0, 0]
    assert all('class="unknown"' not in row for row in shown.values())  # the run lasts until 20 s
    late = judged("late", [(0.0, {"closed": True}), (19.0, {"knock": True})])
    parts = section_of(content(late), "D1-1")
    assert 'class="unknown"' in parts.split("within 2 s not closed</code>")[1].split("</div>")[1]


def test_a_number_is_drawn_with_its_threshold_and_the_violating_sample():
    """Known up to 5 s and from 10 s on, at which it fails; a margin is above and below."""
    spec = rvmon.loads("signal x : real [m]\nrequirement R\n  always x > 1 m\n")
    samples = [(0.0, {"x": 3}), (5.0, {"x": None}), (10.0, {"x": 0.5})]
    row = section_of(content(judged("t", samples, spec)), "R-1").partition("<code>x</code>")[2]
    assert re.findall('points="(.*?)"', row) == ["40,9.68 440,9.68", "840,90.3 1000,90.3"]
    ends = re.findall(r'class="scale" style="top:(.*?)%">(.*?)<', row)
    assert ends == [("90.32", "0.5"), ("9.68", "3")]
    unknown = re.findall('class="unknown".*?style="(.*?)"', row.partition("threshold")[0])
    assert unknown == ["left:0.000%;width:4.000%", "left:44.000%;width:40.000%"]
    assert 'class="threshold" style="top:74.19%"><span>&gt; 1 m<' in row
    assert re.findall('class="sample" style="(.*?)"', row) == ["left:84.00%;top:90.32%"]


@pytest.mark.parametrize(("most", "limit"), [(1.7e308, 0), (5e-324, 0), (2**62 + 1, 2**62)])
def test_numbers_of_any_size_have_a_place(most, limit):
    spec = rvmon.loads(f"signal x : real\nrequirement R\n  always x > {limit}\n")
    samples = [(0.0, {"x": most}), (1.0, {"x": -most if limit == 0 else limit})]
    text = run_page(content(judged("sizes", samples, spec)))
    heights = [
        float(y) for y in re.findall(r"[\d.]+,([^ \"]+)", *re.findall(r'points="([^"]+)', text))
    ]
    assert len({*heights}) == (1 if limit else 2)
    assert all(0 <= height <= 100 for height in heights)


def test_a_window_ends_with_the_decision_if_nothing_else_ends_it():
    for number, closed, kind in (
        ("D2-1", True, "window"),
        ("D3-1", True, "window"),
        ("D3-1", False, "window unbounded"),
    ):
        run = judged("t", [(0.0, {"closed": closed, "gap": 1.0})])
        found = re.findall(r'class="(window[^"]*)"', section_of(content(run), number))
        assert found == [kind]


def test_the_nearest_passed_attempt_is_overlaid():
    """The two are aligned at their triggers."""
    samples = [(0.0, {"closed": True}), (2.0, {"knock": True}), (3.9, {"closed": False})]
    others = [door("far", answer=0.1)[1], judged("near", samples)[1]]
    section = section_of(content(others=others), "D1-1")
    assert "nearest passing attempt: near, attempt 1, decided 1.9 s after its trigger" in section
    drawn = re.findall('class="(?:on|mark) reference" style="(.*?)"', section)
    assert drawn == ["left:25.00%", "left:0.000%;width:72.500%"]


LOOKED_AT = """
spec looks
signal gap : real
signal ok  : bool
event  look
"""


def looks(name, gaps, spec, *, ok=True):
    """A run that measures a gap each second."""
    samples = [(float(t), {"gap": gap, "ok": ok, "look": True}) for t, gap in enumerate(gaps)]
    return judged(name, samples, spec, end=float(len(gaps)))[1]


def test_an_infinite_number_is_nearest_to_itself():
    spec = rvmon.loads(
        LOOKED_AT + "requirement R\n  upon look\n  then immediately gap > 0 and ok\n"
    )
    failed = looks("failed", [math.inf], spec, ok=False)
    others = [looks("wide", [4.0], spec), looks("alike", [math.inf], spec)]
    page = run_page(RunPage(failed, spec.checked, "x", others))
    assert "nearest passing attempt: alike, attempt 1" in page


def test_a_page_of_many_requirements_shows_the_worst_attempts_of_each():
    rules = (f"requirement R{k}\n  upon look\n  then immediately gap > 0\n" for k in range(300))
    spec = rvmon.loads(LOOKED_AT + "".join(rules))
    page = run_page(RunPage(looks("many", [1, 0, 1, 0, 0], spec), spec.checked, "x"))
    shown = {one["id"] for tag, one in Reader(page).tags if tag == "section"}
    assert shown == {f"R{k}-2" for k in range(300)}
    assert page.count("and 4 more</p>") == 300


def test_a_page_needs_nothing_but_itself():
    page = run_page(content(back="../report.html"))
    addresses = [a[k] for _, a in Reader(page).tags for k in ("href", "src") if k in a]
    assert all(one.startswith("#") or one == "../report.html" for one in addresses)
    assert not re.search(r"https?://|url\(|@import", page)


@pytest.mark.slow
def test_a_long_run_makes_a_small_page():
    samples = [
        (i / 100, {"gap": (i * 7919 % 1000) / 1000, "closed": i % 200 < 100}) for i in range(50_000)
    ]
    spec, run = judged("long", samples, end=500.0)
    page = run_page(RunPage(run, spec.checked, "x"))
    assert sum(run.report.counts["D2"].values()) == 250
    assert len(re.findall('<section id="D2-', page)) == 6
    assert page.count(" and 244 more</p>") == 6
    assert len(page) < 200_000


def scene():
    """A body that moves a metre in a second."""
    frames = tuple((i * TICKS_PER_SECOND // 10, (i / 10, 0.5, 0.1)) for i in range(11))
    return Scene(("cart",), (Outline("cart", ((0.0, 0.0),), 0.1, "piece"),), frames, (0, 0, 2, 1))


def test_the_scene_stands_where_the_cursor_is():
    page = run_page(content(scene=scene()))
    group = next(a for tag, a in Reader(page).tags if tag == "g")
    assert group["transform"].startswith("translate(1000 -500)")
    assert '<circle cx="0" cy="0" r="100"' in page
    data = json.loads(re.search(r'id="run">(.*?)</script>', page, re.S)[1])
    assert sum(data["scene"]["values"][0]) == 1000
    assert len(data["scene"]["times"]) == 11


def test_signals_that_were_not_recorded_are_not_drawn_as_unknown(tmp_path):
    """A run from standard input has verdicts, and the page says that signals are missing."""
    spec, run = door()
    report = replace(run.report, trace="-")
    (path,) = write_run_pages(tmp_path, spec.checked, [report], lambda _: [], lambda _: "judge -")
    page = path.read_text()
    assert "D1 failed, standard input, 7" in page
    assert "The signals of this run were not kept." in page
    assert 'class="unknown"' not in page


def test_the_script_runs_in_a_browser(chromium, tmp_path):
    path = tmp_path / "run.html"
    path.write_text(run_page(content(scene=scene())), encoding="utf-8")
    first, said = dumped(chromium, f"file://{path}")
    assert "CONSOLE" not in said
    assert shown_sections(first) == ["D1-1"]
    assert ">7 s, trigger + 2 s<" in first
    assert re.search(r'data-track="closed">true<', first)
    assert 'transform="translate(1000 -500)' in first
    assert shown_sections(dumped(chromium, f"file://{path}#D2")[0]) == ["D2-1"]


def shown_sections(html):
    """The ids of the open sections."""
    return [
        a["id"] for tag, a in Reader(html).tags if tag == "section" and a.get("class") == "open"
    ]


def test_what_came_late_is_marked():
    page = run_page(content(door(answer=2.02)))
    assert "it came at 7.02 s, 20 ms after the deadline" in page.replace("\xa0", " ")
    assert re.search(r'class="label late[^>]*>(?:◆ )?came 20 ms late', page)
    far = run_page(content(door(answer=12.0)))
    assert "10 s after the deadline" in far.replace("\xa0", " ")
    assert re.search(r'class="label late[^>]*>came 10 s late <[^>]*>17 s</span> →', far)


def test_all_requirements_stand_over_the_whole_recording():
    samples = [
        (0.0, {"closed": False, "gap": 1.0}),
        (5.0, {"knock": True}),
        (10.0, {"closed": True, "gap": 0.01}),
        (15.0, {"knock": True}),
    ]
    nav = re.search(r"<nav.*?</nav>", run_page(content(judged("t", samples))), re.DOTALL)[0]
    rows = re.findall(r'<a class="row" href="#([^"]*)"', nav)
    assert rows == ["D1-2", "D2-1", "D3-1"]
    others = re.findall('href="#(.*?)"', section_of(content(judged("t", samples)), "D1-2"))
    assert others == ["D1-1", "D1-2"]
    row = nav.partition('href="#D1-2"')[2].partition("</a>")[0]
    bars = re.findall(r'data-verdict="(.)" style="left:([\d.]+)%;width:([\d.]+)%', row)
    assert [(verdict, float(left)) for verdict, left, _ in bars] == [("P", 25.0), ("F", 75.0)]
    assert float(bars[1][2]) == pytest.approx(10, abs=0.5)  # two of twenty seconds


@pytest.mark.slow
def test_several_recordings_get_a_list(tmp_path):
    """With totals and severities, most failures first; files may have the same name."""
    spec = rvmon.loads(SPEC + "  severity high\n")
    runs = {
        "week/a/bad.csv": door()[1],
        "week/b/bad.csv": door(gap=0.01)[1],
        "week/index.csv": door(answer=1.0)[1],
    }
    reports = [replace(run.report, trace=name) for name, run in runs.items()]
    written = write_run_pages(tmp_path, spec.checked, reports, lambda name: runs[name].samples, str)
    assert len({path.name for path in written}) == 4
    index = (tmp_path / "index.html").read_text()
    links = [a["href"] for tag, a in Reader(index).tags if tag == "a"]
    assert all((tmp_path / link.partition("#")[0]).exists() for link in links)
    assert len(links) == 3 * (1 + len(spec.requirements))  # one link for each verdict
    named = re.findall(r'<a href="[^"#]*">([^<]*)</a></th>', index)
    assert named == ["b/bad.csv", "a/bad.csv", "index.csv"]
    rows = {row.partition("<")[0]: row for row in index.split('<th scope="row">')[1:4]}
    assert re.findall(r">(\d)</td>", rows["D1"]) == ["1", "2", "0", "0"]
    assert "severity: high" in rows["D3"]
    assert re.search(r'data-name="week/b/bad.csv d1 d2"', index)
    assert "in <code>week/" in index
    apart = [replace(reports[0], trace=f"{name}/x.csv") for name in "ab"]
    write_run_pages(tmp_path, spec.checked, apart, lambda _: [], str)
    assert "in <code>" not in (tmp_path / "index.html").read_text()


def test_the_place_of_a_requirement_is_that_of_the_line_below_it():
    page = run_page(content(door()))
    shown = re.findall(
        r"<figcaption>door\.rv:(\d+)</figcaption>.*?gutter[^>]*>\s*(\d+)", page, re.S
    )
    assert shown
    assert all(place == line for place, line in shown)
