"""Experiments with simulated participants: what a study would find, before it is run."""
