"""The native core is built with the package; a build that was forgotten is noticed."""

import importlib
import importlib.machinery
import importlib.util
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from types import ModuleType

import pytest
from tests.rvmon.native.python_abi import HEADER, comparison, declared

import rvmon.native
import rvmon.native.sources
from rvmon.errors import CoreError

ROOT = Path(__file__).parents[3]


@pytest.fixture
def hook():
    """The build hook, loaded by its path as pip does, without optimisation to save time."""
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.FLAGS = tuple(flag for flag in module.FLAGS if flag != "-O2")
    return module


@pytest.fixture
def copied(hook, monkeypatch, tmp_path):
    """A folder to build from with the binding only: it links quickly."""
    folder = tmp_path / "native"
    whole = Path(rvmon.native.sources.FOLDER)
    for source in (*whole.rglob("*.h"), *whole.glob("python/*.c")):
        target = folder / source.relative_to(whole)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)
    monkeypatch.setattr(hook, "CORE", folder)
    return folder


def loaded(path: Path) -> ModuleType:
    """The extension at a path, in addition to the one in use."""
    loader = importlib.machinery.ExtensionFileLoader("_core", str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("_core", loader))
    loader.exec_module(module)
    return module


def test_the_core_was_built_from_its_sources():
    """The imported extension contains the hash of the sources beside it."""
    assert rvmon.native._core.source_hash == rvmon.native.sources.source_hash() != ""


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "b.h").write_bytes(b"int two; "),
        lambda folder: (folder / "c.c").write_bytes(b""),
        lambda folder: (folder / "a.c").unlink(),
        lambda folder: (folder / "a.c").rename(folder / "a2.c"),
        lambda folder: (
            (folder / "a.c").write_bytes(b"int one;int two;"),
            (folder / "b.h").write_bytes(b""),
        ),
    ],
    ids=["changed", "added", "removed", "renamed", "moved"],
)
def test_hash_sees_each_change(change, tmp_path):
    (tmp_path / "a.c").write_bytes(b"int one;")
    (tmp_path / "b.h").write_bytes(b"int two;")
    before = rvmon.native.sources.source_hash(str(tmp_path))
    change(tmp_path)
    assert rvmon.native.sources.source_hash(str(tmp_path)) != before


def test_hash_is_of_sources_alone(tmp_path):
    assert rvmon.native.sources.source_hash(str(tmp_path)) == ""
    source = tmp_path / "a.c"
    source.write_bytes(b"int one;")
    before = rvmon.native.sources.source_hash(str(tmp_path))
    (tmp_path / "plan.md").write_bytes(b"What the sections mean.")
    source.touch()
    assert rvmon.native.sources.source_hash(str(tmp_path)) == before


@pytest.fixture
def reloading():
    """Import the package of the extension anew, and restore it after the test."""
    yield lambda: importlib.reload(rvmon.native)
    importlib.reload(rvmon.native)


def test_stale_core_is_refused(monkeypatch, reloading):
    with monkeypatch.context() as patched:
        patched.setattr(rvmon.native.sources, "source_hash", lambda _: "0123abcd")
        with pytest.raises(
            CoreError, match=r"older than its sources .*pip install -e \."
        ) as caught:
            reloading()
    assert isinstance(caught.value, ImportError)


def test_missing_core_is_told(monkeypatch, reloading):
    with monkeypatch.context() as patched:
        patched.setitem(sys.modules, "rvmon.native._core", None)
        with pytest.raises(CoreError, match=r"is not built .*pip install -e \."):
            reloading()


def test_no_sources_no_check(monkeypatch, reloading):
    with monkeypatch.context() as patched:
        patched.setattr(rvmon.native.sources, "source_hash", lambda _: "")
        assert reloading()._core is rvmon.native._core


def test_named_compiler_is_taken(hook, monkeypatch):
    """`$CC` is the compiler with its options; no other is searched for or installed."""
    monkeypatch.setenv("CC", "mycc --option 'a b'")
    assert hook.compiler() == ["mycc", "--option", "a b"]
    assert hook.CoreBuildHook.dependencies(None) == []


def test_without_compiler_one_is_required(hook, monkeypatch, tmp_path):
    """If nothing compiles, not even `cc`, the build requires a package with a compiler."""
    broken = tmp_path / "cc"
    broken.write_text("#!/bin/sh\nexit 1\n", encoding="ascii")
    broken.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    assert hook.compiler() == []
    assert hook.CoreBuildHook.dependencies(None) == [hook.ZIG]


def test_tags(hook, monkeypatch):
    """One wheel is for all versions from 3.11; that of a free-threaded Python for it only."""
    assert hook.wheel_tag().startswith("cp311-abi3-")
    assert hook.file_name() in {"_core.abi3.so", "_core.pyd"}
    monkeypatch.setattr(hook, "free_threaded", lambda: True)
    own = f"cp3{sys.version_info.minor}"
    assert hook.wheel_tag().startswith(f"{own}-{own}t-")
    assert hook.file_name() == f"_core{importlib.machinery.EXTENSION_SUFFIXES[0]}"


