"""Whole episodes, compiled."""
