"""Damaged models of both text forms are read or refused, and never make a traceback."""

from random import Random

import pytest
from tests.tools.timed_damage import damaged, survives
from tests.tools.timed_generate import random_model

from rvmon.export.uppaal import uppaal_xml
from rvmon.timed.language.load import loads_network


@pytest.mark.slow
@pytest.mark.parametrize("form", ["ta", "xml"])
def test_damage_is_survived(form, tmp_path):
    """Whatever is changed, cut out or put in, the answer is a finding or a model."""
    texts = [random_model(seed) for seed in range(8)]
    if form == "xml":
        texts = [uppaal_xml(loads_network(text)) for text in texts]
    models = [text.encode() for text in texts]
    path, ends = tmp_path / "model", set()
    for seed in range(60):
        random = Random(seed)
        path.write_bytes(damaged(random.choice(models), random, models))
        ends.add(survives(path))
    assert {"refused", "checked"} <= ends
