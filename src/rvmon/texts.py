"""Text from outside: reading it within bounds, showing it safely, and suggesting misspelt names.

Only regular files of a bounded size are read. Shown text cannot control a terminal, and it hides
no characters.
"""

from __future__ import annotations

import errno
import os
import re
import stat
import sys
import unicodedata
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterable, Sequence
from contextlib import suppress
from itertools import islice, takewhile
from pathlib import Path
from typing import NamedTuple

MOST_NAMES = 1_000
"""The most names that a misspelt name is compared with."""


def nearest(name: str, known: Iterable[str], likeness: float = 2 / 3) -> str:
    """The most similar known name; empty if none is similar enough.

    Whole parts that both names share at the start or end, such as folders or a file extension, do
    not count as similarity.

    Args:
        name: as written.
        known: the existing names; the first thousand are compared.
        likeness: least similarity, from 0 to 1 (`difflib.SequenceMatcher.ratio`).

    >>> nearest("gaze_okay", ["gaze_ok", "pressure_ok"]), nearest("nope.csv", ["base.csv"])
    ('gaze_ok', '')
    """
    import difflib  # imported late: most runs contain no misspelt name

    candidates = difflib.get_close_matches(name, list(islice(known, MOST_NAMES)), 3, likeness)
    for candidate in candidates:
        parts = _where_they_differ(name, candidate)
        if difflib.SequenceMatcher(None, *parts).ratio() >= likeness:
            return candidate
    return ""


def _where_they_differ(name: str, other: str) -> tuple[str, str]:
    """Both names without the whole parts that they share at the start and the end.

    >>> _where_they_differ("monday/nope.csv", "monday/base.csv")
    ('nope', 'base')
    """
    start = _shared_parts(name, other)
    name, other = name[start:], other[start:]
    stop = _shared_parts(name[::-1], other[::-1])
    return name[: len(name) - stop], other[: len(other) - stop]


