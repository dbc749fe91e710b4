"""`rvmon run`: verdicts, exit codes, chosen requirements, and recordings with faults."""

import io
import json
import multiprocessing
import os
import signal
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from tests.rvmon.cli.conftest import DOOR, LABELLED
from tests.tools.each import each

from rvmon.cli import evaluation, main
from rvmon.cli.evaluation import judge

PASS = "t,closed,knock\n0,1,\n1,,1\n2,0,\n5,,\n"
FAIL = "t,closed,knock\n0,1,\n1,,1\n5,,\n"
QUIET = "t,closed,knock\n0,1,\n5,,\n"
OPEN = "t,closed,knock\n0,1,\n1,,1\n2,,\n"


@pytest.fixture
def files(door):
    """A folder with specifications and one recording per verdict."""
    (door / "labelled.rv").write_text(LABELLED)
    for name, text in {"P": PASS, "F": FAIL, "NT": QUIET, "I": OPEN}.items():
        (door / f"{name}.csv").write_text(text)
    return door


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trace", "code", "strict"), [("P", 0, 0), ("F", 1, 1), ("NT", 0, 1), ("I", 0, 1)]
)
def test_the_exit_code_depends_on_verdict_and_strictness(files, says, trace, code, strict):
    shown = json.loads(says(code, "run", "door.rv", f"{trace}.csv", "--format", "json").out)
    assert shown["requirements"]["D1"]["verdict"] == trace
    assert shown["trace"] == f"{trace}.csv"
    says(strict, "run", "door.rv", f"{trace}.csv", "--strict")


@each(
    ("words", "chosen"),
    [
        ("--severity high", ["D0"]),
        ("--severity low,high", ["D0", "D1"]),
        ("--tag safety", ["D0", "D1"]),
        ("--tag safety --tag knocks", ["D0"]),
        ("--tag safety --severity low", ["D1"]),
        ("--tag safety --only D1,D2", ["D1"]),
    ],
)
def test_severity_and_tags_choose_requirements(files, capsys, words, chosen):
    """Words separated by commas are alternatives; repeated options must all match."""
    main(["run", "labelled.rv", "P.csv", "--format", "json", *words.split()])
    judged = json.loads(capsys.readouterr().out)["requirements"]
    assert list(judged) == chosen
    labels = {"D0": ("high", ["safety", "knocks"]), "D1": ("low", ["safety"])}
    for name, requirement in judged.items():
        assert (requirement["severity"], requirement["tags"]) == labels[name]


def test_severity_and_tags_are_in_text_junit_and_evidence(files, says):
    words = "--tag safety --junit j.xml --evidence e.zip"
    told = says(1, "run", "labelled.rv", "P.csv", *words.split()).out
    assert "high       Knocking opens the door  [safety, knocks]" in told
    properties = ET.parse("j.xml").iter("property")  # noqa: S314
    said = [(one.get("name"), one.get("value")) for one in properties]
    assert ("severity", "high") in said
    assert [value for name, value in said if name == "tag"] == ["safety", "knocks", "safety"]
    says(0, "evidence", "e.zip")


@pytest.mark.slow
@each(("code", "traces", "page"), [(0, "P.csv", "P.html"), (1, "P.csv F.csv", "index.html")])
def test_a_report_names_the_page_to_open(files, says, code, traces, page):
    words = ["run", "door.rv", *traces.split(), "--report", "rep"]
    for more in [], ["--quiet"]:
        assert says(code, *words, *more).out.endswith(f"wrote {Path('rep', page)}\n")
    json.loads(says(code, *words, "--format", "json").out)


@pytest.mark.slow
def test_many_recordings_are_shown_in_order_by_one_process_or_two(files, says):
    """A case of JUnit is passed, failed or skipped."""
    words = ["run", "door.rv", "P.csv", "F.csv", "NT.csv", "--junit", "out.xml"]
    for form, told in ("text", "3 recordings"), ("json", '"P.csv"'):
        alone = says(1, *words, "--format", form).out
        assert told in alone
        cases = ET.parse(files / "out.xml").getroot().findall(".//testcase")  # noqa: S314
        assert [len(case.findall("failure")) for case in cases] == [0, 1, 0]
        assert [len(case.findall("skipped")) for case in cases] == [0, 0, 1]
        assert says(1, *words, "--format", form, "--jobs", "2").out == alone
    assert [len(one["requirements"]) for one in json.loads(alone)] == [1, 1, 1]


