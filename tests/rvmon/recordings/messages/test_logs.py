"""Logs of vehicles and measurements: same records as CSV; losses and units in logs."""

import random
import struct

import pytest
from tests.rvmon.recordings.messages.logs import (
    FEW,
    FORMS,
    SPEC,
    STEADY,
    write_csv,
    write_dataflash,
    write_hdf5,
    written,
)
from tests.tools.logs import write_can, write_ulog

import rvmon
from rvmon.cli import main
from rvmon.errors import TraceError
from rvmon.recordings.recording import messages_of

pytestmark = pytest.mark.slow  # most of it loads the libraries for these logs

OF_ALL, OF_CAN = (1, 1_003, 10_000), (15_625, 31_250)
"""Microseconds between messages; logs of CAN count from their start, and BLF drops fractions."""


def rows_at_random(seed, count=150, steps=OF_ALL):
    rng = random.Random(seed)
    t, rows = 1_000_000, []
    for _ in range(count):
        t += rng.choice(steps)
        rows.append((t, rng.choice([0.0, 0.25, 1.0, 1.125, 1.5]), rng.randrange(5)))
    return rows


@pytest.mark.parametrize("name", FORMS)
def test_a_log_gives_the_records_that_csv_gives(tmp_path, name):
    verdicts = set()
    for seed in range(2):
        rows = rows_at_random(seed, steps=OF_CAN if name in ("a.asc", "a.blf") else OF_ALL)
        path, spec = written(tmp_path / str(seed), name, rows)
        topic = FORMS[name][1]
        first = next(messages_of(str(path)).read({f"/{topic}"}))[1] // 1_000 - rows[0][0]
        rows = [(t + first, speed, mode) for t, speed, mode in rows]
        table = write_csv(tmp_path / f"{seed}.csv", rows, topic)
        found, expected = spec.evaluate(path), rvmon.loads(SPEC.format(topic)).evaluate(table)
        assert found.attempts == expected.attempts
        assert (found.verdicts, found.end) == (expected.verdicts, expected.end)
        verdicts |= {str(attempt.verdict) for attempt in found.attempts}
    assert {"P", "F"} <= verdicts


def test_what_the_logger_dropped_is_an_outage(tmp_path):
    path, spec = written(tmp_path, "a.ulg", STEADY)
    write_ulog(path, STEADY, drops=[(100, 30)])
    report = spec.evaluate(path)
    assert report.verdicts["R1"] == "I"
    [found] = [one for one in report.health if one.remark == "the logger dropped messages"]
    assert found.first == 1_100_000_000
    assert spec.robustness(path).attempts


@pytest.mark.parametrize("drops", [[], [(100, 30)]])
def test_what_one_of_several_files_lost_is_lost_of_their_recording(tmp_path, drops):
    pytest.importorskip("pyulog")
    files = [write_ulog(tmp_path / "a.ulg", STEADY, drops=drops), tmp_path / "b.csv"]
    files[1].write_text("t,lamp\n1,true\n1.2,true\n")
    spec = "signal drive.speed : real\nsignal lamp : bool\nrequirement {}\n  always {}"
    found = [
        rvmon.loads(spec.format(*one)).evaluate(files).verdicts[one[0]].value
        for one in (("R1", "drive.speed < 1"), ("R2", "lamp"))
    ]
    assert found == (["I", "P"] if drops else ["P", "P"])


def test_messages_without_a_stamp_are_lost_and_those_of_other_topics_are_not(tmp_path):
    rows = [(1_000_000, 0.0, 0), (0, 9.0, 0), (1_001_000, 0.0, 0)]
    path, spec = written(tmp_path, "a.ulg", rows)
    report = spec.evaluate(path)
    assert any(one.remark == "messages have no stamp" for one in report.health)
    assert report.verdicts["R1"] == "I"


def test_units_that_a_log_says_are_compared(tmp_path):
    path, _ = written(tmp_path, "a.asc", FEW)
    for unit, why in (("rad", "is in [m/s]"), ("km/h", "evaluated without conversion")):
        text = "spec s\nsignal Drive.speed : real [{0}]\nrequirement R\n always Drive.speed < 1 {0}"
        spec = rvmon.loads(text.format(unit))
        with pytest.raises(TraceError, match=r"Drive\.speed") as caught:
            spec.evaluate(path)
        assert why in str(caught.value)


