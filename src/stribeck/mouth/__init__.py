"""How results are told to people: a document of chapters, which the terminal prints and a page renders."""
