"""The command `handover` as a person uses it."""

import contextlib
import csv
import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest

from handover.campaign import campaign as of_handover
from handover.campaign.campaign import handover_campaign
from handover.campaign.table1 import spread, spread_text
from handover.checker import spec_path
from handover.cli import main
from handover.generator.abstract_test import directed
from handover.robot import behaviour
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.play import execute
from rvmon.cdv.test import save

pytestmark = pytest.mark.campaign


SHOWN = ("legacy-released", "mutant-hurries", "mutant-releases-late", "released")
"""The directed tests of the demonstration here; each of all is played by `test_directed.py`."""


@pytest.fixture(scope="module")
def demo(shared):
    def make(folder):
        words = ["demo", "--tests", "1", "--conform", "1", "--jobs", "1", "--out", str(folder)]
        printed = io.StringIO()
        few = [one for one in directed() if one.name in SHOWN]
        with contextlib.redirect_stdout(printed), pytest.MonkeyPatch.context() as patch:
            patch.setattr(of_handover, "directed", lambda: few)
            assert main(words) == 0
        (folder / "printed").write_text(printed.getvalue())

    return shared("demo", make)


def test_the_page_has_what_the_model_says(demo):
    page = (demo / "report.html").read_text()
    section = page[page.index("<h2>The model</h2>") :]
    claims = re.findall(
        r'<th scope="row">(R\d)</th><td>(\w)<a href="(\S+)".*?</td>'
        r"<td>([\d.]+) % \((\d+)–(\d+)\)</td><td>(\w)</td>",
        section,
    )
    assert [(name, some, every) for name, some, *_, every in claims] == [
        (f"R{number}", "T", "T") for number in range(1, 5)
    ]
    assert all((demo / address).exists() for _, _, address, *_ in claims)
    assert all(float(low) <= float(share) <= float(high) for *_, share, low, high, _ in claims)
    row = (
        r'<th scope="row">{} ([\w-]+)</th><td>(\d+)</td><td>(\d+) {}</td>'
        r'<td class="text">(.*?)</td>'
    )
    edges = re.findall(row.format("edges of", "played"), section)
    assert sum(int(played) for _, _, played, _ in edges) >= 40
    for _, there_are, played, others in edges:
        assert int(there_are) - int(played) == others.count(" → ")
        assert "not shown" not in others
    runs = re.findall(row.format("runs,", "conform"), section)
    assert [name for name, *_ in runs][:3] == ["pseudorandom", "constrained", "model-based"]
    assert all(count == conforming == "1" for _, count, conforming, _ in runs)
    assert 'title="the replayed witness of R1">T</a>' in page


def test_the_paper_is_compared_with_the_spread_over_seeds(demo):
    """The stored counts contain those of campaigns with these seeds."""
    found = spread()
    assert spread_text() in (demo / "report.html").read_text()
    campaign = replace(handover_campaign(("legacy",)), code=None)
    for seed in (found.first, found.first + 1):
        results = execute(plan(campaign, ("model-based",), seed=seed), jobs=1, controls=False)
        for requirement, row in found.ranges["model-based"].items():
            for verdict, (low, high) in row.items():
                verdicts = [one.outcome.verdicts[requirement] for one in results.played]
                assert low <= verdicts.count(verdict) <= high


def test_the_demo_leaves_all_its_files(demo):
    names = {path.name for path in demo.iterdir()}
    tables = {f"table.{ending}" for ending in ("txt", "csv", "tex", "json")}
    robots = {"correct", "legacy"}
    assert names == {*tables, *robots, "report.html", "tests", "runs", "templates", "printed"}
    for robot in robots:
        covered = {"coverage.db", "coverage.html", "code.lcov", "cobertura.xml"}
        assert {path.name for path in (demo / robot).iterdir()} == covered
    columns = json.loads((demo / "table.json").read_text())["robots"]["correct"]["strategies"]
    assert {path.name for path in (demo / "templates").iterdir()} <= columns.keys()
    assert "likeliest by the model's weights" in " ".join((demo / "table.txt").read_text().split())
    assert "constrained-000" in {path.stem for path in (demo / "tests").iterdir()}


