"""Thousands of runs: what to run, where results are kept, how they are run, and what they say."""