@pytest.mark.slow
@pytest.mark.skipif(
    multiprocessing.get_start_method() != "fork", reason="needs processes that are forked"
)
def test_a_killed_process_loses_only_its_own_recording(files, says, monkeypatch):
    def killed(spec, trace, options, **how):
        if trace == "I.csv":
            os.kill(os.getpid(), signal.SIGKILL)
        return judge(spec, trace, options, **how)

    monkeypatch.setattr(evaluation, "judge", killed)
    words = "P.csv I.csv NT.csv --jobs 2 --format json --junit j.xml"
    told = says(2, "run", "door.rv", *words.split())
    why = "not evaluated: the process that had recording 2 was killed from outside"
    assert f"I.csv: {why}" in told.err
    assert "use fewer processes (jobs)" in told.err
    assert "Traceback" not in told.err
    assert len(json.loads(told.out)) == 3
    assert (files / "j.xml").exists()


def test_a_requirement_that_never_triggers_fails_on_request(files, says):
    told = says(1, "run", "door.rv", "NT.csv", "--require-triggered").err
    assert "D1 was triggered in no recording" in told
    says(0, "run", "door.rv", "NT.csv", "P.csv", "--require-triggered=D1")


@each("option", ["--require-triggered", "--require", "--allow-missing"])
def test_an_option_with_an_optional_value_does_not_take_the_next_word(files, says, option):
    says(0, "run", option, "door.rv", "P.csv")
    says(0, "run", "door.rv", option, "P.csv")


JUDGED_BEFORE = "decided before that: D1  1 F; attempt 1 failed at 3.000000001 s: `closed`"


def test_attempts_decided_before_a_fault_of_a_recording_are_shown(files, says):
    (files / "cut.csv").write_text(FAIL + "6,,\n9,maybe,\n")
    told = says(2, "run", "door.rv", "cut.csv").err
    assert "cut.csv: line 6: column `closed`: `maybe`" in told
    assert JUDGED_BEFORE in told
    assert "Traceback" not in told
    (files / "lacks.csv").write_text("t,knock\n0,1\n5,1\n")
    shown = says(2, "run", "door.rv", "cut.csv", "lacks.csv", "P.csv", "--format", "json")
    cut, lacks, whole = json.loads(shown.out)
    assert (cut["trace"], "verdicts" in cut, "line 6" in cut["error"]) == ("cut.csv", False, True)
    assert [attempt["verdict"] for attempt in cut["judged_before"]["D1"]] == ["F"]
    assert "there is no column for these names, which requirements read" in shown.err
    assert lacks["judged_before"] == {}
    assert whole["requirements"]["D1"]["verdict"] == "P"


@pytest.mark.parametrize("delay", ["", "max delay 1 s\n"])
def test_attempts_decided_before_a_fault_of_a_stream_are_shown(files, says, monkeypatch, delay):
    """Standard input cannot be read again, so the run itself has to remember them."""
    head, _, rest = DOOR.strip().partition("\n")
    (files / "late.rv").write_text(f"{head}\n{delay}{rest}\n")
    rows = [{"t": 0, "closed": True}, {"t": 1, "knock": True}, {"t": 5}, {"t": 6}]
    lines = [*map(json.dumps, rows), '{"t": 7, "closed": "maybe"}']
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO("\n".join(lines).encode())))
    told = says(2, "run", "late.rv", "-").err
    assert 'line 5: field `closed`: `"maybe"`' in told
    assert JUDGED_BEFORE in told


@pytest.mark.slow
def test_attempts_decided_in_columns_before_a_fault_are_shown(files, says):
    rows = "".join(f"{t},1,{t == 1:d}\n" for t in range(200_000))
    (files / "cut.csv").write_text(f"t,closed,knock\n{rows}200000,maybe,0\n")
    told = says(2, "run", "door.rv", "cut.csv").err
    assert "cut.csv: line 200002: column `closed`: `maybe`" in told
    assert JUDGED_BEFORE in told


