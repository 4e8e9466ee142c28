"""Drives on which slip from three witnesses is measured against the truth; simulated."""
