"""Maps of sweeps: what the robot does over the cost of disagreement and the gap of rewards."""
