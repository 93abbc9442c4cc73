r"""The report as one HTML page that needs no other file: pages, pictures, replays; and as JSON.

    a1-studio report runs/evaluate/report.html            # of the tables that `evaluate` has kept
    a1-studio evaluate figures --tasks tilt manipulate_right walk sit_manipulate --out models/report
    a1-studio report models/report/index.html --committed \
        --replays example-tilt-and-reach example-cmu-march # of the pages in models/, as they stand
"""

import base64
import html
import json
import os
import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt

from studio.evaluation.markdown_tables import Shown, tables_of
from studio.evaluation.paper import beside
from studio.files import write_whole
from studio.takes.export.html import write_html
from studio.takes.session_library import SessionLibrary


@dataclass(frozen=True, kw_only=True)
class Content:
    """What the report is made of. pages: Markdown by the file it is of, or would be of. pictures:
    PNG files by their caption. replays: takes in `sessions`. facts: of machine, commit, seeds."""

    facts: str
    pages: dict[Path, str]
    pictures: dict[str, Path]
    sessions: Path
    replays: Sequence[str]


def write_report(out: Path, content: Content) -> dict[str, Any]:
    """The page, and FILE.json beside it: `{"page", "json", "tables"}`."""
    tables = [table for text in content.pages.values() for table in tables_of(text)]
    claims = list(beside(tables))
    parts = [
        "<h1>A1 Studio: what was measured</h1>",
        f"<p>{html.escape(content.facts)}</p>",
        "<h2>The paper's results, and ours</h2>",
        _table(("of", "the paper says", "measured here, in simulation"), claims),
        *(_picture(caption, file) for caption, file in content.pictures.items()),
        *(_replay(content.sessions, name) for name in content.replays),
        *(_page(text, file, out) for file, text in content.pages.items()),
    ]
    text = _PAGE.format(style=_STYLE, body="\n".join(parts))
    write_whole(out, text, parents=True)
    beside_it = out.with_suffix(".json")
    write_whole(beside_it, json.dumps(_data(content, claims, tables), indent=1, ensure_ascii=False))
    return {"page": str(out), "json": str(beside_it), "tables": len(tables)}


def _data(content: Content, claims: list[tuple[str, str, str]], tables: list[Shown]) -> Any:
    return {
        "facts": content.facts,
        "paper": [{"of": of, "paper": paper, "measured": ours} for of, paper, ours in claims],
        "tables": [table.as_dict() for table in tables],
    }


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def line(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(each)}</{tag}>" for each in cells) + "</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f'<div class="wide"><table class="words">{line(heads, "th")}{body}</table></div>'


def _picture(caption: str, file: Path) -> str:
    data = base64.b64encode(file.read_bytes()).decode()
    said = html.escape(caption)
    return (
        f'<figure><img alt="{said}" src="data:image/png;base64,{data}">'
        f"<figcaption>{said}</figcaption></figure>"
    )


def _replay(sessions: Path, name: str) -> str:
    """A take's replay, drawn by its own page in a frame of its own."""
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "take.html"
        write_html(SessionLibrary(sessions).read(name), file)
        page = html.escape(file.read_text("utf-8"), quote=True)
    said = html.escape(f"Take {name}: person, what the robot should do, what physics lets it do")
    return (
        f'<figure><iframe title="{said}" loading="lazy" sandbox="allow-scripts" '
        f'srcdoc="{page}"></iframe><figcaption>{said}</figcaption></figure>'
    )


def _page(text: str, file: Path, out: Path) -> str:
    """Markdown as HTML, a heading lower; links lead from the report's folder."""
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")

    def moved(found: re.Match[str]) -> str:
        link = found[2]
        if re.match(r"[a-z]+:|#", link):
            return found[0]
        path = os.path.relpath(file.parent / link, out.parent)
        return f'{found[1]}="{path}"'

    made = re.sub(r'(href|src)="([^"]*)"', moved, parser.render(text))
    made = re.sub(r"<(/?)h([1-5])>", lambda h: f"<{h[1]}h{int(h[2]) + 1}>", made)
    made = made.replace("<table>", '<div class="wide"><table>')
    made = made.replace("</table>", "</table></div>")
    begins = re.match(r"\s*<h2>(.*?)</h2>", made, re.DOTALL)
    title = begins[1] if begins else html.escape(file.name)
    rest = made[begins.end() :] if begins else made
    return f"<details><summary>{title}</summary>{rest}</details>"


_STYLE = """
:root { color-scheme: light dark; --line: #8884; --muted: light-dark(#57606a, #a3adba); }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 75rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.25rem; } h3, h4 { font-size: 1.05rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { border: 1px solid var(--line); padding: .25rem .5rem; text-align: left; }
td, th { white-space: nowrap; vertical-align: top; }
.words td, .words th { white-space: normal; min-width: 12rem; }
details { border-top: 1px solid var(--line); padding: .6rem 0; }
summary { cursor: pointer; font-size: 1.25rem; font-weight: 600; }
figure { margin: 1.5rem 0; } figcaption { color: var(--muted); font-size: .85rem; }
img { max-width: 100%; background: #fff; border-radius: 6px; }
iframe { width: 100%; height: 30rem; border: 1px solid var(--line); border-radius: 6px; }
"""
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>A1 Studio: what was measured</title><style>{style}</style></head>
<body>
{body}
</body></html>
"""
