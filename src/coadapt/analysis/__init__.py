"""Statistics of recordings and of simulated experiments."""
