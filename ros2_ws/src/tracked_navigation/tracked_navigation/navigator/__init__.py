"""Drives to goals on a map: global path, band, movers, and why it stops."""

from tracked_navigation.navigator.navigator import Navigator
from tracked_navigation.navigator.progress import Finished, NavigatorOutput, Outcome, Progress
from tracked_navigation.navigator.settings import NavigatorSettings

__all__ = ["Finished", "Navigator", "NavigatorOutput", "NavigatorSettings", "Outcome", "Progress"]
