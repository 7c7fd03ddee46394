"""The report: one self-contained page with the tables, and two plots for each case."""

from collections.abc import Sequence
from html import escape
from itertools import groupby

import numpy as np

from backend.bench.accuracy import text
from backend.bench.accuracy.outcome import Outcome, Row
from backend.bench.accuracy.svg import Line, plot

MAP_PX, CURVE_PX = (560.0, 420.0), (560.0, 420.0)
COLOURS = ("#0b62a4", "#c4461e", "#2e7d32", "#7b3fa0", "#9a6a00", "#00838f", "#ad1457", "#5d4037")
STYLE = """\
body{font:14px/1.5 system-ui,sans-serif;margin:2em auto;max-width:76em;padding:0 1em}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}th,td{padding:.15em .7em;text-align:right}
th:first-child,td:first-child{text-align:left}tr+tr{border-top:1px solid #dde1e6}.failed{color:#b00020}
svg{max-width:100%;height:auto;font-size:11px;fill:#57606a}figure{display:inline-block;margin:1em 1em 1em 0}
polyline{fill:none;stroke-width:1.3}.smoothed{stroke-dasharray:5 3}.truth{stroke:#b8bec6;stroke-width:4}
.grid{stroke:#eceff2;fill:none}.key{display:inline-block;width:2em;border-top:3px solid;margin:0 .5em .25em 0}
.key.smoothed{border-top-style:dashed}.key.truth{border-color:#b8bec6}"""


def page(rows: Sequence[Row], drawn: Sequence[Outcome], seeds: int, left_out: Sequence[str]) -> str:
    """The page.

    Args:
        rows: of all cases, those of one case together.
        drawn: outcomes of the first seed, with their tracks.
        seeds: of each scenario.
        left_out: a line for each data set that is not judged.
    """
    names = list(dict.fromkeys(row.entrant for row in rows))
    colours = {name: COLOURS[i % len(COLOURS)] for i, name in enumerate(names)}
    css = "".join(
        f".c{i}{{stroke:{colours[name]};border-color:{colours[name]}}}" for i, name in enumerate(names)
    )
    head = "<br>".join(escape(line) for line in text.head(seeds, left_out).splitlines())
    sections = [
        _section(case, list(own), [o for o in drawn if o.case == case], names)
        for case, own in groupby(rows, key=lambda row: row.case)
    ]
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Firethread: accuracy</title>'
        f'<meta name="viewport" content="width=device-width"><style>{STYLE}\n{css}</style>'
        f"<h1>Accuracy</h1><p>{head}</p>" + "".join(sections) + "</html>\n"
    )


def _section(case: str, rows: Sequence[Row], drawn: Sequence[Outcome], names: Sequence[str]) -> str:
    keys = " ".join(
        f'<span class="key c{names.index(row.entrant)} {row.mode}"></span>{escape(row.entrant)} {row.mode}'
        for row in rows
    )
    return (
        f"<h2>{escape(case)}</h2>{_table(rows)}"
        f'<p><span class="key truth"></span>truth {keys}(seed 0)</p>{_plots(drawn, names)}'
    )


def _table(rows: Sequence[Row]) -> str:
    head = "".join(f"<th>{escape(name)}</th>" for name in ("", *text.COLUMNS))
    lines = []
    for row in rows:
        figures = "".join(f"<td>{escape(cell)}</td>" for cell in text.cells(row))
        failed = text.failures(row)
        note = f'<td class="failed">{escape(failed)}</td>' if failed else ""
        lines.append(f"<tr><td>{escape(f'{row.mode} {row.entrant}')}</td>{figures}{note}</tr>")
    return f"<table><tr>{head}</tr>{''.join(lines)}</table>"


def _plots(drawn: Sequence[Outcome], names: Sequence[str]) -> str:
    paths: dict[str, Line] = {}
    tracks: list[Line] = []
    errors: list[Line] = []
    for outcome in drawn:
        if outcome.verdict is None:
            continue
        css = f"c{names.index(outcome.entrant)} {outcome.mode}"
        for one in outcome.verdict.drawn:
            label = f"{one.node}, {outcome.entrant} {outcome.mode}"
            paths[one.node] = Line(one.path_m, "truth", f"{one.node}, truth")
            tracks.append(Line(one.estimated_m, css, label))
            errors.append(Line(np.column_stack([one.t_s, one.off_m]), css, label))
    if not tracks:
        return ""
    start_s = min((float(line.points[0, 0]) for line in errors if len(line.points)), default=0.0)
    since = [
        line._replace(points=line.points - np.array([start_s, 0.0])) for line in errors if len(line.points)
    ]
    maps = plot([*paths.values(), *tracks], *MAP_PX, equal=True, units=("east m", "north m"))
    curves = plot(since, *CURVE_PX, equal=False, units=("seconds", "error m"))
    return f"<figure>{maps}</figure><figure>{curves}</figure>"
