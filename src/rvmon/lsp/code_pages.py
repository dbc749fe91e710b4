"""The pages of diagnostic codes as files, which editors open by a link."""

from __future__ import annotations

from functools import cache

from pygls.uris import from_fs_path

from rvmon.cache import cache_folder
from rvmon.errors import RvmonError
from rvmon.explain.codes import page_of
from rvmon.writing import write_whole


@cache
def page_uri(code: str) -> str | None:
    """The address of a code's page, of this version of rvmon; `None` if it cannot be kept."""
    folder = cache_folder()
    if folder is None:
        return None
    path = folder / "codes" / f"{code}.md"
    try:
        path.parent.mkdir(mode=0o700, exist_ok=True)
        write_whole(str(path), page_of(code))
    except (OSError, RvmonError):
        return None
    return from_fs_path(str(path))
