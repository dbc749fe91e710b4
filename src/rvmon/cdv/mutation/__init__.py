"""Mutation testing: which small wrong changes of code, and of requirements, does a suite see?

`mutants` finds the changes of the code under test in its syntax tree, `play_mutants` plays a suite
on each, and `scored` counts which are killed; a survivor is a question about what is missing.

Source: DeMillo, Lipton, Sayward 1978, Hints on Test Data Selection; King and Offutt 1991, A Fortran
Language System for Mutation-Based Software Testing.
"""
