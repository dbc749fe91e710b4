"""What tests share: programs that CI always has, what is made once, and golden files."""

import fcntl
import gc
import os
import shutil
import sys
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any, NoReturn

import pytest

from rvmon.cli import main
from tests.seconds import Seconds


def pytest_configure(config: pytest.Config) -> None:
    """Have the seconds of each folder added up where the results arrive."""
    gc.disable()  # what is collected stays
    config.pluginmanager.register(_Doctests())
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Seconds())


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """One process more than cores for all tests: one or the other waits for a program."""
    return (os.cpu_count() or 1) + (not config.option.markexpr)


class _Doctests:
    """A plugin, so that it sees `src` too, that looks for doctests only where a prompt stands."""

    @pytest.hookimpl(wrapper=True)
    def pytest_collect_file(
        self, file_path: Path
    ) -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
        """Spare pytest the import of modules without doctests, and the walk through them."""
        collectors = yield
        if not collectors or ">>>" in file_path.read_text(encoding="utf-8"):
            return collectors
        return [collector for collector in collectors if type(collector) is pytest.Module]


def pytest_collection_finish() -> None:
    """Have modules and tests, which stay to the end, never looked through for garbage."""
    gc.freeze()
    gc.set_threshold(20_000)  # tests make many objects, of which few are garbage that refers back
    gc.enable()


_MARK_OF_FIXTURE = {
    "chromium": "browser",
    "cortex_m": "compiler",
    "directed_results": "campaign",
    "gcc": "compiler",
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark tests by the dear things that they ask for."""
    for item in items:
        for name in getattr(item, "fixturenames", ()):
            if name in _MARK_OF_FIXTURE:
                item.add_marker(_MARK_OF_FIXTURE[name])


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Do without tests that compile, where there is no compiler."""
    if item.get_closest_marker("compiler") is not None:
        _program("gcc")


def _program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        _do_without(f"needs the program `{name}`")
    return path


def _do_without(message: str) -> NoReturn:
    if os.environ.get("CI"):
        pytest.fail(message)
    pytest.skip(message)


@pytest.fixture
def chromium() -> str:
    """Path of a headless browser."""
    return _program("chromium")


@pytest.fixture
def says(capsys: pytest.CaptureFixture[str]) -> Callable[..., Any]:
    """Run a command that is to end with a code: what it says then, to both outputs."""

    def run(code: int, *words: object) -> Any:
        capsys.readouterr()
        assert main([*map(str, words)]) == code
        return capsys.readouterr()

    return run


@pytest.fixture
def cortex_m() -> None:
    """C can be compiled for a Cortex-M, and run there."""
    _program("arm-none-eabi-gcc")
    _program("qemu-system-arm")


@pytest.fixture
def gcc() -> str:
    """Path of a C compiler."""
    return _program("gcc")


Make = Callable[[Path], object]


@pytest.fixture(scope="session")
def shared(scratch: Path) -> Callable[[str, Make], Path]:
    """What takes long to make is made once, whichever process of the tests asks for it first.

    Takes the name of a folder, and what fills it; returns the folder.
    """

    def made(name: str, make: Make) -> Path:
        folder = scratch / "shared" / name
        folder.parent.mkdir(exist_ok=True)
        with folder.with_suffix(".lock").open("w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = folder.with_suffix(".done")
            if not done.exists():
                shutil.rmtree(folder, ignore_errors=True)  # of one that failed
                folder.mkdir()
                make(folder)
                done.touch()
        return folder

    return made


@pytest.fixture(scope="session", autouse=True)
def scratch(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache of its own for each run of tests, shared by its processes."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base) / "scratch"
    folder.mkdir(mode=0o700, exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a cache of its own, which is not there yet."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("RVMON_CACHE", raising=False)
    return tmp_path / "rvmon"


@pytest.fixture
def quick_turns() -> Iterator[None]:
    """Threads take turns as often as they can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with the file of that name in `golden/` beside the test.

    RVMON_UPDATE_GOLDEN=1 writes the files instead; read the difference before you commit it.
    """
    folder = request.path.parent / "golden"

    def compare(name: str, text: str) -> None:
        path = folder / name
        if os.environ.get("RVMON_UPDATE_GOLDEN"):
            folder.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        assert text == path.read_text(encoding="utf-8")

    return compare
