"""The module that steps a compiled monitor: strict compilers, sanitizers, the cache."""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from tests.tools.gcc import SANITIZED, STRICT

import rvmon
from rvmon.codegen.c_online import online_source
from rvmon.codegen.c_source import c_files
from rvmon.errors import RvmonError

pytestmark = pytest.mark.compiler


SPEC = """
spec {name} "All that is laid out"
signal p, q : bool
signal x : real   stale after 2 s
signal n : int
signal mode : {{red, green}}
event e(k: int, where: {{left, right}})
event f
requirement R1 "a"
  upon e.k > 2 and e.where == left and once[1 s, 3 s] p
  then within 3 s held(q or x > 1, 1 s)
requirement R2 "b"
  always (f -> (p since[0 s, 5 s] (mode == green)) or n > 3)
"""

BARE = "spec bare\nevent f\nrequirement R1\n  upon f\n  then within 1 s f\n"

WAITING = """
spec waiting
signal p, q : bool
requirement R1
  upon p
  then within 1 h q
requirement R2
  upon p
  then within 2 h q
"""

RUN = """
import gc
import random
import sys
import rvmon
from pathlib import Path
spec = rvmon.loads(Path("spec.rv").read_text())
rng = random.Random(1)
odd = [None, float("nan"), 7, 1 << 61, "red", "none", {"k": 3, "where": "left"}, {"k": None}, {},
       {"z": 1}, (), ({"k": 1},), [], True, False, 0.5, object(), b"red"]
names = ["p", "q", "x", "n", "mode", "e", "f", "z", 3]
monitor = spec.monitor(engine="c")
kept, refused = [], 0
for run in range(3):
    t = 0
    for row in range(3000):
        t += rng.choice([1, 10**8, 10**9, -1])
        count = rng.randint(0, 12)
        values = {rng.choice(names): rng.choice(odd) for _ in range(count)}
        try:
            kept += monitor.step_ns(t, values)
        except rvmon.RvmonError:
            refused += 1
        if row % 100 == 0:
            kept += monitor.open
            kept += monitor.advance_ns(max(t, 0))
    report = monitor.finish()
    kept += report.attempts
    monitor.reset()
assert refused > 1000 and len(kept) > 100
print(len(kept))

waiting = rvmon.loads(Path("waiting.rv").read_text()).monitor(engine="c")
meanwhile = []

def collector_steps(phase, _):
    # A step in the midst of a step of the same monitor, so that its records move.
    if not meanwhile:
        meanwhile.append(t)
        for n in range(5000):
            waiting.step_ns(t + 2 + n, {"p": n % 2 == 0, "q": n % 2 == 1})

t = 0
for _ in range(3000):
    t += 1
    waiting.step_ns(t, {"p": t % 2 == 1, "q": False})
gc.collect()
gc.callbacks.append(collector_steps)
gc.set_threshold(500)  # the step alone makes 3,000 attempts
told = [(a.requirement, a.number, a.decided) for a in waiting.step_ns(t + 1, {"q": True})]
assert meanwhile or sys.version_info >= (3, 12)  # which collect after the call
assert told == [(r, n, t + 1) for r in ("R1", "R2") for n in range(1, 1501)]
"""


@pytest.fixture(autouse=True)
def compilers(extensions):
    """Extension modules can be compiled here."""


def written(spec: rvmon.Spec, folder: Path) -> Path:
    """The sources of a specification's module in a folder; the one to compile."""
    plan = spec.plan()
    made = c_files(plan)
    for name, text in made.texts.items():
        (folder / name).write_text(text)
    source = folder / f"{made.prefix}_online.c"
    source.write_text(online_source(plan))
    return source


@pytest.mark.parametrize("text", [SPEC.format(name="everything"), BARE], ids=["all", "bare"])
@pytest.mark.parametrize("nodes", [32, 3])
def test_it_compiles_strictly(text, nodes, tmp_path, monkeypatch):
    """No warning of gcc, whatever there is or is not to lay out."""
    monkeypatch.setattr("rvmon.codegen.c_nodes.GROUP", nodes)
    source = written(rvmon.loads(text), tmp_path)
    include = ["-isystem", sysconfig.get_path("include")]
    command = ["gcc", *STRICT, "-O1", *include, "-c", source.name]
    subprocess.run(command, cwd=tmp_path, check=True)  # noqa: S603


def test_it_runs_clean(tmp_path):
    """No finding of the sanitizers on samples of all kinds, most of them wrong."""
    (tmp_path / "spec.rv").write_text(SPEC.format(name="odd"))
    (tmp_path / "waiting.rv").write_text(WAITING)
    (tmp_path / "run.py").write_text(RUN)
    flags = " ".join(SANITIZED)
    command = ["gcc", "-print-file-name=libasan.so"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603
    environment = {
        **os.environ,
        "CC": f"{os.environ['CC']} {flags}",
        "LD_PRELOAD": shown.stdout.strip(),
        "ASAN_OPTIONS": "detect_leaks=0",  # Python frees not all at its end
        "PYTHONMALLOC": "malloc",
    }
    done = subprocess.run(
        [sys.executable, "run.py"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]


@pytest.mark.parametrize("name", ["core", "py", "python", "finite", "module", "pyconfig", "double"])
def test_any_name_of_a_specification(name):
    """A specification may be called as something of Python's headers, or of ours."""
    spec = rvmon.loads(f"spec `{name}`\nsignal p : bool\nrequirement R1\n  always p\n")
    monitor = spec.monitor(engine="c")
    (attempt,) = (*monitor.step(0.0, {"p": True}), *monitor.step(1.0, {"p": False}))
    assert (attempt.decided, attempt.verdict) == (10**9, "F")


def test_compiled_once(tmp_path, monkeypatch):
    """Another monitor, another load of the same text, another process: one file in the cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for _ in range(2):
        spec = rvmon.loads(BARE)
        spec.monitor(engine="c").step(0.0, {"f": True})
        spec.monitor(engine="c").step(0.0, {"f": True})
    assert len(list((tmp_path / "rvmon").glob("*.so"))) == 1


def test_a_file_that_was_cut_off_is_made_anew(tmp_path, monkeypatch):
    """A module that cannot be loaded is compiled once more."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "first"))
    rvmon.loads(BARE).monitor(engine="c")
    (whole,) = (tmp_path / "first" / "rvmon").glob("*.so")
    broken = tmp_path / "second" / "rvmon" / whole.name
    broken.parent.mkdir(parents=True, mode=0o700)
    broken.write_bytes(whole.read_bytes()[:50])
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "second"))
    rvmon.loads(BARE).monitor(engine="c")
    assert broken.stat().st_size == whole.stat().st_size


def test_modules_that_share_names():
    """Each monitor runs its own code even where a program lets all modules see each other's."""
    before = sys.getdlopenflags()
    try:
        sys.setdlopenflags(before | os.RTLD_GLOBAL)
        rvmon.loads("spec one\nsignal p : bool\nrequirement R1\n  always p\n").monitor(engine="c")
        monitor = rvmon.loads(WAITING).monitor(engine="c")
    finally:
        sys.setdlopenflags(before)
    monitor.step(0.0, {"p": True})
    decided = monitor.step(1.0, {"q": True})
    assert [(a.requirement, a.verdict) for a in decided] == [("R1", "P"), ("R2", "P")]


def test_no_compiler(monkeypatch):
    """Without a compiler it says so."""
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(RvmonError, match="no C compiler found"):
        rvmon.loads(BARE).monitor(engine="c")
