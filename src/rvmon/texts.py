"""Texts of others: read within bounds, shown safely, and compared with the name that was meant.

Files are regular and of a bounded size; nothing that is shown steers a terminal or hides.
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
"""Names that a misspelt one is compared with."""


def nearest(name: str, known: Iterable[str], likeness: float = 2 / 3) -> str:
    """The known name that is most alike; empty if none is.

    What both share by convention does not make them alike: dashes, folders, an ending.

    Args:
        name: as written.
        known: the existing names; the first thousand are compared.
        likeness: from 0 to 1, how much alike it has to be (`difflib.SequenceMatcher.ratio`).

    >>> nearest("gaze_okay", ["gaze_ok", "pressure_ok"]), nearest("nope.csv", ["base.csv"])
    ('gaze_ok', '')
    """
    import difflib  # most runs misspell nothing

    candidates = difflib.get_close_matches(name, list(islice(known, MOST_NAMES)), 3, likeness)
    for candidate in candidates:
        parts = _where_they_differ(name, candidate)
        if difflib.SequenceMatcher(None, *parts).ratio() >= likeness:
            return candidate
    return ""


def _where_they_differ(name: str, other: str) -> tuple[str, str]:
    """Both without the whole parts that they share in front and behind.

    >>> _where_they_differ("monday/nope.csv", "monday/base.csv")
    ('nope', 'base')
    """
    start = _shared_parts(name, other)
    name, other = name[start:], other[start:]
    stop = _shared_parts(name[::-1], other[::-1])
    return name[: len(name) - stop], other[: len(other) - stop]


def _shared_parts(name: str, other: str) -> int:
    """The characters to the last separator of what both begin with."""
    pairs = zip(name, other, strict=False)
    shared = len(list(takewhile(lambda pair: pair[0] == pair[1], pairs)))
    return max(name.rfind(separator, 0, shared) for separator in "-./") + 1


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A question after the known name that is most alike, else `otherwise`.

    >>> did_you_mean("relased", ["released"])
    'did you mean `released`?'
    """
    close = nearest(name, known)
    return f"did you mean `{close}`?" if close else otherwise


