"""Starts, watches, records and ends the graph of nodes that a scenario needs."""
