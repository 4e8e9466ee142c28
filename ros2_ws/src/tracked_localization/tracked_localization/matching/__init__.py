"""Laser scans laid over maps."""
