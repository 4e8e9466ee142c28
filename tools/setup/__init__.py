"""Sets a working tree up: ``python3 -m tools.setup`` from the root of the repository (``make setup``).

Runs under any Python from 3.9 on (the Makefile asks) and
imports nothing but the standard library, since nothing is installed yet.
"""
