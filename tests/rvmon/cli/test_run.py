"""`rvmon run` as a person uses it."""

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
    """A folder with a spec and one recording per verdict."""
    (door / "labelled.rv").write_text(LABELLED)
    for name, text in {"P": PASS, "F": FAIL, "NT": QUIET, "I": OPEN}.items():
        (door / f"{name}.csv").write_text(text)
    return door


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trace", "code", "strict"), [("P", 0, 0), ("F", 1, 1), ("NT", 0, 1), ("I", 0, 1)]
)
def test_exit_code_and_verdict(files, says, trace, code, strict):
    shown = json.loads(says(code, "run", "door.rv", f"{trace}.csv", "--format", "json").out)
    assert shown["requirements"]["D1"]["verdict"] == trace
    assert shown["trace"] == f"{trace}.csv"
    assert main(["run", "door.rv", f"{trace}.csv", "--strict"]) == strict


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
    """A list means any of its words, and what is given twice means both; JSON has them."""
    main(["run", "labelled.rv", "P.csv", "--format", "json", *words.split()])
    judged = json.loads(capsys.readouterr().out)["requirements"]
    assert list(judged) == chosen
    labels = {"D0": ("high", ["safety", "knocks"]), "D1": ("low", ["safety"])}
    found = {name: (one["severity"], one["tags"]) for name, one in judged.items()}
    assert found == {name: labels[name] for name in chosen}


def test_severity_and_tags_are_shown_and_kept(files, capsys):
    words = "--tag safety --junit j.xml --evidence e.zip"
    main(["run", "labelled.rv", "P.csv", *words.split()])
    assert "high       Knocking opens the door  [safety, knocks]" in capsys.readouterr().out
    said = [(one.get("name"), one.get("value")) for one in ET.parse("j.xml").iter("property")]  # noqa: S314
    assert ("severity", "high") in said
    assert [value for name, value in said if name == "tag"] == ["safety", "knocks", "safety"]
    assert main(["evidence", "e.zip"]) == 0


@pytest.mark.slow
def test_a_report_names_the_page_to_open(files, capsys):
    for traces, page in (["P.csv"], "P.html"), (["P.csv", "F.csv"], "index.html"):
        words = ["run", "door.rv", *traces, "--report", "rep"]
        for more in [], ["--quiet"]:
            main([*words, *more])
            assert capsys.readouterr().out.endswith(f"wrote {Path('rep', page)}\n")
        main([*words, "--format", "json"])
        json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_many_recordings_are_counted_in_text_json_and_junit(files, says):
    """The same, in their order, with two processes; a case of JUnit is failed or skipped."""
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
def test_a_process_that_is_killed_costs_only_what_was_not_judged(files, capsys, monkeypatch):
    """As where memory runs out: what was judged is shown, the rest named, with a fix."""

    def killed(spec, trace, options, **how):
        if trace == "I.csv":
            os.kill(os.getpid(), signal.SIGKILL)
        return judge(spec, trace, options, **how)

    monkeypatch.setattr(evaluation, "judge", killed)
    traces = ["P.csv", "I.csv", "NT.csv"]
    code = main(["run", "door.rv", *traces, "--jobs", "2", "--format", "json", "--junit", "j.xml"])
    told = capsys.readouterr()
    assert code == 2
    assert (
        "I.csv: not evaluated: the process that had recording 2 was killed from outside" in told.err
    )
    assert "use fewer processes (jobs)" in told.err
    assert "Traceback" not in told.err
    assert len(json.loads(told.out)) == len(traces)
    assert (files / "j.xml").exists()


def test_never_triggered_is_an_error_on_request(files, capsys):
    assert main(["run", "door.rv", "NT.csv", "--require-triggered"]) == 1
    assert "D1 was triggered in no recording" in capsys.readouterr().err
    assert main(["run", "door.rv", "NT.csv", "P.csv", "--require-triggered=D1"]) == 0


