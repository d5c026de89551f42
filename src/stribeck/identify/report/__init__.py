"""A fit's files, page and pictures."""
