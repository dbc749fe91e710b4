"""Programs of `rvmon build --robustness`: with each attempt its robustness."""

import json
import math
import random
import struct
import subprocess

import pytest

from rvmon.cli import main
from rvmon.codegen.c_build import FLAGS

pytestmark = pytest.mark.compiler

SPEC = """
spec measure
signal x : real [cm]
signal v : real [m/s]
event e
requirement R1
  always (x > 5 cm -> within 3 s v < 2 m/s)
requirement R2
  upon e then within 2 s x > 10 cm
requirement R3
  whenever once[0 s, 1 s] x > 8 cm then v < 2.5 m/s
requirement R4
  upon rise(v > 1 m/s) then within 1 s e
requirement R5
  upon e then always v < 20 m/s
"""
NAMES = ("x", "v", "e")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The specification, its program, and a recording in each format; some lines are alike."""
    path = tmp_path_factory.mktemp("measure")
    (path / "s.rv").write_text(SPEC)
    rng, t = random.Random(3), 0
    csv, lines = ["t_ns,x,v,e"], []
    packed = b"rvmonbin" + struct.pack("=I", 3)
    packed += b"".join(struct.pack("=I", 1) + name.encode() for name in NAMES)
    cells = (0.0, 0.0, None)
    for _ in range(400):
        t += rng.choice((1, 300_000_000, 700_000_000, 1_000_000_000))
        if rng.random() < 0.7:
            x = rng.choice((None, math.nan, *(rng.uniform(0, 14),) * 6))
            cells = (x, rng.uniform(0, 4), rng.choice((None, None, None, 1)))
        csv.append(f"{t}," + ",".join("" if cell is None else f"{cell}" for cell in cells))
        said = {name: cell for name, cell in zip(NAMES, cells, strict=True) if cell is not None}
        plain = {name: None if cell != cell else cell for name, cell in said.items()}
        lines.append(json.dumps({"t_ns": t, **plain} | ({"e": True} if "e" in said else {})))
        states = [0 if cell is None else 2 if cell != cell else 3 for cell in cells]
        packed += struct.pack("=q3d3B", t, *(cell or 0.0 for cell in cells), *states)
    (path / "a.csv").write_text("\n".join(csv) + "\n")
    (path / "a.jsonl").write_text("\n".join(lines) + "\n")
    (path / "a.bin").write_bytes(packed)
    with pytest.MonkeyPatch.context() as patch:
        strict = (*FLAGS, "-Werror", "-fsanitize=address,undefined", "-fno-sanitize-recover")
        patch.setattr("rvmon.codegen.c_build.FLAGS", strict)
        made = str(path / "judge")
        assert main(["build", str(path / "s.rv"), "--robustness", "-o", made]) == 0
    return path


def told(folder, name):
    """What the program prints of a recording."""
    words = [folder / "judge", folder / name]
    done = subprocess.run(words, capture_output=True, text=True, check=False)  # noqa: S603
    assert (done.returncode, done.stderr) == (1, "")
    return json.loads(done.stdout)["requirements"]


@pytest.mark.parametrize("name", ["a.csv", "a.jsonl"])
def test_each_attempt_has_the_robustness_that_run_prints(folder, name, capsys):
    """The same figures, bit for bit; none where it has none, null where it is infinite."""
    words = ["run", str(folder / "s.rv"), str(folder / name), "--robustness", "--format", "json"]
    main(words)
    expected = json.loads(capsys.readouterr().out)["requirements"]
    printed = ("number", "triggered", "decided", "verdict", "decision", "in_doubt", "robustness")
    for requirement, found in told(folder, name).items():
        wanted = expected[requirement]["attempts"]
        assert [{key: one[key] for key in printed if key in one} for one in found["attempts"]] == [
            {key: one[key] for key in printed if key in one} for one in wanted
        ]
    figures = {
        one.get("robustness", "none") for own in expected.values() for one in own["attempts"]
    }
    assert {"none", None} < figures
    assert len(figures) > 20


def test_the_fixed_layout_is_measured_as_csv_is(folder):
    """All formats that a program reads lead to the same report."""
    assert told(folder, "a.bin") == told(folder, "a.csv")


def test_what_c_does_not_measure_is_refused(tmp_path, capsys):
    """Which requirement, and why."""
    (tmp_path / "s.rv").write_text(
        "spec s\nsignal x : real\nevent e\nrequirement R1\n"
        "  upon e then within 2 s x > v\n  let v = x\n"
    )
    words = ["build", str(tmp_path / "s.rv"), "--robustness", "-o", str(tmp_path / "judge")]
    assert main(words) == 2
    told = capsys.readouterr().err
    assert "R1 uses `let`; compiled C, which measures, cannot evaluate it: leave it out" in told
    assert not (tmp_path / "judge").exists()