@pytest.mark.parametrize("option", ["--require-triggered", "--require", "--allow-missing"])
def test_an_option_that_can_go_without_a_value_takes_no_other_word(files, option):
    """It stands before SPEC as well as behind it: its value follows a `=`."""
    assert main(["run", option, "door.rv", "P.csv"]) == 0
    assert main(["run", "door.rv", option, "P.csv"]) == 0


def test_a_broken_recording_keeps_what_was_judged(files, says):
    (files / "cut.csv").write_text(FAIL + "6,,\n9,maybe,\n")
    told = says(2, "run", "door.rv", "cut.csv").err
    assert "cut.csv: line 6: column `closed`: `maybe`" in told
    assert JUDGED_BEFORE in told
    assert "Traceback" not in told
    (files / "lacks.csv").write_text("t,knock\n0,1\n5,1\n")
    words = ["run", "door.rv", "cut.csv", "lacks.csv", "P.csv", "--format", "json"]
    shown = says(2, *words)
    cut, lacks, whole = json.loads(shown.out)
    assert (cut["trace"], "verdicts" in cut, "line 6" in cut["error"]) == ("cut.csv", False, True)
    assert [attempt["verdict"] for attempt in cut["judged_before"]["D1"]] == ["F"]
    assert "there is no column for these names, which requirements read" in shown.err
    assert lacks["judged_before"] == {}
    assert whole["requirements"]["D1"]["verdict"] == "P"


JUDGED_BEFORE = "decided before that: D1  1 F; attempt 1 failed at 3.000000001 s: `closed`"


@pytest.mark.parametrize("delay", ["", "max delay 1 s\n"])
def test_what_was_judged_of_a_broken_stream_is_told(files, says, monkeypatch, delay):
    """Standard input cannot be read again: the run itself says what it had decided."""
    head, _, rest = DOOR.strip().partition("\n")
    (files / "late.rv").write_text(f"{head}\n{delay}{rest}\n")
    rows = [{"t": 0, "closed": True}, {"t": 1, "knock": True}, {"t": 5}, {"t": 6}]
    lines = [*map(json.dumps, rows), '{"t": 7, "closed": "maybe"}']
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO("\n".join(lines).encode())))
    told = says(2, "run", "late.rv", "-").err
    assert 'line 5: field `closed`: `"maybe"`' in told
    assert JUDGED_BEFORE in told


@pytest.mark.slow
def test_what_was_judged_in_columns_before_a_fault_is_told(files, says):
    rows = "".join(f"{t},1,{t == 1:d}\n" for t in range(200_000))
    (files / "cut.csv").write_text(f"t,closed,knock\n{rows}200000,maybe,0\n")
    told = says(2, "run", "door.rv", "cut.csv").err
    assert "cut.csv: line 200002: column `closed`: `maybe`" in told
    assert JUDGED_BEFORE in told