def cannot_read(path: str | Path, error: OSError | UnicodeDecodeError) -> str:
    """Why a file cannot be read, and if there is none, the one in its folder most alike.

    >>> cannot_read("nowhere/base.csv", FileNotFoundError(2, "No such file or directory"))
    'nowhere/base.csv: No such file or directory'
    """
    if isinstance(error, UnicodeDecodeError):
        is_wide = error.object[:2] in (BOM_UTF16_LE, BOM_UTF16_BE)
        return (
            f"{path}: not UTF-8 text ({error.reason} at byte {error.start}): is this a binary file?"
            " A text in another encoding has to be translated: "
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
    """The replacement that a help proposes; empty if the help says more than that.

    >>> proposed("did you mean `released`?  (event, line 9)"), proposed("put brackets around it")
    ('released', '')
    """
    close = _PROPOSED.match(help_)
    return close[1] or close[2] if close else ""


_STEERS_JSON = re.compile(
    "[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"  # what JSON itself leaves as it is
)


def shown(text: str) -> str:
    r"""The text with its control and formatting characters written out.

    Names, cells, labels, texts and files' names may hold escapes of a terminal, and signs that turn
    the direction of writing: everything that leaves for people goes through here. Ends of lines
    stay, and every kind of space.

    >>> print(shown("\x1b[31mred\x9b0m \u202eor not"))
    \x1b[31mred\x9b0m \u202eor not
    """
    if text.replace("\n", "").isprintable():
        return text
    return "".join(map(_shown, text))


def shown_line(text: str) -> str:
    r"""The same on one line: ends of lines, too, are written out.

    >>> print(shown_line("one\ntwo"))
    one\ntwo
    """
    return shown(text).replace("\n", r"\n")


def shown_json(text: str) -> str:
    r"""JSON text that reads back the same, with what would steer a terminal escaped as JSON does.

    >>> print(shown_json('"\x9b0m"'))
    "\u009b0m"
    """
    if (text.isascii() and "\x7f" not in text) or text.isprintable():
        return text
    return _STEERS_JSON.sub(lambda shown: f"\\u{ord(shown[0]):04x}", text)


def _shown(char: str) -> str:
    if char == "\n" or char.isprintable() or unicodedata.category(char) == "Zs":
        return char
    return ascii(char)[1:-1]


def quoted(text: str) -> str:
    r"""A string of DOT or HOA.

    >>> print(quoted('say "\\x1b"'))
    "say \"\\x1b\""
    """
    plain = shown(text).replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{plain}"'


def shown_path(path: str | os.PathLike[str]) -> str:
    """A path as text; names of files need not be.

    >>> shown_path("monday.csv")
    'monday.csv'
    """
    return os.fsencode(path).decode("utf-8", "replace")


MEGABYTE = 1 << 20

MOST = 10
"""Megabytes of a text, unless `RVMON_MAX_TEXT` says otherwise."""


def text_of_file(path: str | Path, encoding: str = "utf-8") -> str:
    """Read a specification or a model.

    Args:
        path: of a regular file.
        encoding: of its characters.

    Raises:
        OSError: it cannot be read, is a device or a pipe, or is too large; `strerror` says which.
        UnicodeDecodeError: it is not text.
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
    """Open without waiting for the other end of a pipe."""
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
    """A share in percent with one decimal; 0 and 100 only where exactly none or all.

    Args:
        part: the number of parts of `whole`.
        whole: at least 1; of nothing, all is covered.

    >>> percent(1, 3), percent(1, 5000), percent(4999, 5000), percent(7, 7)
    (33.3, 0.1, 99.9, 100.0)
    """
    if part == whole:
        return 100.0
    if part == 0:
        return 0.0
    return min(max(round(100 * part / whole, 1), SMALLEST), 100 - SMALLEST)


def percent_text(part: float, whole: float) -> str:
    """The same in whole percent, for people.

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
    """A number of things.

    >>> counted(1, "test"), counted(2000, "test"), counted(2, "class", "classes")
    ('1 test', '2,000 tests', '2 classes')
    """
    return f"{count:,} {noun if count == 1 else plural or noun + 's'}"


def listed(names: Sequence[str], word: str) -> str:
    """Names as a sentence has them; at least one.

    >>> listed(["a", "b", "c"], "and"), listed(["a"], "or")
    ('a, b and c', 'a')
    """
    *rest, last = names
    return f"{', '.join(rest)} {word} {last}" if rest else last


def share_text(share: float) -> str:
    """A share for people, that claims neither none nor all where that is not so.

    >>> share_text(0.99999), share_text(0.5)
    ('> 99 %', '50 %')
    """
    return percent_text(share, 1)


_MARKS = (".git", "pyproject.toml")
"""The files that mark the root of a project."""


class ImportTree(NamedTuple):
    """The folders that imports may lead into.

    Attributes:
        root: of the project.
        others: folders that a person has allowed.
    """

    root: Path
    others: tuple[Path, ...] = ()

    def holds(self, file: Path) -> bool:
        """Whether a file lies within, where links lead.

        Raises:
            ValueError: a null character is in the name.
            OSError: links lead round in a circle.
        """
        real = file.resolve()
        return any(real.is_relative_to(folder) for folder in (self.root, *self.others))


def tree_of(directory: Path) -> ImportTree:
    """The tree of a main file in a folder: that of its project, else the folder itself."""
    root = directory.resolve()
    marked = (
        folder
        for folder in (root, *root.parents)
        if any((folder / mark).exists() for mark in _MARKS)
    )
    named = os.environ.get("RVMON_ALLOW_IMPORTS", "").split(os.pathsep)
    return ImportTree(next(marked, root), tuple(Path(name).resolve() for name in named if name))


def shorten(text: str, width: int = 40) -> str:
    """The text on one line, cut to `width` characters, with what would steer a terminal shown.

    >>> shorten("a" * 50, 5)
    'aaaa…'
    """
    line = shown_line(text[: width + 1])
    return line if len(line) <= width else line[: width - 1] + "…"
