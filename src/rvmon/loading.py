"""Specifications from files and texts."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from rvmon.diagnostics.nearest import cannot_read
from rvmon.diagnostics.text_file import text_of_file
from rvmon.errors import SpecError
from rvmon.session import Spec


def load(
    path: str | Path, *, name: str | None = None, const: Mapping[str, str] | None = None
) -> Spec:
    """Load a specification file.

    Args:
        path: a `.rv` file, UTF-8.
        name: what messages call it; default its path.
        const: constants to override, by name, as text of the language (`{"T": "2 s"}`).

    Raises:
        SpecError: the file cannot be read or is wrong; carries all diagnostics, rendered.
    """
    path = Path(path)
    if path.suffix != ".rv":
        from rvmon.readers.recording import FORMATS

        if path.suffix.lower() in FORMATS:
            expected = "a recording by its name; a specification (.rv) is expected here"
            raise SpecError((), f"error: {path}: {expected}")
    try:
        text = text_of_file(path)
    except OSError as error:
        raise SpecError((), f"error: {cannot_read(path, error)}") from None
    except UnicodeDecodeError:
        raise SpecError((), f"error: {path}: not UTF-8 text: is this a binary file?") from None
    return _compile(text, str(path) if name is None else name, const, path.parent)


def loads(text: str, *, name: str = "<string>", const: Mapping[str, str] | None = None) -> Spec:
    """Load a specification from its text.

    Args:
        text: the specification.
        name: what messages call it.
        const: constants to override, by name, as text of the language.

    Raises:
        SpecError: the text is wrong; carries all diagnostics, rendered.
    """
    return _compile(text, name, const, None)


def _compile(text: str, name: str, const: Mapping[str, str] | None, directory: Path | None) -> Spec:
    from rvmon.spec.compiled_cache import compile_cached

    checked, warnings = compile_cached(text, name=name, constants=const, directory=directory)
    return Spec(checked, warnings)
