"""The native core: its sources in C, and what packs plans for it; built, it is `rvmon.native`."""
