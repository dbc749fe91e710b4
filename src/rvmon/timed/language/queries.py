"""Which queries are meant."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.timed.language.elaborate import query_on
from rvmon.timed.model.network import Network, Query
from rvmon.timed.model.rules import model_error


def chosen_queries(network: Network, asked: Sequence[str] | None) -> list[Query]:
    """The model's own queries, or those asked for by id or by text.

    Raises:
        ModelError: there is none, or a text is neither an id nor a query.
    """
    if asked is None:
        if not network.queries:
            mend = "give one with --query, or write `query: …` into the model"
            raise model_error("TA020", "the model has no query", None, mend)
        return list(network.queries)
    by_id = {query.id: query for query in network.queries if query.id}
    for text in asked:
        parts = [part.strip() for part in text.split(",")]
        if text.isidentifier() and text not in by_id and by_id:
            own = ", ".join(by_id)
            raise model_error("TA002", f"the model has no query `{text}`", None, f"it has {own}")
        if len(parts) > 1 and all(part in by_id for part in parts):
            several = " ".join(f"--query {part}" for part in parts)
            raise model_error("TA020", f"`{text}` is no query", None, f"write {several}")
    return [by_id.get(text) or query_on(network, text) for text in asked]
