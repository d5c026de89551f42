"""What a log shows by itself: levels, stretches, rough values."""