def test_a_database_is_named_in_a_binding_or_lies_beside(tmp_path):
    path, spec = written(tmp_path, "a.asc", FEW)
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    (tmp_path / "car.dbc").rename(folder / "car.dbc")
    with pytest.raises(TraceError, match=r"put the database \(\.dbc\) beside it"):
        spec.evaluate(path)
    (tmp_path / "b.toml").write_text('definitions = ["elsewhere/car.dbc"]\n')
    assert spec.evaluate(path, binding=tmp_path / "b.toml").attempts


@pytest.mark.slow
def test_scaled_numbers_are_the_nearest_doubles(tmp_path):
    """33709 hundredths are 337.09, as mavlogdump writes them, and not 337.09000000000003."""
    pytest.importorskip("pymavlink")
    rows = [(1_000 * n, n, 0) for n in range(0, 65_536, 5)]
    path = write_dataflash(tmp_path / "a.bin", rows, "C")
    found = [content["speed"] for _, _, content in messages_of(str(path)).read({"/DRV"})]
    assert found == [n / 100 for n in range(0, 65_536, 5)]


def test_other_lines_than_frames_of_can_are_not_losses(tmp_path):
    """Comments, statistics, the state of the chip; an error frame is a loss."""
    path, spec = written(tmp_path, "a.asc", FEW[:3])
    *head, first, second, third, end = path.read_text().splitlines()
    others = [
        "// a comment",
        "   0.0005 1  Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0.00%",
        "   0.0005 CAN 1 Status:chip status error active",
        "   0.0005 1  ErrorFrame",
        "   0.0006 log trigger event",
        "",
    ]
    path.write_text("\n".join([*head, first, *others, second, third, end]) + "\n")
    report = spec.evaluate(path)
    assert report.verdicts["R1"] == "P"
    assert not any("cannot be read" in one.remark for one in report.health)


@pytest.mark.parametrize(
    ("ending", "line", "verdict"),
    [
        ("log", "(1.0025) vcan0 20000004#0001000000000000", "I"),
        ("log", "(1.0025) vcan0 20000006#0003000000000000", "I"),
        ("log", "DROPCOUNT: dropped 2 CAN frames on 'vcan0' socket (total drops 2)", "I"),
        ("log", "(1.0025) vcan0 20000004#0004000000000000", "P"),
        ("log", "(1.0025) vcan0 20000064#0000000000000000", "P"),  # 64 is Drive as well
        ("trc", "   4)  1002.5 Warng FFFFFFFF 4 00 00 00 02 OVERRUN", "I"),
        ("trc", "   4   1002.500 ST     Rx - 4 00 00 00 40", "I"),
        ("trc", "   4   1002.500 ST     Rx - 4 00 00 00 0C", "P"),
    ],
)
def test_losses_recorded_in_a_log_of_can(tmp_path, ending, line, verdict):
    """Overflowed frames are lost; an error frame has no content."""
    _, spec = written(tmp_path, "a.asc", FEW)
    path = write_can(tmp_path / f"a.{ending}", FEW)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:-3], line, *lines[-3:]]) + "\n")
    report = spec.evaluate(path)
    assert report.verdicts["R1"] == verdict
    lost = [one.remark for one in report.health if "frames were lost" in one.remark]
    assert bool(lost) is (verdict == "I")


@pytest.mark.parametrize("kinds", [{1: 125}, {2: 126}, {1: 125, 4: 126}, {6: 125}])
def test_what_a_binary_log_of_can_lost_is_unknown(tmp_path, kinds):
    path, spec = written(tmp_path, "a.blf", FEW)
    report = spec.evaluate(write_can(path, FEW, kinds))
    assert [one.remark for one in report.health if "frames were lost" in one.remark]
    assert report.verdicts["R1"] == "I"


