"""The elements of machines: a file in this folder for each family, and for each kind that is more than a few lines."""
