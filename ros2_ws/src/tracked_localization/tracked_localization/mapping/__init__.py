"""Maps from laser scans, and their files."""
