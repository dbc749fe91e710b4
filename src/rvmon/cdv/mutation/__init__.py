"""Mutation testing: which small faults in code, and in requirements, does a suite detect?

`python_mutants` makes the mutants of the code under test with the operators of `python_operators`.
`baseline` plays the suite on the unchanged code, `play` plays it on each mutant, and `survivors`
turns each surviving mutant into a question. `spec_mutants` mutates requirements and judges recorded
runs by them. `report` has the figures.

Source: DeMillo, Lipton, Sayward 1978, Hints on Test Data Selection; King and Offutt 1991, A Fortran
Language System for Mutation-Based Software Testing.
"""