@pytest.mark.parametrize("words", [["a.csv"], ["a.jsonl"], ["a.csv", "b.csv", "--join"]])
def test_conflicting_rows_after_the_end_are_not_reported(words, put, says):
    signals = "signal x : int\nsignal y : real\nsignal z : bool\n"
    put("a.rv", f"spec s\n{signals}requirement R\n  always (x < 9 and y < 9) or z\n")
    put("b.csv", "t,z\n0,0\n1,0\n")
    begin = [(0, 1, 1), (1, 2, 1), (1, 3, 2), (2, 1, 1)]
    later = [(3 + k // 2, k, "NaN" if k % 4 else 1) for k in range(40)] + [(10**9, 1, 1)]
    found = []
    for rows in (begin, begin + later):
        put("a.csv", "t,x,y\n" + "".join(f"{t},{x},{y}\n" for t, x, y in rows))
        lines = [f'{{"t": {t}, "x": {x}, "y": {y}, "z": false}}\n' for t, x, y in rows]
        put("a.jsonl", "".join(lines))
        options = "--allow-missing", "--until", "2.5", "--format", "json"
        told = says(int(words == ["a.csv"]), "run", "a.rv", *words, *options)
        found.append(json.loads(told.out)["health"])
    assert found[0] == found[1]
    assert [one["name"] for one in found[0] if one["kind"] == "conflict"] == ["x", "y"]


@each(
    ("until", "end", "verdict"),
    [("2", 2, "I"), ("3", 3, "F"), ("3000ms", 3, "F"), ("30", 30, "F")],
)
def test_until_sets_the_end(files, capsys, until, end, verdict):
    """Later rows are not read; time advances to a later end than the last sample."""
    (files / "late.csv").write_text(FAIL + "6,,\n9,maybe,\n" if until != "30" else FAIL)
    main(["run", "door.rv", "late.csv", "--until", until, "--format", "json"])
    report = json.loads(capsys.readouterr().out)
    assert report["end"] == end * 10**9
    assert report["requirements"]["D1"]["verdict"] == verdict


def test_binary_standard_input_is_refused_however_the_locale_decodes_it(files, monkeypatch, says):
    for errors in ("strict", "surrogateescape"):
        binary = io.TextIOWrapper(io.BytesIO(b"\x7fELF\xff\xfe"), "utf-8", errors=errors)
        monkeypatch.setattr("sys.stdin", binary)
        assert "not UTF-8 text" in says(2, "run", "door.rv", "-").err


def test_an_absent_column_is_reported(files, says):
    (files / "less.csv").write_text("t,closed\n0,1\n5,0\n")
    shown = says(1, "run", "door.rv", "less.csv", "--allow-missing=knock")
    assert "knock  absent" in shown.out
    assert "less.csv has no column for `knock`" in shown.err


@pytest.mark.parametrize("captured", ["let v = x", "for each v in knock.id"])
def test_late_answers_to_captured_values_are_looked_up_for_three_failures(captured, files, says):
    """Each such lookup costs a pass over the recording."""
    (files / "own.rv").write_text(
        "spec own\nsignal x : real\nevent knock(id: int)\nrequirement R\n"
        f"  upon knock\n  then within 1 s x > v\n  {captured}\n"
    )
    knocks = "".join(f"{10 * k},1,{k},{k}\n{10 * k + 5},,,{k + 1}\n" for k in range(1, 6))
    (files / "own.csv").write_text("t,knock,knock.id,x\n" + knocks)
    told = says(1, "run", "own.rv", "own.csv", "--format", "json").out
    found = json.loads(told)["requirements"]["R"]
    assert found["counts"]["F"] == 5
    assert found["late"] == {str(k): (10 * k + 5) * 10**9 for k in (1, 2, 3)}


def test_an_open_attempt_that_nothing_can_fulfil_has_a_forecast(put, says):
    rule = "requirement R1 upon start then (within 3 s a) and for 5 s not a"
    put("s.rv", f"signal a : bool\n{rule}\n")
    put("t.csv", "t,a\n0,false\n1,false\n")
    shown = says(0, "run", "s.rv", "t.csv", "--report", "pages").out
    said = "forecast F: no continuation can fulfil it"
    assert "R1   I" in shown
    assert said in shown
    assert any(said in page.read_text() for page in Path("pages").rglob("*.html"))
    assert "forecast F" in says(0, "why", "s.rv", "t.csv", "R1").out
