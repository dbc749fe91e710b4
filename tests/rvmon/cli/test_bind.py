"""`rvmon init --for` proposes a binding, and `--binding` of the other commands uses it."""

import math

import pytest
from tests.rvmon.cli.test_run_results import interrupted
from tests.tools.bags import START, write_ros1, write_ros2

from rvmon.cli import main

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

SPEC = """
spec base
signal speed      : real [mm/s]
signal heading    : real [deg]
signal scan_state : {idle, busy}
signal mode       : {idle, busy}
event  go
event  ready
event  pick(id: int)
requirement R1
  always speed < 2 m/s
requirement R2
  upon go
  then within 1 s (heading > 80 deg and mode == busy)
"""
SENT = [
    (
        "/base/odom",
        START,
        {
            "twist": {"twist": {"linear": {"x": 0.6, "y": 0.8}}},
            "pose": {"pose": {"orientation": {"z": math.sin(0.75), "w": math.cos(0.75)}}},
        },
    ),
    ("/base/scan", START + 1, {"state": 1}),
    ("/mode", START + 2, {"data": "busy"}),
    ("/go", START + 3, {}),
    ("/ready", START + 4, {"data": True}),
    ("/pick", START + 5, {"id": 4, "x": 1.0}),
]


@pytest.fixture
def words(tmp_path):
    (tmp_path / "base.rv").write_text(SPEC)
    return [str(tmp_path / "base.rv"), str(write_ros1(tmp_path / "a.bag", SENT))]


def bound(words, says):
    """The proposed binding, completed with the labels that only a person knows."""
    told = says(1, "init", words[1], "--for", words[0])
    assert "`scan_state` is a number" in told.err
    open_labels = '# labels = { 0 = "idle" }  # which number stands for which: it holds 1'
    assert open_labels in told.out
    return told.out.replace(open_labels, 'labels = { 0 = "idle", 1 = "busy" }')


@pytest.mark.slow
def test_a_proposed_binding_works_in_all_commands(words, tmp_path, says):
    proposed = bound(words, says)
    for line in (
        'value = "hypot(twist.twist.linear.x, twist.twist.linear.y)"  # always 1',
        'value = "yaw(pose.pose.orientation)"  # always 1.5',
        'fields = { id = "id" }',
        '[bind.ready]  # event\ntopic = "/ready"\ntype = "std_msgs/msg/Bool"\nvalue = "data"',
    ):
        assert line in proposed
    (tmp_path / "base.toml").write_text(proposed)
    binding = ["--binding", str(tmp_path / "base.toml")]
    assert "does not bind" not in says(0, "check", words[0], *binding).out
    assert main(["run", *words, *binding, "--strict"]) == 0
    assert main(["why", *words, "R2", *binding]) == 0
    assert main(["run", *words, *binding, "--report", str(tmp_path / "pages")]) == 0
    page = "".join(path.read_text() for path in (tmp_path / "pages").rglob("*.html"))
    assert "--binding" in page


def test_a_name_without_a_source_is_left_open(words, tmp_path, says):
    (tmp_path / "base.rv").write_text(SPEC.replace("event  go", "event  go, zapped"))
    told = says(1, "init", words[1], "--for", words[0])
    lines = ("# Nothing was found for `zapped` (event):", "# [bind.zapped]")
    assert "\n".join([*lines, '# topic = "…"', '# value = "…"\n']) in told.out
    assert "the source of `zapped` is left open" in told.err


def test_check_reports_names_that_a_binding_omits(words, put, says):
    binding = put("base.toml", '[bind.go]\ntopic = "/go"\n')
    told = says(0, "check", words[0], "--binding", binding).out
    assert "does not bind speed, heading, scan_state, mode, ready, pick" in told


def test_a_starter_for_parquet_runs_on_the_file(tmp_path, monkeypatch):
    arrow = pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    table = {"t": [0.0, 1.0, 2.0], "speed": [1.0, None, 2.5], "mode": ["idle", "busy", "idle"]}
    pytest.importorskip("pyarrow.parquet").write_table(arrow.table(table), "a.parquet")
    assert main(["init", "a.parquet"]) == 0
    text = " ".join((tmp_path / "a.rv").read_text().split())
    assert "signal speed : real" in text
    assert "{idle, busy}" in text
    assert main(["run", "a.rv", "a.parquet", "--strict"]) == 0


@pytest.mark.slow
def test_a_resumed_run_skips_evaluated_bags(words, tmp_path, monkeypatch, capsys, says):
    runs = tmp_path / "runs"
    runs.mkdir()
    for number in range(3):
        write_ros2(runs / str(number), SENT, "mcap")
    binding = tmp_path / "base.toml"
    binding.write_text(bound(words, says))
    command = ["run", words[0], str(runs), "--binding", str(binding)]
    command += ["--out", str(tmp_path / "out.csv"), "--resume"]
    interrupted(monkeypatch, command)
    (runs / "1" / "1.mcap").touch()
    interrupted(monkeypatch, command)
    assert "2 of 3 recordings were evaluated before" in capsys.readouterr().err
    binding.write_text(binding.read_text().replace('unit = "rad"', 'unit = "rad" '))
    assert "started with another specification" in says(2, *command).err


def test_two_names_on_one_field_are_reported(words, put, says):
    two = SPEC.replace("signal heading ", "signal robot_speed : real [m/s]\nsignal heading ")
    told = says(1, "init", words[1], "--for", put("base.rv", two)).err
    assert "`speed` and `robot_speed` are fed by the same field" in told
    field = 'topic = "/base/odom"\nvalue = "twist.twist.linear.x"\nunit = "m/s"\n'
    put("two.toml", f"[bind.speed]\n{field}[bind.robot_speed]\n{field}")
    told = says(0, "check", "base.rv", "--binding", "two.toml").out
    assert "feeds speed and robot_speed with the same field" in told
