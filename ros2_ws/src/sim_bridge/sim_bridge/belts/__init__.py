"""Belt-force model: what the ground does to two tracks, compiled with numba."""
