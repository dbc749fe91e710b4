"""The public interface: exported names, and which modules an import loads."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import rvmon

ROOT = Path(__file__).parents[2]


def test_exported_names_are_pinned():
    """Users rely on these names: removing one breaks them, adding one is a decision."""
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
    assert dir(rvmon) == rvmon.__all__  # for completion
    for name in rvmon.__all__:
        assert getattr(rvmon, name) is not None
    with pytest.raises(AttributeError, match="lood"):
        rvmon.lood  # noqa: B018


def loaded(names, code, *words, **environment):
    """The modules among `names` that a new process has loaded after some code."""
    program = f"import sys; {code}; print([name for name in {names!r} if name in sys.modules])"
    shown = subprocess.run(  # noqa: S603 - the interpreter itself
        [sys.executable, "-c", program, *words],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **environment},
    )
    return ast.literal_eval(shown.stdout.splitlines()[-1])


def test_import_loads_nothing_heavy():
    heavy = ("lark", "numpy", "networkx", "rich", "msgspec", "pymunk")
    assert loaded(heavy, "import rvmon") == []


@pytest.mark.process
def test_help_loads_nothing_that_reads_or_evaluates():
    heavy = (
        *("numpy", "sqlite3", "msgspec", "rich", "rvmon.analysis", "rvmon.language"),
        *("rvmon.monitor", "rvmon.recordings", "rvmon.session"),
    )
    code = "from rvmon.cli import COMMANDS, main; [main([name, '--help']) for name in COMMANDS]"
    assert loaded(heavy, code) == []


@pytest.mark.process
def test_a_run_loads_only_what_it_needs(tmp_path):
    """The parser generator is loaded only without a cached specification."""
    spec, trace = (str(ROOT / "examples" / name) for name in ("base.rv", "base.csv"))
    heavy = ("lark", "numpy.ma", "rich", "rvmon.monitor.robustness", "rvmon.recordings.binding")
    code = "from rvmon.cli import main; main(sys.argv[1:])"
    for expected in (["lark"], []):
        assert loaded(heavy, code, "run", spec, trace, XDG_CACHE_HOME=str(tmp_path)) == expected
