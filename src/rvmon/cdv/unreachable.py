"""What a campaign calls unreachable, as items of its coverage model."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.closing import Unreachable
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
    found: dict[tuple[str, str], str] = {}
    for one in campaign.closing.unreachable:
        if one.robot not in ("", robot):
            continue
        items = [*_named(one, model)]
        if not items and whole:
            place = f"{one.group}: {one.item}" if one.group else f"code `{one.item}`"
            raise UnknownNameError(
                f"the campaign calls unreachable what there is not: {place}: nothing that is "
                "measured is called so; take it out of `Closing.unreachable`"
            )
        found |= dict.fromkeys(items, one.reason)
    return found


def _named(one: Unreachable, model: Model) -> Iterable[tuple[str, str]]:
    if one.item in getattr(model.groups.get(one.group), "items", ()):
        yield one.group, one.item
        return
    for group in model.groups.values():
        if group.subject in _CODE and one.group in ("", group.name):
            for item in group.items.values():
                targets = [item.text]
                if group.subject is Subject.BRANCHES:
                    targets.append(item.text.rpartition(_ARROW)[2])
                if one.item in targets:
                    yield group.name, item.name