def _shared_parts(name: str, other: str) -> int:
    """The length of the common prefix up to and including its last separator."""
    pairs = zip(name, other, strict=False)
    shared = len(list(takewhile(lambda pair: pair[0] == pair[1], pairs)))
    return max(name.rfind(separator, 0, shared) for separator in "-./") + 1


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A question that suggests the most similar known name; `otherwise` if none is similar.

    >>> did_you_mean("relased", ["released"])
    'did you mean `released`?'
    """
    close = nearest(name, known)
    return f"did you mean `{close}`?" if close else otherwise


def cannot_read(path: str | Path, error: OSError | UnicodeDecodeError) -> str:
    """Why a file cannot be read; if it does not exist, with a similar name from its folder.

    >>> cannot_read("nowhere/base.csv", FileNotFoundError(2, "No such file or directory"))
    'nowhere/base.csv: No such file or directory'
    """
    if isinstance(error, UnicodeDecodeError):
        is_wide = error.object[:2] in (BOM_UTF16_LE, BOM_UTF16_BE)
        return (
            f"{path}: not UTF-8 text ({error.reason} at byte {error.start}): is this a binary file?"
            " A text in another encoding has to be converted: "
            f"`iconv -f {'utf-16' if is_wide else 'latin1'} -t utf-8`"
        )
    why = f"{path}: {error.strerror or error}"
    if isinstance(error, FileNotFoundError):
        with suppress(OSError), os.scandir(Path(path).parent) as entries:
            others = (entry.name for entry in entries if entry.name != Path(path).name)
            if close := nearest(Path(path).name, others):
                return f"{why}: did you mean `{Path(path).with_name(close)}`?"
    return why


_PROPOSED = re.compile(r"did you mean `([^`]+)`\?|write `([^`\d{]+)`\Z")


def proposed(help_: str) -> str:
    """The replacement that a `help` text proposes; empty if it proposes no single word.

    >>> proposed("did you mean `released`?  (event, line 9)"), proposed("put brackets around it")
    ('released', '')
    """
    close = _PROPOSED.match(help_)
    return close[1] or close[2] if close else ""


_STEERS_JSON = re.compile(
    "[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"  # what JSON itself leaves as it is
)


def escaped(text: str) -> str:
    r"""The text with control and formatting characters written as escapes.

    Names, cells, labels, texts and file names may contain terminal escapes or marks that reverse
    the direction of writing, so all output for people passes through this function. Line ends and
    all kinds of spaces stay.

    >>> print(escaped("\x1b[31mred\x9b0m \u202eor not"))
    \x1b[31mred\x9b0m \u202eor not
    """
    if text.replace("\n", "").isprintable():
        return text
    return "".join(map(_escaped, text))


def escaped_line(text: str) -> str:
    r"""The result of `escaped` on one line: line ends are written as escapes, too.

    >>> print(escaped_line("one\ntwo"))
    one\ntwo
    """
    return escaped(text).replace("\n", r"\n")


def escaped_json(text: str) -> str:
    r"""Equivalent JSON text, in which characters that would control a terminal are JSON escapes.

    >>> print(escaped_json('"\x9b0m"'))
    "\u009b0m"
    """
    if (text.isascii() and "\x7f" not in text) or text.isprintable():
        return text
    return _STEERS_JSON.sub(lambda char: f"\\u{ord(char[0]):04x}", text)


def _escaped(char: str) -> str:
    if char == "\n" or char.isprintable() or unicodedata.category(char) == "Zs":
        return char
    return ascii(char)[1:-1]


def quoted(text: str) -> str:
    r"""A string literal of DOT or HOA.

    >>> print(quoted('say "\\x1b"'))
    "say \"\\x1b\""
    """
    plain = escaped(text).replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{plain}"'


def shown_path(path: str | os.PathLike[str]) -> str:
    """A path as text; bytes of a file name that are not UTF-8 are replaced.

    >>> shown_path("monday.csv")
    'monday.csv'
    """
    return os.fsencode(path).decode("utf-8", "replace")


MEGABYTE = 1 << 20

MOST = 10
"""The most megabytes of a text, unless `RVMON_MAX_TEXT` is set."""


def text_of_file(path: str | Path, encoding: str = "utf-8") -> str:
    """Read a specification or a model.

    Args:
        path: of a regular file.
        encoding: of its text.

    Raises:
        OSError: the file cannot be read, is a device or a pipe, or is too large; `strerror` says
            which.
        UnicodeDecodeError: the file is not text in this encoding.
    """
    with open(path, "rb", opener=_open_at_once) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "a device or a pipe: a regular file is expected")
        data = file.read(_most() + 1)
    _refuse_large(len(data))
    return data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def text_of_input() -> str:
    """Read a specification from standard input; see `text_of_file`."""
    text = sys.stdin.read(_most() + 1)
    _refuse_large(len(text))
    return text


def _open_at_once(path: str, flags: int) -> int:
    """Open a file; if it is a named pipe, do not wait for a writer."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _most() -> int:
    given = os.environ.get("RVMON_MAX_TEXT", "")
    return (int(given) if given.isascii() and given.isdigit() else MOST) * MEGABYTE


def _refuse_large(size: int) -> None:
    most = _most()
    if size > most:
        reason = f"larger than {most // MEGABYTE} MB: if that is meant, set RVMON_MAX_TEXT (in MB)"
        raise OSError(errno.EFBIG, reason)


SMALLEST = 0.1


def percent(part: int, whole: int) -> float:
    """A share in percent with one decimal; 0.0 and 100.0 only if it is exactly none or all.

    Args:
        part: from 0 to `whole`.
        whole: the total; if it is 0, the result is 100.0.

    >>> percent(1, 3), percent(1, 5000), percent(4999, 5000), percent(7, 7)
    (33.3, 0.1, 99.9, 100.0)
    """
    if part == whole:
        return 100.0
    if part == 0:
        return 0.0
    return min(max(round(100 * part / whole, 1), SMALLEST), 100 - SMALLEST)


def percent_text(part: float, whole: float) -> str:
    """A share in whole percent for people; `0 %` and `100 %` only if it is exactly none or all.

    >>> percent_text(2, 3), percent_text(1, 5000), percent_text(4999, 5000)
    ('67 %', '< 1 %', '> 99 %')
    """
    if part in (0, whole):
        return "0 %" if part == 0 and whole else "100 %"
    rounded = round(100 * part / whole)
    if rounded == 0:
        return "< 1 %"
    return "> 99 %" if rounded == 100 else f"{rounded} %"


def counted(count: int, noun: str, plural: str = "") -> str:
    """A count with its noun in the singular or plural.

    >>> counted(1, "test"), counted(2000, "test"), counted(2, "class", "classes")
    ('1 test', '2,000 tests', '2 classes')
    """
    return f"{count:,} {noun if count == 1 else plural or noun + 's'}"


def listed(names: Sequence[str], word: str) -> str:
    """At least one name, listed as in a sentence with `word` before the last.

    >>> listed(["a", "b", "c"], "and"), listed(["a"], "or")
    ('a, b and c', 'a')
    """
    *rest, last = names
    return f"{', '.join(rest)} {word} {last}" if rest else last


def share_text(share: float) -> str:
    """`percent_text` of a share from 0 to 1.

    >>> share_text(0.99999), share_text(0.5)
    ('> 99 %', '50 %')
    """
    return percent_text(share, 1)


_MARKS = (".git", "pyproject.toml")
"""The files that mark the root of a project."""


class ImportTree(NamedTuple):
    """The folders from which a specification may import.

    Attributes:
        root: of the project.
        others: further folders that the user allows with `RVMON_ALLOW_IMPORTS`.
    """

    root: Path
    others: tuple[Path, ...] = ()

    def holds(self, file: Path) -> bool:
        """Whether a file lies in one of the folders once symbolic links are resolved.

        Raises:
            ValueError: the name contains a null character.
            OSError: symbolic links form a loop.
        """
        real = file.resolve()
        return any(real.is_relative_to(folder) for folder in (self.root, *self.others))


def tree_of(directory: Path) -> ImportTree:
    """The import tree of a main file in this folder, with its project, else the folder, as root."""
    root = directory.resolve()
    marked = (
        folder
        for folder in (root, *root.parents)
        if any((folder / mark).exists() for mark in _MARKS)
    )
    named = os.environ.get("RVMON_ALLOW_IMPORTS", "").split(os.pathsep)
    return ImportTree(next(marked, root), tuple(Path(name).resolve() for name in named if name))


def shorten(text: str, width: int = 40) -> str:
    """The result of `escaped_line`, cut to `width` characters.

    >>> shorten("a" * 50, 5)
    'aaaa…'
    """
    line = escaped_line(text[: width + 1])
    return line if len(line) <= width else line[: width - 1] + "…"
