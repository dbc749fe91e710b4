"""The core in C, which judges samples by a plan, and what packs that plan; see plan.md."""
