"""Features of a log before any fit: friction level, rest, initial values."""
