"""The engine `auto` on files: what it takes for short and for long ones."""

import sys

import pytest

import rvmon
from rvmon.execute.command import run
from rvmon.readers import recording

SPEC = "spec s\nsignal p : bool\nsignal x : real\nrequirement R1\n  upon p then within 2 s x > 1\n"
CSV = "t,p,x\n0,0,0.5\n1,1,0.25\n5,0,2.5\n6,1,2.5\n"


def test_a_short_file_is_judged_as_a_long_one(tmp_path, monkeypatch):
    """The reports are the same, but for the engine."""
    (tmp_path / "a.csv").write_text(CSV)
    spec = rvmon.loads(SPEC)
    short = spec.evaluate(tmp_path / "a.csv")
    monkeypatch.setattr(recording, "SHORT", 0)
    assert spec.evaluate(tmp_path / "a.csv") == short
    assert short.verdicts == {"R1": "F"}


@pytest.mark.process
@pytest.mark.parametrize("module", ["numpy", "lark", "rvmon.spec.compile"])
def test_a_short_file_needs_little(module, tmp_path, monkeypatch):
    """With the specification in the cache neither NumPy nor parser nor compiler is imported."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    (tmp_path / "s.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text(CSV)
    rvmon.load(tmp_path / "s.rv")
    told = (
        "import sys; from rvmon.cli import main; "
        f"main(['run', {str(tmp_path / 's.rv')!r}, {str(tmp_path / 'a.csv')!r}]); "
        f"print({module!r} in sys.modules)"
    )
    done = run([sys.executable, "-c", told])
    assert done.stdout.splitlines()[-1] == "False", done.stderr