@pytest.mark.parametrize("words", [["a.csv"], ["a.jsonl"], ["a.csv", "b.csv", "--join"]])
def test_what_is_odd_behind_the_end_is_no_finding(words, tmp_path, monkeypatch, says):
    monkeypatch.chdir(tmp_path)
    signals = "signal x : int\nsignal y : real\nsignal z : bool\n"
    Path("a.rv").write_text(f"spec s\n{signals}requirement R\n  always (x < 9 and y < 9) or z\n")
    Path("b.csv").write_text("t,z\n0,0\n1,0\n")
    begin = [(0, 1, 1), (1, 2, 1), (1, 3, 2), (2, 1, 1)]
    later = [(3 + k // 2, k, "NaN" if k % 4 else 1) for k in range(40)] + [(10**9, 1, 1)]
    found = []
    for rows in (begin, begin + later):
        Path("a.csv").write_text("t,x,y\n" + "".join(f"{t},{x},{y}\n" for t, x, y in rows))
        lines = [f'{{"t": {t}, "x": {x}, "y": {y}, "z": false}}\n' for t, x, y in rows]
        Path("a.jsonl").write_text("".join(lines))
        options = "--allow-missing", "--until", "2.5", "--format", "json"
        told = says(int(words == ["a.csv"]), "run", "a.rv", *words, *options)
        found.append(json.loads(told.out)["health"])
    assert found[0] == found[1]
    assert [one["name"] for one in found[0] if one["kind"] == "conflict"] == ["x", "y"]


@pytest.mark.parametrize(
    ("until", "end", "verdict"),
    [("2", 2, "I"), ("3", 3, "F"), ("3000ms", 3, "F"), ("30", 30, "F")],
)
def test_until_is_the_end_that_is_judged(files, capsys, until, end, verdict):
    """What comes after --until is not judged; time goes on to it where samples end before."""
    (files / "late.csv").write_text(FAIL + "6,,\n9,maybe,\n" if until != "30" else FAIL)
    main(["run", "door.rv", "late.csv", "--until", until, "--format", "json"])
    report = json.loads(capsys.readouterr().out)
    assert report["end"] == end * 10**9
    assert report["requirements"]["D1"]["verdict"] == verdict


def test_binary_standard_input_is_told(files, monkeypatch, says):
    """Bytes that are no UTF-8 are wrong input, in each way a locale may have them decoded."""
    for errors in ("strict", "surrogateescape"):
        binary = io.TextIOWrapper(io.BytesIO(b"\x7fELF\xff\xfe"), "utf-8", errors=errors)
        monkeypatch.setattr("sys.stdin", binary)
        assert "not UTF-8 text" in says(2, "run", "door.rv", "-").err


def test_an_absent_column_is_told(files, says):
    (files / "less.csv").write_text("t,closed\n0,1\n5,0\n")
    shown = says(1, "run", "door.rv", "less.csv", "--allow-missing=knock")
    assert "knock  absent" in shown.out
    assert "less.csv has no column for `knock`" in shown.err


@pytest.mark.parametrize("captured", ["let v = x", "for each v in knock.id"])
def test_of_captured_values_it_is_told_of_the_failures_that_are_shown(captured, files, capsys):
    """Each would take a pass of its own over the recording."""
    (files / "own.rv").write_text(
        "spec own\nsignal x : real\nevent knock(id: int)\nrequirement R\n"
        f"  upon knock\n  then within 1 s x > v\n  {captured}\n"
    )
    knocks = "".join(f"{10 * k},1,{k},{k}\n{10 * k + 5},,,{k + 1}\n" for k in range(1, 6))
    (files / "own.csv").write_text("t,knock,knock.id,x\n" + knocks)
    assert main(["run", "own.rv", "own.csv", "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)["requirements"]["R"]
    assert found["counts"]["F"] == 5
    assert found["late"] == {str(k): (10 * k + 5) * 10**9 for k in (1, 2, 3)}


def run(files, capsys, spec, rows, *words):
    (files / "s.rv").write_text(f"signal a, b : bool\nsignal x : real [cm]\nevent e\n{spec}\n")
    (files / "t.csv").write_text(rows)
    return main(["run", "s.rv", "t.csv", *words]), capsys.readouterr().out


def test_a_forecast_is_shown_beside_the_verdict(files, capsys, says):
    """An open attempt that no continuation can fulfil stays I, and says so."""
    spec = "requirement R1 upon start then (within 3 s a) and for 5 s not a"
    code, shown = run(files, capsys, spec, "t,a\n0,false\n1,false\n", "--report", "pages")
    said = "forecast F: no continuation can fulfil it"
    assert (code, "R1   I" in shown, said in shown) == (0, True, True)
    assert any(said in page.read_text() for page in (files / "pages").rglob("*.html"))
    assert "forecast F" in says(0, "why", "s.rv", "t.csv", "R1").out
