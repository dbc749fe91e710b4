"""Logs of CAN: messages that have one name."""

import pytest

import rvmon

pytestmark = pytest.mark.slow  # cantools loads all that python-can can read

DATABASE = """VERSION ""
BS_:
BU_: ECU
BO_ {number} Drive: 2 ECU
 SG_ {signal} : 0|8@1+ ({scale},0) [0|0] "" ECU
"""
FRAMES = "(1.0) can0 064#0500\n(1.5) can0 0C8#1E00\n(2.0) can0 064#0700\n(2.5) can0 0C8#2000\n"


def test_messages_of_one_name_are_told_apart_by_their_identifiers(tmp_path):
    for package in ("can", "cantools"):
        pytest.importorskip(package)
    (tmp_path / "a.dbc").write_text(DATABASE.format(number=100, signal="speed", scale=1))
    (tmp_path / "b.dbc").write_text(DATABASE.format(number=200, signal="temp", scale=2))
    (tmp_path / "a.log").write_text(FRAMES)
    spec = rvmon.loads(
        "spec s\nsignal Drive_064.speed, Drive_0C8.temp : real\n"
        "requirement R1\n  always Drive_064.speed < 10\n"
        "requirement R2\n  always Drive_0C8.temp > 59\n"
    )
    report = spec.evaluate(tmp_path / "a.log")
    assert report.verdicts == {"R1": "P", "R2": "P"}
    plain = rvmon.loads(
        "spec s\nsignal Drive.speed : real\nrequirement R1\n  always Drive.speed < 9"
    )
    with pytest.raises(rvmon.TraceError, match=r"did you mean `/Drive_064\.speed`"):
        plain.evaluate(tmp_path / "a.log")
    (tmp_path / "b.dbc").unlink()
    assert plain.evaluate(tmp_path / "a.log").verdicts == {"R1": "P"}
