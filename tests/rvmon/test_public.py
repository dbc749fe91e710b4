"""The public surface: names, lightness, the facade."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import rvmon

ROOT = Path(__file__).parents[2]


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
    with pytest.raises(AttributeError, match="lood"):
        rvmon.lood  # noqa: B018


def test_import_loads_nothing_heavy():
    heavy = ("lark", "numpy", "networkx", "rich", "msgspec", "pymunk")
    code = f"import rvmon, sys; print([m for m in {heavy!r} if m in sys.modules])"
    shown = subprocess.run(  # noqa: S603
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert shown.stdout.strip() == "[]"


@pytest.mark.process
def test_help_loads_nothing_that_reads_or_judges():
    """Only a run of a command does."""
    heavy = (
        *("numpy", "sqlite3", "msgspec", "rich", "rvmon.analysis", "rvmon.language"),
        *("rvmon.monitor", "rvmon.recordings", "rvmon.session"),
    )
    code = (
        "import sys; from rvmon.cli import COMMANDS, main; "
        "[main([name, '--help']) for name in COMMANDS]; "
        f"print([one for one in {heavy!r} if one in sys.modules])"
    )
    shown = subprocess.run(  # noqa: S603 - the interpreter itself
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert shown.stdout.splitlines()[-1] == "[]"


@pytest.mark.process
def test_a_run_loads_what_it_needs(tmp_path):
    """From the second run on no grammar; nothing that it was not asked for."""
    spec, trace = (ROOT / "examples" / name for name in ("base.rv", "base.csv"))
    heavy = ("lark", "numpy.ma", "rich", "rvmon.monitor.robustness", "rvmon.recordings.binding")
    code = (
        "import sys; from rvmon.cli import main; main(sys.argv[1:]); "
        f"print([one for one in {heavy!r} if one in sys.modules])"
    )
    words = [sys.executable, "-c", code, "run", str(spec), str(trace)]
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    parsed = [
        subprocess.run(  # noqa: S603 - the interpreter itself
            words, capture_output=True, text=True, check=True, env=environment
        ).stdout.splitlines()[-1]
        for _ in range(2)
    ]
    assert parsed == ["['lark']", "[]"]
