"""What solutions tell: comparisons between laws."""