def test_the_terminal_fits_two_screens(demo):
    """The paper's requirements, and other unexpected failures; Table 1 is last."""
    lines = (demo / "printed").read_text().splitlines()
    assert len(lines) <= 90
    rows = [line.split()[0] for line in lines if re.match(r" [RT]\d+ .*\d", line)]
    assert {"R1", "R5"} == {"R1", "R5"} & set(rows)
    assert not [row for row in rows if row.startswith("T")]
    heads = [line for line in lines if "checked against" in line]
    assert [line.split(",")[0] for line in heads] == [
        "Correct robot",
        "Robot of the paper's testbench",
    ]


def test_directed_tests_say_which_others_failed(demo):
    page = (demo / "report.html").read_text()
    section = page[page.index("<h2>Correct robot: directed tests</h2>") :]
    heads = re.findall(r"<th>(.*?)</th>", section[: section.index("</thead>")])
    others = "others that failed or are open"
    assert heads == ["test", "purpose", "planted fault", "R1", "R2", "R3", "R4", "R5", others]
    row = section[section.index(">mutant-hurries<") :].partition("</tr>")[0]
    assert 'T14 <a href="runs/correct-mutant-hurries.html#T14">F' in row
    released = section[section.index(">released<") :].partition("</tr>")[0]
    assert "T1" not in released


def test_a_failing_test_is_shrunk(demo, tmp_path, capsys):
    """To the protocol and the readings; the smallest test still finds the fault."""
    test = demo / "tests/mutant-releases-late.json"
    assert main(["shrink", str(test), "--out", str(tmp_path)]) == 0
    assert "R1 fails: 6 of 9 actions" in capsys.readouterr().err
    small = tmp_path / "mutant-releases-late-small.json"
    assert main(["replay", str(small), "--expected"]) == 0
    assert main(["shrink", str(demo / "tests/released.json")]) == 1


def test_all_forms_of_the_table_agree(demo):
    content = json.loads((demo / "table.json").read_text())
    rows = list(csv.DictReader(io.StringIO((demo / "table.csv").read_text())))
    assert {row["robot"] for row in rows} >= {"legacy", "correct", "paper"}
    sources = {**content["robots"], "paper": content["paper"]}
    for row in rows:
        if row["robot"] in sources:
            strategy = sources[row["robot"]]["strategies"][row["strategy"]]
            counts = strategy["requirements"][row["requirement"]]
            assert counts == {name: int(row[name]) for name in counts}
    checked = content["model_checking"]
    assert {name: checked[name] for name in checked if checked[name] is not None} == {
        "R1": True, "R2": True, "R3": True, "R4": True
    }  # fmt: skip
    assert checked.keys() > {"R5", "T1"}


def test_all_links_of_the_pages_lead_somewhere(demo):
    for page in (demo / "report.html", *(demo / "runs").iterdir()):
        for address in re.findall(r'href="([^"#]+)', page.read_text()):
            assert (page.parent / address).exists(), (page.name, address)


def test_the_page_and_the_terminal_count_the_same_physics(demo):
    printed = " ".join((demo / "printed").read_text().split())
    told = re.search(r"([\d,]+) s of them with physics", printed)
    assert told is not None
    assert f"{told[1]} s of them with physics" in (demo / "report.html").read_text()


def test_a_strategy_of_another_robot_is_refused(capsys):
    assert main(["run", "--legacy", "--strategy", "disturbed", "--tests", "2"]) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert "no test for the robot legacy: all of `disturbed` are for the robot correct" in told


def test_files_of_an_earlier_campaign_are_reported(tmp_path, capsys):
    """They stay and are counted, except those that the new campaign replaces."""
    run = ["run", "--legacy", "--strategy", "pseudorandom", "--jobs", "1", "--out", str(tmp_path)]
    (tmp_path / "mine.txt").write_text("of somebody else")
    assert main([*run, "--tests", "2"]) == 0
    assert "stay" not in capsys.readouterr().err
    assert main([*run, "--tests", "1"]) == 0
    told = capsys.readouterr().err
    assert f"files that this campaign did not write remain: 1 in {tmp_path / 'tests'}" in told
    assert {path.name for path in (tmp_path / "tests").iterdir()} == {
        f"pseudorandom-00{number}.json" for number in range(2)
    }
    assert (tmp_path / "mine.txt").exists()


