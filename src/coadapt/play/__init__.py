"""The terminal program: a person steers, and sees what the robot believes and why it acts."""
