"""Logs compared with what the tools of their formats say."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmarks.formats import TOOLS, Compared, main
from tests.tools import logs

from rvmon.recordings.messages.file import MessageFile
from rvmon.trace.schema import Schema

ROWS = [(1_000_000 + 20_000 * k, 0.25 * k, k % 3) for k in range(40)]

WRITERS: dict[str, tuple[str, str, Callable[[Path, list[logs.Row]], Path]]] = {
    "a.ulg": ("ulog", "pyulog", logs.write_ulog),
    "a.bin": ("dataflash", "pymavlink", logs.write_dataflash),
    "a.tlog": ("tlog", "pymavlink", logs.write_tlog),
    "a.mf4": ("mdf", "asammdf", logs.write_mdf),
    "a.log": ("can", "cantools", logs.write_can),
    "a.mat": ("mat", "scipy", logs.write_mat),
}


@pytest.fixture(autouse=True)
def _tools_on_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that were installed beside this Python."""
    place = str(Path(sys.executable).parent)
    monkeypatch.setenv("PATH", place + os.pathsep + os.environ["PATH"])


@pytest.mark.process
@pytest.mark.parametrize("name", WRITERS)
def test_each_message_is_as_its_tool_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    form, library, write = WRITERS[name]
    pytest.importorskip(library)
    path = write(tmp_path / name, ROWS)
    assert main([str(path), "--only", form]) == 0
    row = capsys.readouterr().out.splitlines()[-1]
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells[:2] + cells[3:6] == [form, name, "40", "40", "0"], cells[-1]


def test_what_differs_is_counted_and_the_first_is_told(tmp_path: Path) -> None:
    """Another value, a record too few and one too many."""
    pytest.importorskip("scipy")
    path = logs.write_mat(tmp_path / "a.mat", ROWS)
    ours = MessageFile(str(path), "mat", Schema({}, {}))
    said = [*TOOLS["mat"](path, path, ours)]
    said[3] = (*said[3][:2], {**said[3][2], "speed": 7.5})
    found = Compared(ours, said)
    assert (found.equal, found.different) == (39, 1)
    assert "speed at 1060000000: 0.75, of the tool 7.5" in found.first
    assert Compared(ours, said[:-1]).different == 2
    assert Compared(ours, [*said, said[-1]]).different == 2
