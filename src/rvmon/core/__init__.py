"""The native core: its C sources, and the packing of plans for it; built as `rvmon.native`."""
