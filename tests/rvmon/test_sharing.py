"""Threads and processes share a specification; a monitor cannot be pickled or copied."""

import copy
import multiprocessing
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest

import rvmon

pytestmark = pytest.mark.process

_SPEC = """spec s
signal x : real
event e
event p
requirement R1
  always x <= 3
requirement R2
  upon e
  then within 1 s p
requirement R3
  whenever x > 2
  then within 2 s x < 1
"""
_ROWS = [
    (number, {"x": number % 5, "e": number % 4 == 0, "p": number % 3 == 0}) for number in range(60)
]
_TRACE = "t,x,e,p\n" + "".join(
    f"{t},{row['x']},{int(row['e'])},{int(row['p'])}\n" for t, row in _ROWS
)


@pytest.fixture
def trace(tmp_path: Path) -> Path:
    path = tmp_path / "trace.csv"
    path.write_text(_TRACE)
    return path


def _stepped(spec: rvmon.Spec) -> str:
    monitor = spec.monitor()
    for t, row in _ROWS:
        monitor.step(t, row)
    return monitor.finish(70).to_json()


def _evaluated(spec: rvmon.Spec, path: Path) -> str:
    return spec.evaluate(path).to_json()


@pytest.mark.usefixtures("quick_turns")
@pytest.mark.parametrize("way", ["stepped", "evaluated"])
def test_eight_threads_share_a_new_specification(trace: Path, way: str) -> None:
    """Values computed on first use are the same whichever thread is first."""
    barrier = Barrier(8)

    def judge(spec: rvmon.Spec) -> str:
        return _stepped(spec) if way == "stepped" else _evaluated(spec, trace)

    def work(spec: rvmon.Spec) -> str:
        barrier.wait()
        return judge(spec)

    with ThreadPoolExecutor(8) as threads:
        for number in range(3):
            text = _SPEC.replace("spec s", f"spec s{number}")
            found = set(threads.map(work, [rvmon.loads(text)] * 8))
            assert found == {judge(rvmon.loads(text))}


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_used_specification_can_be_sent_to_other_processes(method: str, trace: Path) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"there is no {method} here")
    spec = rvmon.loads(_SPEC)
    here = _stepped(spec), _evaluated(spec, trace)
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(1, mp_context=context) as processes:
        stepped = processes.submit(_stepped, spec).result(60)
        evaluated = processes.submit(_evaluated, spec, trace).result(60)
    assert (stepped, evaluated) == here


@pytest.mark.parametrize("act", [pickle.dumps, copy.copy, copy.deepcopy])
def test_a_monitor_is_neither_pickled_nor_copied(act: Callable[[object], object]) -> None:
    monitor = rvmon.loads(_SPEC).monitor()
    with pytest.raises(rvmon.RvmonError, match=r"monitor\.snapshot\(\).*spec\.restore"):
        act(monitor)
