"""The native core: its C sources, and the packing of plans for it. Built, it is `rvmon.native`."""
