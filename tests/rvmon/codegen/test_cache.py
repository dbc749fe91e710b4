"""The cache of compiled C, and the compiler that fills it."""

import os
import sys
import tempfile
from pathlib import Path

import pytest

import rvmon
from rvmon.execute.command import run

pytestmark = pytest.mark.compiler

SPEC = "spec s\nsignal p : bool\nrequirement R1\n  always p\n"
TRACE = {"t": [0.0, 1.0], "p": [True, False]}


def verdicts() -> dict[str, str]:
    """What a specification that was loaded just now says by compiled C."""
    return dict(rvmon.loads(SPEC).evaluate(TRACE, engine="c").verdicts)


@pytest.mark.parametrize("harm", ["cut off", "bits flipped", "of others", "a folder"])
def test_what_is_damaged_or_foreign_is_made_anew(harm, tmp_path, monkeypatch):
    """A library is looked at before it is loaded: a damaged one would end the process."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    told = f"rvmon.loads({SPEC!r}).evaluate({TRACE}, engine='c').verdicts['R1'].value"
    assert verdicts() == {"R1": "F"}
    (path,) = (tmp_path / "rvmon").glob("*.so")
    whole = path.read_bytes()
    path.unlink()  # this process has loaded it: what it reads of the file must stay
    if harm == "a folder":
        path.mkdir()
        (path / "within").touch()
    else:
        harmed = {
            "cut off": whole[: len(whole) // 2],
            "bits flipped": bytes(byte ^ 0x55 for byte in whole),
            "of others": whole,
        }
        path.write_bytes(harmed[harm])
        path.chmod(0o777 if harm == "of others" else 0o700)
    done = run([sys.executable, "-c", f"import rvmon; print({told})"])
    assert (done.returncode, done.stdout) == (0, "F\n"), done.stderr
    made = [one for one in (tmp_path / "rvmon").glob("*.so") if one.is_file()]
    assert [one.read_bytes() for one in made] == [whole]
    assert made[0].stat().st_mode & 0o777 == 0o700


def test_what_cannot_be_loaded_is_told(tmp_path, monkeypatch):
    """If what was made anew cannot be loaded either, that is said, with what to do."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", str(tmp_path / "cc"))
    (tmp_path / "cc").write_text(
        '#!/bin/sh\nwhile [ "$1" != -o ]; do shift; done\necho nothing > "$2"\n'
    )
    (tmp_path / "cc").chmod(0o700)
    with pytest.raises(rvmon.RvmonError, match=r"cannot load a compiled monitor: .*XDG_CACHE_HOME"):
        verdicts()


def test_a_folder_that_takes_no_files_is_told(tmp_path, monkeypatch):
    """Where nothing can be written, the folder and the cause are named."""

    def refused(**_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    if os.geteuid():
        (tmp_path / "rvmon").mkdir(mode=0o500)
    else:  # who may write everywhere
        monkeypatch.setattr(tempfile, "TemporaryDirectory", refused)
    with pytest.raises(rvmon.RvmonError, match=r"monitors in .*rvmon: Permission denied: name"):
        verdicts()


def test_a_relative_cache_is_passed_over(tmp_path, monkeypatch):
    """A cache that is named by a relative path is none: that of the home folder is taken."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert verdicts() == {"R1": "F"}
    assert not Path("here").exists()
    assert len(list(Path("home/.cache/rvmon").glob("*.so"))) == 1


def test_a_compiler_with_options(tmp_path, monkeypatch):
    """`CC` is a command: what stands behind the name are its options."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", "cc -O1 -DUNUSED='a b'")
    assert verdicts() == {"R1": "F"}


@pytest.mark.parametrize("named", ["no-such-compiler -O1", "cc 'open"])
def test_a_compiler_that_there_is_not(named, tmp_path, monkeypatch):
    """What `CC` names is said, if it is no compiler."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", named)
    with pytest.raises(rvmon.RvmonError, match=f"no C compiler found .{named}"):
        verdicts()