@pytest.mark.slow
def test_free_threaded_needs_headers(hook, monkeypatch, tmp_path):
    """A Python without GIL has another layout of objects, which is not declared here."""
    monkeypatch.setattr(hook, "free_threaded", lambda: True)
    monkeypatch.setattr(hook.sysconfig, "get_path", lambda _name: str(tmp_path))
    with pytest.raises(SystemExit, match=r"Python\.h"):
        hook.build(tmp_path)


@pytest.mark.compiler
def test_builds_are_equal(copied, hook, tmp_path):
    """Two builds from one source, in two folders, are the same bytes."""
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    one, two = hook.build(tmp_path / "one"), hook.build(tmp_path / "two")
    assert one.read_bytes() == two.read_bytes()
    assert [path.name for path in (tmp_path / "one").iterdir()] == [hook.file_name()]


@pytest.mark.compiler
def test_builds_without_headers(hook, monkeypatch, tmp_path):
    monkeypatch.setattr(hook.sysconfig, "get_path", lambda _name: str(tmp_path))
    built = loaded(hook.build(tmp_path))
    assert built.source_hash == rvmon.native.sources.source_hash()
    assert set(dir(built)) == set(dir(rvmon.native._core))


@pytest.mark.compiler
def test_changed_source_is_built_anew(copied, hook, tmp_path):
    before = rvmon.native.sources.source_hash(str(copied))
    assert before.encode() in hook.build(tmp_path).read_bytes()
    with (copied / "python" / "module.c").open("ab") as file:
        file.write(b"/* more */\n")
    after = rvmon.native.sources.source_hash(str(copied))
    built = hook.build(tmp_path).read_bytes()
    assert after.encode() in built
    assert before.encode() not in built


@pytest.mark.compiler
def test_errors_of_the_compiler_are_shown(copied, hook):
    """A source that does not compile ends the build with the compiler's output; no file is lost."""
    (copied / hook.file_name()).write_bytes(b"as it was")
    (copied / "wrong.c").write_bytes(b"int wrong = ;\n")
    with pytest.raises(SystemExit, match=r"wrong\.c:1"):
        hook.build(copied)
    assert (copied / hook.file_name()).read_bytes() == b"as it was"
    assert not list(copied.glob(".build-*"))


def compared(header: str, folder: Path) -> str:
    """The compiler's output for our declarations beside Python's own; empty if they agree."""
    (folder / "python_abi.h").write_text(header, encoding="utf-8")
    (folder / "comparison.c").write_text(comparison(header), encoding="utf-8")
    include = sysconfig.get_path("include")
    if not Path(include, "Python.h").is_file():
        pytest.skip("needs the headers of Python")
    line = ["gcc", "-std=gnu11", "-fsyntax-only", "-DPy_LIMITED_API=0x030B0000"]
    line += ["-isystem", include, "comparison.c"]
    return subprocess.run(  # noqa: S603
        line, cwd=folder, capture_output=True, text=True, check=False
    ).stderr


@pytest.mark.compiler
def test_own_declarations_are_pythons(tmp_path):
    assert compared(HEADER.read_text(encoding="utf-8"), tmp_path) == ""


WRONG = [
    (
        "double PyFloat_AsDouble(PyObject *)",
        "long PyFloat_AsDouble(PyObject *)",
        "'PyFloat_AsDouble'",
    ),
    ("PyObject *PyList_New(Py_ssize_t)", "PyObject *PyList_New(int)", "'PyList_New'"),
    ("PyObject *PyDict_New(void)", "PyObject *PyDict_Newer(void)", "'PyDict_Newer' undeclared"),
    ("extern PyTypeObject PyDict_Type", "extern PyObject PyDict_Type", "'PyDict_Type'"),
    ("typedef int (*inquiry)(PyObject *)", "typedef int (*inquiry)(void *)", "'inquiry'"),
    ("#define METH_FASTCALL 0x0080", "#define METH_FASTCALL 0x0100", '"METH_FASTCALL"'),
    (
        "    int readonly;\n    int ndim;",
        "    int ndim;\n    int readonly;",
        '"Py_buffer.readonly"',
    ),
    ("    unsigned int flags;", "    int flags;", '"PyType_Spec.flags"'),
    ("    freefunc m_free;\n", "", '"PyModuleDef"'),
]
"""Mistakes in our declarations: what stands there, what would be wrong, what the compiler names."""


@pytest.mark.compiler
def test_comparison_finds(monkeypatch, tmp_path):
    monkeypatch.setenv("LC_ALL", "C")
    header = HEADER.read_text(encoding="utf-8")
    for old, new, _named in WRONG:
        assert old in header
        header = header.replace(old, new)
    found = compared(header, tmp_path)
    assert [named for _old, _new, named in WRONG if named not in found] == []


def test_python_has_what_is_declared():
    import ctypes

    names = declared(HEADER.read_text(encoding="utf-8"))
    assert len(names) > 50
    assert not [name for name in names if not hasattr(ctypes.pythonapi, name)]
