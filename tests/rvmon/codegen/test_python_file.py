"""Monitors as one Python file."""

import ast
from types import ModuleType

import pytest

import rvmon
from rvmon.cli import main
from rvmon.codegen.python_file import python_file
from rvmon.session import Spec
from rvmon.testing.case import Case
from rvmon.testing.differential import campaign
from rvmon.testing.generate_spec import Profile
from rvmon.testing.generate_trace import TraceProfile
from rvmon.verdict.assemble import report_of
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.verdict import Verdict

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


BEYOND = """
requirement D4 "x"
  upon knock
  then immediately c > 1
  let c = knock.force
"""


class Alone:
    """A standalone monitor behind the interface that the differential test drives."""

    def __init__(self, case: Case) -> None:
        declared = {*case.spec.signals, *case.spec.events}
        absent = () if case.names is None else sorted(declared - case.names)
        self.case = case
        self.monitor = loaded(python_file(Spec(case.spec).plan())).SpecMonitor(absent)

    def _attempts(self, found):
        return [Attempt(*one[:4], Verdict(one.verdict), Decision(one.decision)) for one in found]

    def step_ns(self, t, values):
        return self._attempts(self.monitor.step_ns(t, values))

    def advance_ns(self, t):
        return self._attempts(self.monitor.advance_ns(t))

    def finish_ns(self, t=None):
        verdicts = self.monitor.finish_ns(t)
        attempts = self._attempts(self.monitor.attempts)
        report = report_of(tuple(self.case.spec.requirements), attempts)
        assert dict(report.verdicts) == verdicts
        return report


class Skipping:
    """A standalone monitor, or the one in this process where none can be made."""

    made = 0

    def __call__(self, case: Case):
        try:
            alone = Alone(case)
        except rvmon.RvmonError:
            return Spec(case.spec).monitor(sources=case.names)
        self.made += 1
        return alone


def test_the_oracle_agrees():
    """A file of its own judges as the law has it."""
    make = Skipping()
    seeds = [f"file/{number}" for number in range(150)]
    profile = Profile(mixed=False, captures=False, for_each=False)
    tally = campaign(make, seeds, profile, TraceProfile(), online_every=10)
    assert make.made > 100
    assert not tally.disagreements, tally.disagreements[0]


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
        "__future__", "bisect", "collections", "heapq", "itertools", "math", "operator", "typing"
    }  # fmt: skip
    assert not any(
        isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("eval", "exec")
        for node in ast.walk(tree)
    )


def test_it_refuses_what_the_spec_does_not_know():
    """Wrong names, values and times are named and change nothing."""
    monitor = loaded(python_file(rvmon.loads(SPEC).plan())).SpecMonitor()
    monitor.step(0.0, {"closed": True, "knock": {"force": 30.0}})
    for t, values in [(1, {"door": 1}), (1, {"closed": 1}), (1, {"mode": "mad"}), (0, {})]:
        with pytest.raises(ValueError, match=r"expect|no value|later"):
            monitor.step(t, values)
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
