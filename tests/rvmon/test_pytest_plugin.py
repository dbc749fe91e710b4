"""The plugin for pytest, in a separate pytest."""

import pytest
from tests import WITHOUT

pytest_plugins = ["pytester"]
SPEC = """
spec door
signal closed : bool
event knock
requirement D1 "Knocking opens the door"
  upon knock
  then within 2 s not closed
requirement D2
  always not closed
"""


@pytest.fixture
def folder(pytester, monkeypatch):
    """A folder with a specification, for a pytest with few plugins."""
    monkeypatch.setenv("PYTEST_ADDOPTS", WITHOUT)
    pytester.makefile(".rv", door=SPEC)
    return pytester


def _run(folder, test, *words):
    folder.makepyfile(test)
    return folder.runpytest_subprocess("-p", "no:cacheprovider", *words)


@pytest.mark.process
def test_an_unexpected_verdict_fails_the_test_with_an_explanation(folder):
    (folder.path / "run.csv").write_text("t,closed,knock\n0,1,1\n3,,\n")
    told = _run(
        folder,
        """
        def test_fails(rv):
            door = rv("door.rv", only=["D1"])
            door.step(0, {"closed": True, "knock": True})
            door.step(3, {"closed": True})
            rv("door.rv", only=["D2"]).step(0, {"closed": True})

        def test_passes(rv):
            rv("door.rv", only=["D1"]).step(0, {"closed": False, "knock": True})

        def test_expected(rv):
            assert rv("door.rv", expect={"D1": "F", "D2": "F"}).check("run.csv").end == 3 * 10**9

        def test_strict(rv):
            rv("door.rv", only=["D1"], strict=True).check([(0, {"closed": False})])

        def test_own_failure(rv):
            rv("door.rv").step(0, {"closed": True})
            assert False, "its own"

        def test_nothing(rv):
            rv("door.rv", only=["D1"], expect={"D1": "P"})
        """,
    )
    told.assert_outcomes(failed=4, passed=2)
    why = ["*had to become false between 0 s and 2 s*", "*then within 2 s*"]
    told.stdout.fnmatch_lines(["*not as expected: D1*", *why, "*not as expected: D2*"])
    told.stdout.no_fnmatch_line("*pytest_plugin.py:*")
    told.stdout.fnmatch_lines(["*not as expected: D1*", "*its own*", "*not as expected: D1*"])
    told.stdout.re_match_lines([r".* requirements .*", r" +P +F +NT +I", r"D1 +1 +2"])


@pytest.mark.process
def test_specifications_are_tests_of_recordings(folder):
    (folder.path / "run.csv").write_text("t,closed,knock\n0,0,1\n3,,\n")
    (folder.path / "other.csv").write_text("t,closed,knock\n0,1,\n3,,\n")
    (folder.path / "unlike").mkdir()
    (folder.path / "unlike/less.csv").write_text("t,closed\n0,0\n3,\n")
    folder.makeini("[pytest]\nrv_recordings =\n  *.csv\n  unlike\n")
    told = folder.runpytest_subprocess("-n", "1", "--junitxml=out.xml", "-p", "no:cacheprovider")
    told.assert_outcomes(failed=2, passed=4)
    told.stdout.fnmatch_lines(["*other.csv::D2*", "*`closed` was true at 0 s*"])
    told.stdout.fnmatch_lines(["*less.csv::D1*", "*there is no column for*", "*`knock`*"])
    told.stdout.re_match_lines([r"D1 +1 +1", r"D2 +2 +1"])
    assert '<property name="rv:D1" value="NT"' in (folder.path / "out.xml").read_text()


@pytest.mark.process
def test_wrong_specifications_recordings_and_verdicts_are_reported(folder):
    folder.makefile(".csv", run="t,closed\n0,maybe\n")
    folder.makeini("[pytest]\nrv_recordings = *.csv\n")
    (folder.path / "bad.rv").write_text("requirement")
    told = _run(
        folder,
        """
        def test_recording(rv):
            rv("door.rv").check("none.csv")

        def test_specification(rv):
            rv("bad.rv")

        def test_sample(rv):
            rv("door.rv").step(0, {"close": True})

        def test_verdict(rv):
            rv("door.rv", expect={"D1": "pass"})
        """,
        "--continue-on-collection-errors",
    )
    told.assert_outcomes(failed=6, errors=1)
    told.stdout.no_fnmatch_line("*src/rvmon*")
    assert "Traceback" not in told.stdout.str()
    told.stdout.fnmatch_lines(["*maybe*"])
    causes = ["*ERROR collecting bad.rv*", "*RV001*", "*none.csv: No such file*", "*RV001*"]
    told.stdout.fnmatch_lines([*causes, "*`close`*", "*'pass'*"])


@pytest.mark.process
def test_without_settings_specifications_are_no_tests_and_nothing_is_imported(folder):
    folder.makepyfile(
        "def test_light():\n    import sys\n    assert 'rvmon.session' not in sys.modules"
    )
    folder.runpytest_subprocess("-p", "no:cacheprovider").assert_outcomes(passed=1)