def test_a_replay_gives_the_verdicts_of_the_campaign(demo, capsys, tmp_path):
    """A single test, from the campaign's file; its recording has the same verdicts."""
    known = json.loads((demo / "table.json").read_text())["robots"]["correct"]["known_answers"]
    name = "mutant-releases-late"
    file = str(demo / "tests" / f"{name}.json")
    assert main(["replay", file, "--format", "json", "--out", str(tmp_path)]) == 1
    report = json.loads(capsys.readouterr().out)
    verdicts = {one: entry["verdict"] for one, entry in report["requirements"].items()}
    assert verdicts == known[name]["verdicts"]
    assert "R1 failed" in (tmp_path / f"{name}.html").read_text()

    from rvmon.cli import main as rvmon

    assert rvmon(["run", str(spec_path("correct")), str(tmp_path / f"{name}.jsonl")]) == 1
    assert re.search(r"R1 +F", capsys.readouterr().out)


def test_a_replay_is_shown_by_foxglove(tmp_path):
    """With the scene, verdicts and values at the instants of the run."""
    reader = pytest.importorskip("mcap.reader")
    path = save(directed()[0], tmp_path)
    made = tmp_path / "x.mcap"
    main(["replay", str(path), "--mcap", str(made)])
    seen = {}
    with made.open("rb") as file:
        for _, channel, message in reader.make_reader(file).iter_messages():
            seen.setdefault(channel.topic, []).append((message.log_time, message.data))
    assert {"/rvmon/scene", "/rvmon/attempts", "/rvmon/requirements/R1"} <= seen.keys()
    first, last = (json.loads(seen["/rvmon/scene"][place][1]) for place in (0, -1))
    (before,), (after,) = first["entities"], last["entities"]
    assert len(before["lines"]) == len(after["lines"]) > 5
    assert before["lines"] != after["lines"]
    layout = json.loads((tmp_path / "x.mcap.layout.json").read_text())
    assert layout["configById"]["3D!scene"]["topics"] == {"/rvmon/scene": {"visible": True}}
    assert layout["layout"]["second"] == "3D!scene"


@pytest.mark.parametrize("robot", [[], ["--legacy"]])
def test_the_unmodified_robot_passes_its_gates(robot, capsys):
    """The handwritten requirements and those of the model, with any seed."""
    strategies = "model-based,model-based-shortest,model-based-fastest"
    words = ["run", "--strict", "--strategy", strategies, "--seed", "5", "--jobs", "1"]
    assert main([*words, *robot]) == 0
    assert not capsys.readouterr().err


def test_a_fault_in_the_robot_is_told(capsys, monkeypatch):
    late = replace(behaviour.CORRECT, decide_s=0.2)
    monkeypatch.setitem(behaviour.BEHAVIOURS, "correct", late)
    assert main(["run", "--strategy", "model-based", "--jobs", "1"]) == 1
    told = capsys.readouterr()
    assert re.search(r"^ T43 ", told.out, re.MULTILINE)
    assert re.search(r"not as expected: model-based-R1 \(correct\): T43#1 F ", told.err)


_PROGRAM = """
import sys
from handover import cli
parser = cli._parser
def said():
    print(flush=True)
    return parser()
cli._parser = said
sys.exit(cli.main())
"""
"""Says when it has begun: nobody answers for an interrupt while Python itself starts."""


@pytest.mark.parametrize("seconds", [0.0, 0.6])
def test_ctrl_c_at_a_terminal_reaches_all_processes(seconds):
    """At any time, also while workers start: no traceback, and exit code 130 (or completion)."""
    words = ["run", "--strategy", "constrained", "--tests", "40", "--jobs", "2"]
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", _PROGRAM, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(seconds)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGINT)
    _, told = process.communicate(timeout=120)
    assert process.returncode in (0, 130)
    assert "Traceback" not in told
