"""The campaign on what was lost finds a law that would hide a failure."""

import pytest
from benchmarks.soundness_rules import RULES, Rule, runs_needed

QUICK = {
    "within, a signal is unknown",
    "what was lost is born",
    "within, an event is unknown",
    "so is `updated` of an event",
    "a position may lie at any tick",
}


@pytest.mark.parametrize(
    "rule", [rule for rule in RULES if rule.says in QUICK], ids=lambda r: r.says
)
def test_a_law_without_a_rule_is_found_out(rule: Rule) -> None:
    """A run's verdict is overturned before long; with the rule it is not."""
    seeds = [f"1/{k}" for k in range(120)]
    needed = runs_needed(rule, iter(seeds))
    assert needed is not None
    kept = Rule(rule.says, rule.owner, rule.name, lambda law: law, rule.times, rule.about)
    assert runs_needed(kept, iter(seeds[:needed])) is None
