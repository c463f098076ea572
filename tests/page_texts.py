"""Extract the texts of a report page, without those of users and file readers."""

import json
import re
from html.parser import HTMLParser

#: Elements without an end.
VOID = {"meta", "input", "img", "br"}

#: Elements whose text is not the report's: code, and the table of input files.
FOREIGN = {"script", "style", "pre", "inputs"}

#: Tables of what readers said of files.
READERS = {"record-warnings", "failures", "left-out"}

#: Fields, values of the configuration, settings and commands.
QUOTED = re.compile(r"\{\w+\}|«[^»]*»|\[+[\w.]+\]+( \w+( = \S+)?)?|--\w+|\b\w+ = \S+|rockpulse \w+")


class PageTexts(HTMLParser):
    """The texts and labels of a page, but for the facts under some headings."""

    def __init__(self, foreign_facts, foreign):
        super().__init__()
        self.foreign, self.foreign_facts = FOREIGN | foreign, foreign_facts
        self.open, self.texts, self.fact = [], [], ""

    def handle_starttag(self, tag, attrs):
        own = dict(attrs)
        self.texts += [own[name] for name in ("aria-label", "placeholder", "data-label") if own.get(name)]
        if "data-motions" in own:
            data = json.loads(own["data-motions"])
            self.texts += [*data["words"].values(), *(record["words"] for record in data["records"])]
            scenes = [scene for body in data["bodies"] for scene in body["scenes"]]
            self.texts += [text for scene in scenes for text in (*scene["why"], scene.get("warning", ""))]
        if tag not in VOID:
            self.open.append((tag, bool(self.foreign & {tag, own.get("id")})))

    def handle_startendtag(self, tag, attrs):
        """A drawn line or point."""

    def handle_endtag(self, tag):
        while self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, text):
        tags = [tag for tag, _ in self.open]
        if tags and tags[-1] == "dt":
            self.fact = text
        foreign = any(foreign for _, foreign in self.open) or (tags[-1:] == ["dd"] and self.fact in self.foreign_facts)
        if text.strip() and not foreign:
            self.texts.append(text.strip())


def page_texts(page, foreign_facts, names, foreign=frozenset()):
    """The texts of a page without names of the user's, values of the configuration, and commands."""
    parser = PageTexts(foreign_facts, foreign)
    parser.feed(page)
    found = []
    for text in parser.texts:
        for name in names:
            text = text.replace(name, "")
        found.append(QUOTED.sub("", text))
    return found
