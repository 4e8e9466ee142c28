"""The command line: designs, proofs and maps from specifications that are data, never code."""
