"""Paths over a map: what each place costs, and the cheapest way."""
