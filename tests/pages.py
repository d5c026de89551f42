"""The tables of a page."""

import re
from html.parser import HTMLParser


class Page(HTMLParser):
    """A section of a page: ``tables``, each a list of rows of text."""

    def __init__(self, path, section):
        super().__init__()
        self.tables, self.inside = [], None
        source = path.read_text().replace("<wbr>", "")  # where a word may break, not where it ends
        self.feed(re.search(rf'<section id="{section}">.*?</section>', source, re.S)[0])

    def handle_starttag(self, tag, attrs):
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
        self.inside = tag if tag in ("td", "th", "span") else None

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.inside = None

    def handle_data(self, data):
        if self.inside is not None and self.tables:
            self.tables[-1][-1][-1] += data
