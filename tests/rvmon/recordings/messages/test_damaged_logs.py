"""Damaged logs of vehicles and measurements are reported, or give no passed verdict."""

import random
import re
import struct
from itertools import pairwise

import pytest
from tests.rvmon.recordings.messages.logs import FEW, FORMS, STEADY, written
from tests.tools.logs import write_can

from rvmon.errors import TraceError
from rvmon.recordings.recording import messages_of

pytestmark = pytest.mark.slow  # most of it loads the libraries for these logs


@pytest.mark.parametrize("name", FORMS)
def test_what_is_cut_off_is_never_green(tmp_path, name):
    path, spec = written(tmp_path / "a", name, STEADY)
    data = path.read_bytes()
    assert spec.evaluate(path).verdicts["R1"] == "P"
    rng, judged = random.Random(1), 0
    for _ in range(10):
        path.write_bytes(data[: rng.randrange(1, len(data))])
        try:
            report = spec.evaluate(path)
        except TraceError:
            continue
        judged += 1
        assert report.verdicts["R1"] == "I" or is_whole(path.read_bytes(), data, name)
    assert judged or name in ("a.mf4", "a.h5", "a.mat", "a.blf")


def is_whole(cut, data, name):
    """Whether the cut is between two messages, which such a log cannot show."""
    if name in ("a.asc", "a.log"):
        return cut.endswith(b"\n")
    size = {"a.ulg": 18, "a.bin": 16, "a.tlog": len(data) // len(STEADY)}[name]
    return (len(data) - len(cut)) % size == 0


@pytest.mark.parametrize("name", ["a.bin", "a.tlog"])
def test_what_is_damaged_in_the_middle_is_an_outage(tmp_path, name):
    path, spec = written(tmp_path / "a", name, STEADY)
    data = bytearray(path.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 40] = bytes(40)
    path.write_bytes(data)
    log = messages_of(str(path))
    stamps = [message[1] for message in log.read({f"/{FORMS[name][1]}"})]
    (lost,) = log.outages
    assert (lost.since, lost.until) == max(pairwise(stamps), key=lambda pair: pair[1] - pair[0])
    report = spec.evaluate(path)
    assert report.verdicts["R1"] == "I"
    assert any(
        "no message at byte" in one.remark or "no packet" in one.remark for one in report.health
    )
    rows = [*STEADY[:3], (STEADY[3][0], 7.0, 0), *STEADY[4:]]
    data[:] = written(tmp_path / "a", name, rows)[0].read_bytes()
    data[middle : middle + 40] = bytes(40)
    path.write_bytes(data)
    assert spec.evaluate(path).verdicts["R1"] == "F"


@pytest.mark.parametrize("name", ["a.ulg", "a.mf4", "a.h5", "a.mat", "a.blf"])
def test_a_log_whose_head_is_damaged_is_told(tmp_path, name):
    path, spec = written(tmp_path / "a", name, FEW)
    path.write_bytes(bytes(64) + path.read_bytes()[64:])
    with pytest.raises(TraceError, match=re.escape(name)):
        spec.evaluate(path)


def test_a_group_of_mdf_that_has_fewer_records_than_it_counts_is_told(tmp_path):
    asammdf = pytest.importorskip("asammdf")
    path, spec = written(tmp_path, "a.mf4", FEW)
    with asammdf.MDF(path) as file:
        counted = file.groups[0].channel_group.address + 80
    data = bytearray(path.read_bytes())
    assert struct.unpack_from("<Q", data, counted) == (6,)
    struct.pack_into("<Q", data, counted, 7)
    path.write_bytes(data)
    with pytest.raises(TraceError, match="holds 6 records of a group, but its header counts"):
        spec.evaluate(path)


def test_a_block_of_a_text_that_was_not_written_is_lost(tmp_path):
    """It joins a line with the next one to a line that the library accepts as a frame."""
    _, spec = written(tmp_path, "a.asc", FEW)
    path = write_can(tmp_path / "a.trc", [*FEW[:3], (FEW[3][0], 7.0, 0), *FEW[4:]])
    data = path.read_bytes()
    assert spec.evaluate(path).verdicts["R1"] == "F"
    start = data.rindex(b"\n", 0, data.index(b"E0 40")) + 1
    behind = data.index(b"\n", start) + 9  # in the next line after its number
    path.write_bytes(data[:start] + bytes(behind - start) + data[behind:])
    assert spec.evaluate(path).verdicts["R1"] == "I"


def test_a_packet_whose_kind_is_damaged_is_lost(tmp_path):
    dialect = pytest.importorskip("pymavlink.dialects.v20.ardupilotmega")
    path, spec = written(tmp_path, "a.tlog", FEW)
    data = path.read_bytes()
    assert spec.evaluate(path).verdicts["R1"] == "P"
    size = len(data) // 6
    strange = [(data[: 8 + 7] + b"\x60\xea\x00" + data[8 + 10 : size]) for _ in range(2)]
    path.write_bytes(data[: 3 * size] + strange[0] + data[4 * size :])
    assert spec.evaluate(path).verdicts["R1"] == "I"
    for number in (b"\x60\xea\x00", b"\x8e\0\0"):
        body = data[8 + 1 : 8 + 7] + number + data[8 + 10 : size - 2]
        checksum = dialect.x25crc(body + b"\x71").crc.to_bytes(2, "little")
        other = data[: 8 + 1] + body + checksum
        path.write_bytes(data[:size] + 2 * other + data[size:])
        assert spec.evaluate(path).verdicts["R1"] == "P"
        path.write_bytes(data[:size] + other + data[size:])
        assert spec.evaluate(path).verdicts["R1"] == "I"


@pytest.mark.parametrize("ending", ["asc", "trc"])
def test_a_line_of_can_that_cannot_be_read_is_lost(tmp_path, ending):
    """The library skips it; it may hold a violation, even at its neighbours' stamps."""
    _, spec = written(tmp_path, "a.asc", FEW)
    path = write_can(tmp_path / f"a.{ending}", FEW)
    text = path.read_text()
    frames = [line for line in text.splitlines() if re.search(r" 0*64 .*3F", line)]
    assert len(frames) == 6
    assert spec.evaluate(path).verdicts["R1"] == "P"
    damaged = frames[3].replace("Rx", "Rq", 1).replace(" DT ", " D\u00a7 ", 1)
    without_channel = re.sub(r"(\d) +2 ", r"\1 ", frames[3], count=1)
    others = (without_channel,) if ending == "asc" else ()
    for broken in (*others, damaged, "\0\0\0" + frames[3][5:], frames[3][:12]):
        path.write_text(text.replace(frames[3], broken))
        report = spec.evaluate(path)
        assert report.verdicts["R1"] == "I"
        assert any("a line that cannot be read" in one.remark for one in report.health)
    whole = path.read_text().replace(broken, frames[3])
    path.write_text(whole.replace(frames[5], damaged))
    assert spec.evaluate(path).verdicts["R1"] == "I"
    path.write_text(whole.replace(frames[0], damaged))
    assert spec.evaluate(path).verdicts["R1"] == "I"


def test_a_log_is_lost_after_a_message_that_is_too_short(tmp_path):
    """The ULog library takes it for the end of the file."""
    path, spec = written(tmp_path, "a.ulg", STEADY)
    data = bytearray(path.read_bytes())
    size = 3 + struct.calcsize("<HQfB")
    data[-100 * size : -100 * size + 2] = bytes(2)
    path.write_bytes(data)
    report = spec.evaluate(path)
    assert report.verdicts["R1"] == "I"
    assert any("ends within a message" in one.remark for one in report.health)


@pytest.mark.parametrize("name", ["a.ulg", "a.bin", "a.tlog"])
@pytest.mark.parametrize("place", [0, 3, 5])
@pytest.mark.parametrize("stamp", [2**64 - 1, 2**63 // 1000, 2**62 // 1000 + 1])
def test_a_stamp_that_is_beyond_all_time_is_damage(tmp_path, name, place, stamp):
    path, spec = written(tmp_path, name, FEW)
    order = "big" if name == "a.tlog" else "little"
    data, kept = path.read_bytes(), FEW[place][0].to_bytes(8, order)
    at = data.rindex(kept)
    path.write_bytes(data[:at] + stamp.to_bytes(8, order) + data[at + 8 :])
    if name == "a.ulg":
        with pytest.raises(TraceError, match=r"a\.ulg: time .* is out of range"):
            spec.evaluate(path)
    else:
        assert spec.evaluate(path).verdicts["R1"] == "I"


def test_a_format_that_says_no_length_does_not_hold_up_a_log(tmp_path):
    path, spec = written(tmp_path, "a.bin", FEW)
    data = bytearray(path.read_bytes())
    assert data[89 + 3 : 89 + 9] == bytes([1, 16]) + b"DRV\0"  # the second format
    del data[89 + 4 : 89 + 8]
    path.write_bytes(data)
    with pytest.raises(TraceError, match=r"a\.bin: "):
        spec.evaluate(path)


@pytest.mark.parametrize("ending", ["bin", "trc"])
def test_libraries_print_nothing_about_damage(tmp_path, capfd, caplog, ending):
    """Otherwise a line for each byte of DataFlash, from C, and raw lines of a text."""
    path, spec = written(tmp_path, "a.bin" if ending == "bin" else "a.asc", STEADY)
    if ending == "trc":
        path = write_can(tmp_path / "a.trc", STEADY)
    data = path.read_bytes()
    middle = len(data) // 2
    path.write_bytes(data[:middle] + b"\0\n" + bytes(1000) + data[middle:])
    assert spec.evaluate(path).verdicts["R1"] == "I"
    assert (*capfd.readouterr(), caplog.text) == ("", "", "")
