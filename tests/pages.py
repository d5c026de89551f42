"""What a page shows: its headings, its tables as rows of text, its figures."""

import re
from html.parser import HTMLParser


class Page(HTMLParser):
    """A page as a reader sees it, or one of its sections.

    ``headings``: of its chapters, ``tables``: each a list of rows, ``pictures``: how many, ``text``: all that is read.
    """

    def __init__(self, path, section=None):
        super().__init__()
        self.tables, self.headings, self.cell, self.inside, self.pictures, self.words = [], [], None, None, 0, []
        self.hidden = 0
        source = path.read_text()
        assert re.findall(r'(?:src|href)="(?!#)([^"]+)"|url\((?!#)([^)]+)\)|@import', source) == []  # it stands alone
        ids = re.findall(r'\bid="([^"]+)"', source)
        assert len(ids) == len(set(ids))
        source = source.replace("<wbr>", "")  # where a word may break, not where it ends
        self.feed(source if section is None else re.search(rf'<section id="{section}">.*?</section>', source, re.S)[0])

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())

    def rows(self, head):
        """The rows, by their first cell, of the table whose head begins so."""
        (table,) = (t for t in self.tables if t[0][: len(head)] == list(head))
        return {row[0]: row[1:] for row in table[1:]}

    def handle_starttag(self, tag, attrs):
        self.pictures += tag == "svg"
        self.hidden += tag in ("svg", "style", "script")
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
        self.inside = tag if tag in ("td", "th", "h2", "span") else None
        if tag == "h2":
            self.headings.append("")

    def handle_endtag(self, tag):
        self.hidden -= tag in ("svg", "style", "script")
        if tag in ("td", "th", "h2"):
            self.inside = None

    def handle_data(self, data):
        if not self.hidden:
            self.words.append(data)
        if self.inside == "h2":
            self.headings[-1] += data
        elif self.inside is not None and self.tables:
            self.tables[-1][-1][-1] += data
