"""What the data tell: intervals, cross-validation, choice of a model."""
