"""How results are presented: a document of chapters, which the terminal prints and a page renders."""
