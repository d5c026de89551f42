"""What to measure on a rig, and a synthetic one."""
