"""What a campaign calls unreachable, as items of its coverage model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.closing import Unreachable
from rvmon.cdv.code import Code
from rvmon.coverage.model import Model, Subject
from rvmon.errors import UnknownNameError

_CODE = (Subject.STATEMENTS, Subject.BRANCHES)
_ARROW = " → "


def unreachable_items(
    campaign: Campaign, robot: str, model: Model, *, whole: bool = False
) -> dict[tuple[str, str], str]:
    """The items of a model that a campaign calls unreachable, each with the reason.

    Args:
        campaign: what says so.
        robot: of its robots the one whose tests are meant.
        model: what there is to be covered.
        whole: the model has all that is ever measured: what it lacks there is not. Of any other,
            such as one without the edges that closing measures, that is passed over.

    Raises:
        UnknownNameError: nothing in the model is called so.
    """
    texts = {} if campaign.code is None else _texts(campaign.code)
    found: dict[tuple[str, str], str] = {}
    for one in campaign.closing.unreachable:
        if one.robot not in ("", robot):
            continue
        items = [*_named(one, model, texts)]
        if not items and whole:
            place = f"{one.group}: {one.item}" if one.group else f"code `{one.item}`"
            raise UnknownNameError(
                f"the campaign calls unreachable what there is not: {place}: nothing that is "
                "measured is called so; take it out of `Closing.unreachable`"
            )
        found |= dict.fromkeys(items, one.reason)
    return found


def _named(
    one: Unreachable, model: Model, texts: Mapping[str, Mapping[str, str]]
) -> Iterable[tuple[str, str]]:
    if one.item in getattr(model.groups.get(one.group), "items", ()):
        yield one.group, one.item
        return
    source, _, target = one.item.rpartition(_ARROW)
    for group in model.groups.values():
        if group.subject not in _CODE or one.group not in ("", group.name):
            continue
        lines = texts[group.name.partition(" of ")[2]]
        for item in group.items:
            first, _, last = item.rpartition(_ARROW)
            if lines.get(last) == target and (not source or lines.get(first) == source):
                yield group.name, item


def _texts(code: Code) -> dict[str, dict[str, str]]:
    """The text of each line of each block, by the name of the block and the line's number."""
    files = {
        path: Path(path).read_text(encoding="utf-8").splitlines()
        for path in {block.path for block in code.blocks}
    }
    return {
        block.name: {
            str(number): files[block.path][number - 1].strip()
            for number in block.lines
            if number <= len(files[block.path])
        }
        for block in code.blocks
    }
