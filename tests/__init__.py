"""Tests on topics, with the real executables over real DDS, and tests of the tree itself."""
