"""Figures of the thesis made anew on one page, each entry an executable check with the pictures that belong to it."""
