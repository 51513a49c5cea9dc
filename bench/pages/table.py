# SPDX-License-Identifier: Apache-2.0
# Tables of text, and their Markdown.
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

TEXTS = tomllib.loads((Path(__file__).parent / "texts.toml").read_text(encoding="utf-8"))


@dataclass
class Table:
    title: str
    note: str
    columns: list  # headers; those that begin with "<" are aligned left
    rows: list = field(default_factory=list)

    @property
    def is_wide(self):
        return len(self.columns) > 4 or any(len(str(text)) > 60 for row in self.rows for text in row)

    def heads(self):
        return [(c.removeprefix("<"), c.startswith("<")) for c in self.columns]

    def markdown(self):
        left = [is_left for _, is_left in self.heads()]
        lines = [[cell(text) for text, _ in self.heads()]]
        lines += [[cell(text) for text in row] for row in self.rows]
        widths = [max(3, *(len(line[i]) for line in lines)) for i in range(len(left))]
        rule = ["-" * w if is_left else "-" * (w - 1) + ":" for w, is_left in zip(widths, left)]
        lines.insert(1, rule)
        text = f"## {self.title}\n\n" + (f"{self.note}\n\n" if self.note else "")
        for line in lines:
            padded = (t.ljust(w) if is_left else t.rjust(w)
                      for t, w, is_left in zip(line, widths, left))
            text += "| " + " | ".join(padded) + " |\n"
        return text


def table_of(kind, rows, more_columns=(), **words):
    """A table with the texts of texts.toml."""
    texts = TEXTS["tables"][kind]
    return Table(texts["title"].format(**words), texts["note"],
                 [*texts["columns"], *more_columns], rows)


def cell(text):
    return str(text).replace("|", "\\|").replace("\n", " ").replace("\r", " ")


def fixed(x, digits=2):
    return f"{x:.{digits}f}"


def shown(value):
    """A setting of a study."""
    if value in (None, [], ""):
        return "not set"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
