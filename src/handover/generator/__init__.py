"""Abstract tests: their type, their files, and the strategies that generate them."""
