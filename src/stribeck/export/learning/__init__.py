"""Joint friction for the simulators of robot learning: one file each, with the law's equations and constants."""
