"""Presentation of results: a document of chapters, which the terminal prints and a page renders."""
