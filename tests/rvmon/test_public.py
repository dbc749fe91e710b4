"""The public surface: names, lightness, the facade."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import rvmon

ROOT = Path(__file__).parents[2]

DOOR = """
spec door "A door"
signal closed : bool input
signal gap : real [m] input
event knock input
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2 "The door does not open wide"
  always gap < 90 cm
"""


def test_exported_names_are_pinned():
    """Others rely on these names; adding one is a decision, losing one a break."""
    assert rvmon.__all__ == [
        "Attempt",
        "Diagnostic",
        "Monitor",
        "Report",
        "Requirement",
        "RvmonError",
        "Sample",
        "Spec",
        "SpecError",
        "TraceError",
        "Verdict",
        "__version__",
        "load",
        "loads",
    ]
    assert dir(rvmon) == rvmon.__all__  # what completion offers
    for name in rvmon.__all__:
        assert getattr(rvmon, name) is not None


def test_an_unknown_name_is_an_attribute_error():
    """Lazy names do not hide a misspelt one."""
    with pytest.raises(AttributeError, match="lood"):
        rvmon.lood  # noqa: B018


def test_import_loads_nothing_heavy():
    """`import rvmon` must not pull in a parser, arrays, graphs or a terminal library."""
    heavy = ("lark", "numpy", "networkx", "rich", "msgspec", "pymunk")
    code = f"import rvmon, sys; print([m for m in {heavy!r} if m in sys.modules])"
    shown = subprocess.run(  # noqa: S603
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert shown.stdout.strip() == "[]"


@pytest.mark.process
def test_help_of_coverage_loads_nothing_that_reads_or_judges():
    """Only a run of the command does."""
    heavy = ("numpy", "sqlite3", "rvmon.analysis", "rvmon.monitor")
    code = (
        "import sys; from rvmon.cli import main; main(['cover', '--help']); "
        f"print([one for one in {heavy!r} if one in sys.modules])"
    )
    shown = subprocess.run(  # noqa: S603 - the interpreter itself
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert shown.stdout.splitlines()[-1] == "[]"


@pytest.mark.process
def test_a_run_loads_what_it_needs(tmp_path):
    """From the second run on no grammar; of JSON no tables; nothing that it was not asked for."""
    spec, trace = (ROOT / "examples" / name for name in ("base.rv", "base.csv"))
    heavy = ("lark", "numpy.ma", "rich", "rvmon.binding")
    code = (
        "import sys; from rvmon.cli import main; main(sys.argv[1:]); "
        f"print([one for one in {heavy!r} if one in sys.modules])"
    )
    words = [sys.executable, "-c", code, "run", str(spec), str(trace), "--format", "json"]
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    parsed = [
        subprocess.run(  # noqa: S603 - the interpreter itself
            words, capture_output=True, text=True, check=True, env=environment
        ).stdout.splitlines()[-1]
        for _ in range(2)
    ]
    assert parsed == ["['lark']", "[]"]


def test_online_monitor_reports_what_each_step_decides():
    """The example of the first page: a step returns the attempts that it decided."""
    monitor = rvmon.loads(DOOR).monitor()
    assert list(monitor.step(0.0, {"closed": True, "gap": 0.0, "knock": True})) == []
    (decided,) = monitor.step(1.5, {"closed": False, "gap": 0.3})
    assert (decided.requirement, decided.verdict, decided.decided) == ("D1", "P", 1_500_000_000)
    (failed,) = monitor.step(1.75, {"gap": 0.95})
    assert (failed.requirement, failed.verdict) == ("D2", "F")
    assert monitor.finish().verdicts == {"D1": "P", "D2": "F"}


def test_only_judges_what_was_asked_for():
    """`only` leaves the other requirements out; a name that does not exist is an error."""
    spec = rvmon.loads(DOOR)
    assert set(spec.monitor(only=["D2"]).finish().verdicts) == {"D2"}
    with pytest.raises(rvmon.RvmonError, match="no requirement `D9`: there are D1, D2"):
        spec.monitor(only=["D9"])


def test_a_constant_is_overridden():
    """`const` replaces a constant's value before anything is checked."""
    text = DOOR.replace('"A door"', '"A door"\nconst T = 2 s').replace("within 2 s", "within T")
    trace = [(0.0, {"closed": True, "gap": 0.0, "knock": True}), (1.5, {"closed": False})]
    assert rvmon.loads(text).evaluate(trace).verdicts["D1"] == "P"
    assert rvmon.loads(text, const={"T": "1 s"}).evaluate(trace).verdicts["D1"] == "F"


def test_spec_errors_carry_diagnostics(tmp_path):
    """A wrong spec is one exception with all findings, and its text is for people."""
    path = tmp_path / "door.rv"
    path.write_text(DOOR.replace("not closed", "not clozed").replace("90 cm", "90 kg"))
    with pytest.raises(rvmon.SpecError) as caught:
        rvmon.load(path)
    assert len(caught.value.diagnostics) == 2
    assert "clozed" in str(caught.value)
    assert "help: did you mean `closed`?" in str(caught.value)
    assert f"{path}:8" in str(caught.value)


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00spec"])
def test_an_unreadable_spec_is_a_spec_error(tmp_path, content):
    """A missing or binary file is a SpecError with the path, no other exception."""
    path = tmp_path / "door.rv"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(rvmon.SpecError, match=r"door\.rv"):
        rvmon.load(path)