def test_states_have_their_names_and_named_values_of_a_number_are_unknown(tmp_path):
    path, _ = written(tmp_path, "a.asc", [(1_000_000, 0.5, 1), (1_001_000, 0.25, 7)])
    text = (tmp_path / "car.dbc").read_text()
    (tmp_path / "car.dbc").write_text(text + 'VAL_ 100 mode 0 "idle" 1 "busy" ;\n')
    content = [dict(one) for _, _, one in messages_of(str(path)).read({"/Drive"})]
    assert [one["mode"] for one in content] == ["busy", "7"]
    (tmp_path / "car.dbc").write_text(
        text.replace('255] ""', '255] "m"') + 'VAL_ 100 mode 7 "none" ;\n'
    )
    content = [dict(one) for _, _, one in messages_of(str(path)).read({"/Drive"})]
    assert [one["mode"] for one in content] == [1, None]


def test_the_stamps_of_arrays_can_be_named(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["data/when"] = [0, 10, 20]
        file["data/speed"] = [1.0, 2.0, 3.0]
    spec = rvmon.loads("spec s\nsignal data.speed : real\nrequirement R\n always data.speed < 3")
    with pytest.raises(TraceError, match="no array has a usual name of stamps"):
        spec.evaluate(path)
    assert spec.evaluate(path, time="data/when:ms").attempts[0].decided == 20_000_000


@pytest.mark.parametrize("name", FORMS)
def test_first_specifications_are_made_of_it_and_pass(tmp_path, monkeypatch, name):
    path, _ = written(tmp_path / "a", name, rows_at_random(3))
    monkeypatch.chdir(tmp_path)
    assert main(["init", str(path), "-o", "mine.rv"]) == 0
    assert main(["run", "mine.rv", str(path)]) == 0


def test_a_downward_axis_is_not_a_height_or_climb_rate(tmp_path, says):
    """In flight z points down: its velocity as a climb rate would have the wrong sign."""
    mavlink = pytest.importorskip("pymavlink.dialects.v20.ardupilotmega")
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    with (tmp_path / "a.tlog").open("wb") as file:
        for n in range(20):
            packet = link.local_position_ned_encode(n, 0, 0, -n, 0, 0, -1.0).pack(link)
            file.write((1_000_000 + n * 1_000).to_bytes(8, "big") + packet)
    text = "spec s\nsignal climb_rate : real [m/s]\nsignal speed_z : real [m/s]\n"
    text += "requirement R\n always (climb_rate < 2 m/s and speed_z < 2 m/s)\n"
    (tmp_path / "a.rv").write_text(text)
    told = says(1, "init", tmp_path / "a.tlog", "--for", tmp_path / "a.rv")
    assert 'value = "vz"' in told.out.partition("[bind.speed_z]")[2]
    assert "`climb_rate` is left open" in told.err


NAMED_ALIKE = """VERSION ""
BS_:
BU_: ECU
BO_ {number} Drive: 2 ECU
 SG_ {signal} : 0|8@1+ ({scale},0) [0|0] "" ECU
"""


def test_a_channel_with_a_name_is_called_by_it(tmp_path):
    """As candump writes it; other logs number their channels."""
    pytest.importorskip("can")
    (tmp_path / "a.dbc").write_text(NAMED_ALIKE.format(number=100, signal="speed", scale=1))
    (tmp_path / "a.log").write_text("(1.0) can0 064#0500\n(1.5) vcan1 064#1E00\n")
    assert list(messages_of(str(tmp_path / "a.log")).topics) == ["/can0/Drive", "/vcan1/Drive"]


FRAMES_OF_TWO = (
    "(1.0) can0 064#0500\n(1.5) can0 0C8#1E00\n(2.0) can0 064#0700\n(2.5) can0 0C8#2000\n"
)


def test_messages_of_one_name_are_told_apart_by_their_identifiers(tmp_path):
    pytest.importorskip("can")
    (tmp_path / "a.dbc").write_text(NAMED_ALIKE.format(number=100, signal="speed", scale=1))
    (tmp_path / "b.dbc").write_text(NAMED_ALIKE.format(number=200, signal="temp", scale=2))
    (tmp_path / "a.log").write_text(FRAMES_OF_TWO)
    spec = rvmon.loads(
        "spec s\nsignal Drive_064.speed, Drive_0C8.temp : real\n"
        "requirement R1\n  always Drive_064.speed < 10\n"
        "requirement R2\n  always Drive_0C8.temp > 59\n"
    )
    report = spec.evaluate(tmp_path / "a.log")
    assert report.verdicts == {"R1": "P", "R2": "P"}
    plain = rvmon.loads("signal Drive.speed : real\nrequirement R1\n  always Drive.speed < 9")
    with pytest.raises(rvmon.TraceError, match=r"did you mean `/Drive_064\.speed`"):
        plain.evaluate(tmp_path / "a.log")
    (tmp_path / "b.dbc").unlink()
    assert plain.evaluate(tmp_path / "a.log").verdicts == {"R1": "P"}


def test_arrays_of_groups_that_differ_in_signs_alone_are_told_apart(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        for name, speed in (("arm 1", 9.0), ("arm-1", 0.5)):
            file[f"{name}/t"] = [0.0, 1.0]
            file[f"{name}/speed"] = [speed, speed]
    spec = rvmon.loads(
        "signal arm_1.speed, arm_1_2.speed : real\n"
        "requirement R1\n  always arm_1.speed < 1\nrequirement R2\n  always arm_1_2.speed < 1\n"
    )
    assert spec.evaluate(path).verdicts == {"R1": "F", "R2": "P"}


def test_an_instance_of_a_topic_and_a_topic_that_is_called_so_are_told_apart(tmp_path):
    path, _ = written(tmp_path, "a.ulg", FEW[:1])

    def message(kind, body):
        return struct.pack("<H", len(body)) + kind + body

    fields = b":uint64_t timestamp;float speed;"
    parts = [
        path.read_bytes()[:16],
        message(b"F", b"arm" + fields),
        message(b"F", b"arm_1" + fields),
        message(b"A", struct.pack("<BH", 1, 0) + b"arm"),
        message(b"A", struct.pack("<BH", 0, 1) + b"arm_1"),
        message(b"D", struct.pack("<HQf", 0, 1_000_000, 9.0)),
        message(b"D", struct.pack("<HQf", 1, 1_000_000, 0.5)),
    ]
    path.write_bytes(b"".join(parts))
    spec = rvmon.loads(
        "signal arm_1.speed, arm_1_2.speed : real\n"
        "requirement R1\n  always arm_1.speed < 1\nrequirement R2\n  always arm_1_2.speed < 1\n"
    )
    assert spec.evaluate(path).verdicts == {"R1": "F", "R2": "P"}


def test_values_that_a_measurement_marks_as_invalid_are_unknown_at_their_instants(tmp_path):
    asammdf = pytest.importorskip("asammdf")
    numpy = pytest.importorskip("numpy")
    path = tmp_path / "a.mf4"
    times, marks = numpy.arange(4.0), numpy.array([True, False, True, False])
    with asammdf.MDF() as file:
        values = numpy.array([9.0, 0.5, 9.0, 0.25])
        signal = asammdf.Signal(values, times, name="speed", invalidation_bits=marks)
        file.append([signal], acq_name="drive", common_timebase=True)
        file.save(path)
    spec = rvmon.loads("signal drive.speed : real\nrequirement R1\n  always drive.speed < 1\n")
    found = [(one.t // 10**9, one.values["drive.speed"]) for one in spec.recording(path)]
    assert found == [(0, None), (1, 0.5), (2, None), (3, 0.25)]


def test_groups_of_arrays_may_be_empty_and_lead_back_to_those_above(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = write_hdf5(tmp_path / "a.h5", FEW)
    spec = rvmon.loads(SPEC.format("drive"))
    whole = spec.evaluate(path)
    with h5py.File(path, "a") as file:
        file["idle/t"] = []
        file["drive/root"] = h5py.SoftLink("/")
    report = spec.evaluate(path)
    assert (report.attempts, report.end) == (whole.attempts, whole.end)
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["drive/t"], file["drive/speed"], file["drive/mode"] = [], [], []
    with pytest.raises(TraceError, match=r"b\.h5: holds no sample"):
        spec.evaluate(tmp_path / "b.h5")
