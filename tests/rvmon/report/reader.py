"""Reads pages as elements and texts."""

from html.parser import HTMLParser


class Reader(HTMLParser):
    """Elements with their attributes, the texts of some, and the text of the page."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.words, self.texts, self.open = [], [], {}, []
        self.feed(page)
        self.text = " ".join(" ".join(self.words).split())
        self.ids = [attributes["id"] for _, attributes in self.tags if "id" in attributes]

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag in ("mark", "title", "pre"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag in self.open:
            self.open.remove(tag)

    def handle_data(self, data):
        self.words.append(data)
        for tag in self.open:
            self.texts[tag] = self.texts.get(tag, "") + data

    def dangling(self):
        """Links within the page that lead nowhere."""
        links = {attributes["href"] for tag, attributes in self.tags if tag == "a"}
        return {link for link in links if link.removeprefix("#") not in self.ids}
