"""What robots do in every step, compiled."""
