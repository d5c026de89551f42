"""What is fitted: problems with their residuals."""
