"""Models of fits: problems with their residuals."""
