"""The cache of compiled specifications returns the same specification, or nothing."""

import random
from pathlib import Path

import pytest

from rvmon.errors import SpecError
from rvmon.language.checked.serialise import from_plain, identity_text, to_plain
from rvmon.language.compile import compile_text
from rvmon.language.compiled_cache import compile_cached
from rvmon.testing.generate.spec import Profile, random_spec

ROOT = Path(__file__).parents[3]
TEXT = (
    "const T = 2 s\nsignal x : real [m]\nevent e, f\n"
    "requirement R\n  upon e then within T x > 1 m\n"
)


def kept_in(own_cache):
    return sorted(own_cache.glob("spec-*.json"))


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(ROOT.glob("specs/*.rv")), ids=lambda path: path.name)
def test_a_stored_specification_is_restored(path):
    compiled = compile_text(path.read_text(), name=str(path), directory=path.parent)
    again = from_plain(to_plain(compiled))
    assert again == compiled
    spans = [one.span for one in again[0].requirements.values() if one.span is not None]
    assert len({id(span.source) for span in spans}) <= len({span.source.name for span in spans})


@pytest.mark.slow
def test_random_specifications_are_restored_and_told_apart():
    """Equal specifications have the same text; spans do not count."""
    known = {}
    for seed in range(150):
        spec = random_spec(random.Random(seed), Profile())
        again = from_plain(to_plain(spec))
        assert again == spec
        assert identity_text(again) == identity_text(spec)
        assert known.setdefault(identity_text(spec), spec) == spec
    moved, _ = compile_text("# a comment\n" + TEXT, name="b.rv")
    assert identity_text(moved) == identity_text(compile_text(TEXT, name="b.rv")[0])


def test_the_second_load_reads_the_cache(own_cache):
    first = compile_cached(TEXT)
    assert first[1]  # `f` is never read
    assert compile_cached(TEXT) == first == compile_text(TEXT)
    [path] = kept_in(own_cache)
    other = compile_cached(TEXT.replace("x > 1 m", "x > 3 m"))
    # The cache was read: the result is what its file contains.
    [second] = {*kept_in(own_cache)} - {path}
    path.write_bytes(second.read_bytes())
    assert compile_cached(TEXT) == other


def test_everything_that_matters_is_part_of_the_key(own_cache):
    compile_cached(TEXT)
    compile_cached(TEXT, name="b.rv")
    five, _ = compile_cached(TEXT, constants={"T": "5 s"})
    assert five == compile_text(TEXT, constants={"T": "5 s"})[0]
    assert len(kept_in(own_cache)) == 3


@pytest.mark.parametrize("damage", [b"", b"x", b"[]", b'["dict",5]', b'["os.system","ls"]'])
def test_a_damaged_file_is_ignored(own_cache, damage):
    import hashlib

    first = compile_cached(TEXT)
    [path] = kept_in(own_cache)
    for content in (damage, hashlib.sha256(damage).hexdigest().encode() + b"\n" + damage):
        path.write_bytes(content)
        assert compile_cached(TEXT) == first


def test_errors_are_not_kept(own_cache):
    for _ in range(2):
        with pytest.raises(SpecError, match="unknown"):
            compile_cached("requirement R\n  always nothing\n")
    assert not kept_in(own_cache)


IMPORTING = 'import "names.rv"\nrequirement R\n  always p\n'


def test_imports_are_checked_each_time(own_cache, tmp_path):
    names = tmp_path / "names.rv"
    names.write_text("signal p : bool\n")
    first = compile_cached(IMPORTING, directory=tmp_path)
    [kept] = kept_in(own_cache)
    names.write_text("signal p : bool\nsignal q : bool\n")
    second = compile_cached(IMPORTING, directory=tmp_path)
    assert [set(spec.signals) for spec, _ in (first, second)] == [{"p"}, {"p", "q"}]
    names.write_text("signal p : bool\n")
    kept.write_bytes(b"")
    assert compile_cached(IMPORTING, directory=tmp_path) == first
    written = kept.read_bytes()
    assert compile_cached(IMPORTING, directory=tmp_path) == first
    assert kept_in(own_cache) == [kept]
    assert kept.read_bytes() == written


def test_each_folder_has_its_own_imports(own_cache, tmp_path):
    for name, more in (("a", ""), ("b", "signal q : bool\n")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "names.rv").write_text(f"signal p : bool\n{more}")
    specs = [compile_cached(IMPORTING, directory=tmp_path / name)[0] for name in "abab"]
    assert [len(spec.signals) for spec in specs] == [1, 2, 1, 2]
    assert len(kept_in(own_cache)) == 2


@pytest.mark.parametrize("harm", ["gone", "outside"])
def test_an_import_that_is_no_longer_allowed_is_refused(own_cache, tmp_path, harm):
    names, elsewhere = tmp_path / "own" / "names.rv", tmp_path / "elsewhere.rv"
    names.parent.mkdir()
    elsewhere.write_text("signal p : bool\n")
    names.write_text("signal p : bool\n")
    compile_cached(IMPORTING, directory=names.parent)
    assert kept_in(own_cache)
    names.unlink()
    if harm == "outside":
        names.symlink_to(elsewhere)
    with pytest.raises(SpecError, match=r"cannot read|outside"):
        compile_cached(IMPORTING, directory=names.parent)
