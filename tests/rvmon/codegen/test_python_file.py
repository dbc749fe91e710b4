"""Monitors as one Python file."""

import ast
import subprocess
import sys
from types import ModuleType

import pytest
from tests.tools.differential import campaign

import rvmon
from rvmon.cli import main
from rvmon.codegen.python_file import python_file
from rvmon.testing.forms import Maker
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

SPEC = """
spec door "A door"
signal closed : bool
signal mode : {idle, busy}
event knock(force: real)
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2 "Busy doors stay shut"
  whenever mode == busy
  then closed
requirement D3 "Hard knocks are rare"
  always not knock.force > 20
"""


def loaded(text: str) -> ModuleType:
    module = ModuleType("generated_monitor")
    exec(compile(text, "generated_monitor", "exec"), module.__dict__)  # noqa: S102
    return module


@pytest.mark.law
def test_the_oracle_agrees():
    """A file of its own judges as the law has it."""
    seeds = [f"file/{number}" for number in range(20)]
    profile = Profile(mixed=False, captures=False, for_each=False)
    tally = campaign(Maker("file"), seeds, profile, TraceProfile(), online_every=10)
    assert tally.pairs > 10
    assert not tally.disagreements, tally.disagreements[0]


@pytest.mark.slow
def test_it_is_python_3_8_and_imports_the_standard_library_only():
    """Installations with an old interpreter can carry it."""
    text = python_file(rvmon.loads(SPEC).plan())
    tree = ast.parse(text, feature_version=(3, 8))
    imported = {
        (node.module if isinstance(node, ast.ImportFrom) else node.names[0].name).split(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    assert imported <= {
        "__future__", "array", "bisect", "collections", "heapq", "itertools", "math", "operator",
        "typing",
    }  # fmt: skip
    assert not any(
        isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("eval", "exec")
        for node in ast.walk(tree)
    )


def test_no_class_is_subscripted_as_it_runs():
    """`tuple[int, ...]` is an error before Python 3.9, unless nobody evaluates it."""
    tree = ast.parse(python_file(rvmon.loads(SPEC).plan()))
    tree.body = [one for one in tree.body if not isinstance(one, ast.If)]  # TYPE_CHECKING
    found = []

    class Evaluated(ast.NodeVisitor):
        def visit_AnnAssign(self, node):
            if node.value is not None:
                self.visit(node.value)

        def visit_arg(self, node):
            """An annotation."""

        def visit_FunctionDef(self, node):
            for one in (*node.body, node.args):
                self.visit(one)

        def visit_Subscript(self, node):
            if isinstance(node.value, ast.Name) and node.value.id in ("tuple", "list", "dict"):
                found.append(ast.unparse(node))
            self.generic_visit(node)

    Evaluated().visit(tree)
    assert not found


def test_it_refuses_what_the_spec_does_not_know():
    """Wrong names, values and times are named and change nothing."""
    monitor = loaded(python_file(rvmon.loads(SPEC).plan())).SpecMonitor()
    monitor.step(0.0, {"closed": True, "knock": {"force": 30.0}})
    for t, values in [(1, {"door": 1}), (1, {"closed": 1}), (1, {"mode": "mad"}), (0, {})]:
        with pytest.raises(ValueError, match=r"expect|no value|later"):
            monitor.step(t, values)
    for values in (5, None, "ab", ["closed", "mode", "knock"]):
        with pytest.raises(ValueError, match="expected values by name"):
            monitor.step_ns(1, values)
    [failed] = monitor.step(2.5, {"mode": "busy"})
    assert (failed.requirement, failed.verdict, failed.decided) == ("D1", "F", 2 * 10**9 + 1)
    assert monitor.finish_ns() == {"D1": "F", "D2": "P", "D3": "F"}


def test_names_of_a_spec_stay_text():
    """Whatever a title or an id holds, it becomes a literal or a comment of one line."""
    hostile = SPEC.replace('"A door"', '"A\'; import os #"').replace("door", "eval")
    loaded(python_file(rvmon.loads(hostile).plan()))


def test_the_command_writes_a_file(tmp_path, capsys):
    """`rvmon compile --to python` writes the file, and says why it cannot."""
    spec = tmp_path / "door.rv"
    spec.write_text(SPEC)
    assert main(["compile", str(spec), "--to", "python", "-o", str(tmp_path / "m.py")]) == 0
    assert hasattr(loaded((tmp_path / "m.py").read_text()), "SpecMonitor")
    spec.write_text(
        SPEC
        + '\nrequirement D4 "x"\n  upon knock\n  then immediately c > 1\n  let c = knock.force\n'
    )
    assert main(["compile", str(spec), "--to", "python"]) == 2
    assert "D4" in capsys.readouterr().err


def test_run_as_a_script_it_says_how_it_is_used(tmp_path):
    """Whoever runs the file sees what to import from it."""
    path = tmp_path / "door.py"
    path.write_text(python_file(rvmon.loads(SPEC).plan()), encoding="utf-8")
    words = [sys.executable, path]
    done = subprocess.run(words, capture_output=True, text=True, check=True)  # noqa: S603
    assert "monitor = SpecMonitor()" in done.stdout


@pytest.mark.slow
def test_too_many_combinations_for_a_table_are_refused():
    """Generated Python has tables; the message says what else judges the requirement."""
    names = [f"s{number}" for number in range(18)]
    owed = " or ".join(f"(within {number} s {name})" for number, name in enumerate(names, 1))
    spec = rvmon.loads(
        f"spec s\nsignal {', '.join(names)} : bool\nrequirement R1\n  upon start\n  then {owed}\n"
    )
    with pytest.raises(rvmon.RvmonError, match=r"R1 has no automaton .*rvmon build"):
        python_file(spec.plan())
    monitor = spec.monitor()
    monitor.step(0, dict.fromkeys(names, False))
    [passed] = monitor.step(17.5, {"s17": True})
    assert (passed.verdict, passed.decided) == ("P", 17_500_000_000)
