"""Observers that detect faults, and proofs of what they detect."""
