# SPDX-License-Identifier: Apache-2.0
# The glossary of a report: names with what they mean, and links from where they are used.
import re
from dataclasses import dataclass

from markupsafe import Markup, escape

from .results import own_measures
from .table import TEXTS


@dataclass
class Entry:
    names: list
    meaning: str

    @property
    def address(self):
        return f"term-{address_of(self.names[0])}"


def address_of(name):
    """Letters of addresses; others as numbers, so that names keep apart."""
    return re.sub(r"[^A-Za-z0-9_-]", lambda match: f".{ord(match[0])}", name)


def one_spelling(text):
    """δ_R, as pages spell what programs write in ASCII; names of measures stay, as delta_R_max."""
    return re.sub(r"\bdelta_R\b", "δ_R", text)


def not_described(kind):
    return f"a {kind} of these results, whose program did not describe it: see `controlspace list`"


class Glossary:
    """Of all results of a report: their structures and settings, as their programs describe them, and
    the terms of texts.toml."""

    def __init__(self, all_results):
        structures, settings, own = {}, {}, []
        for results in all_results:
            described = {kind: results.descriptions.get(kind, {})
                         for kind in ("structures", "settings")}
            for row in results.rows:
                name = row.setting["structure"]
                structures.setdefault(name, described["structures"].get(
                    name, not_described("structure")))
                for key in row.setting:
                    if key not in ("structure", "split"):
                        settings.setdefault(key, not_described("setting"))
            settings.update(described["settings"])
            own += own_measures(results.rows)
        terms = [Entry(entry["names"], entry["meaning"]) for entry in TEXTS["glossary"]]
        known = {name for entry in terms for name in entry.names}
        self.groups = [
            ("Structures", [Entry([name], text) for name, text in structures.items()]),
            ("Terms and measures", terms + [
                Entry([key], "a measure of the program's own, as in results.json")
                for key in dict.fromkeys(own) if key not in known]),
            ("Settings", [Entry([name], text) for name, text in settings.items()
                          if name not in known])]
        self.by_name = {name: entry for _, entries in reversed(self.groups) for entry in entries
                        for name in entry.names}

    def linked(self, text):
        """`text` with a link from its first word to the entry of that name, if there is one."""
        name = re.match(r"[^\s,]*", text)[0]
        entry = self.by_name.get(name)
        if not entry:
            return text
        return Markup(f'<a class="term" href="#{entry.address}">') + escape(name) + Markup("</a>") \
            + escape(text[len(name):])

    def meaning(self, name):
        entry = self.by_name.get(one_spelling(name))
        return entry.meaning if entry else None
