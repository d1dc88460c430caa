#!/usr/bin/env python3
"""Takes the tables of docs/cost.md anew and puts them in their places; draws docs/cost.svg.

    cargo build --release
    python3 docs/cost.py [BUDGET]

BUDGET (60s where not given) is the time of each of the eight studies. What they said is kept in target/cost/*.json;
`python3 docs/cost.py --from-files` makes the tables of those again.
"""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "cost.md"
KEPT = ROOT / "target" / "cost"
SCENES = [
    "elastic-check",
    "bilinear-p2",
    "power-law-p3",
    "bilinear-p2-moc",
    "pulse-tension-us",
    "copper-released",
    "mild-steel-wall",
    "mild-steel-precursor",
]
DRAWN = "pulse-tension-us"


def study(name, budget):
    """Runs one study; what it says goes to a file, that of DRAWN to the figure too."""
    command = [str(ROOT / "target" / "release" / "barwave"), "cost", f"runs/{name}.toml", "--json", "--budget", budget]
    command += ["--measure", "field-at-end"]
    if name == DRAWN:
        command += ["-o", "docs/cost.svg"]
    print(f"{name} ...", file=sys.stderr)
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True)
    (KEPT / f"{name}.json").write_text(done.stdout)


def time(way):
    seconds = way["step_wall_s"]
    if seconds is None:
        return way["how"]
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def times(studies):
    lines = ["| scene | reference | scheme | order | 10 % | 1 % | 0.1 % | 0.01 % |", "|---|---|---|---|---|---|---|---|"]
    for study in studies:
        first = f"{study['scene']} | {study['reference']} ({study['reference_uncertainty']:.0e})"
        for scheme, order in study["orders"].items():
            ways = [r for r in study["reach"] if r["scheme"] == scheme]
            cells = [("\u2264 " if r["how"] == "point" else "") + time(r) for r in ways]
            shown = "" if order is None else f"{order:.2f}"
            lines.append("| " + " | ".join([first, scheme, shown, *cells]) + " |")
            first = " | "
    return lines


def effects(studies):
    lines = ["| scene | effect | scheme | ns a cell-step added | ratio |", "|---|---|---|---|---|"]
    for study in studies:
        for e in study["effects"]:
            if e["ns_per_cell_step"] is not None:
                figures = f"{e['ns_per_cell_step']:.2f} | {e['ratio_to_none']:.2f}"
                lines.append(f"| {study['scene']} | {e['effect']} | {e['scheme']} | {figures} |")
    return lines


def load(studies):
    known = [value for study in studies for value in study["load"] if value is not None]
    between = f"between {min(known):.1f} and {max(known):.1f}" if known else "unknown"
    budget = studies[0]["budget_s"]
    return [
        f"Each study had {budget:.0f} s; the load of the machine was {between}, with {studies[0]['threads']} threads.",
        "The command states the load, the spread and the shortest repetition beside the medians.",
    ]


def put(page, name, lines):
    """Replaces what stands between two marks."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    before, rest = page.split(begin)
    _, after = rest.split(end)
    return before + begin + "\n" + "\n".join(lines) + "\n\n" + end + after


def main():
    arguments = sys.argv[1:]
    KEPT.mkdir(parents=True, exist_ok=True)
    if arguments != ["--from-files"]:
        for name in SCENES:
            study(name, arguments[0] if arguments else "60s")
    studies = [json.loads((KEPT / f"{name}.json").read_text()) for name in SCENES]
    page = PAGE.read_text()
    for name, lines in (("times", times(studies)), ("effects", effects(studies)), ("load", load(studies))):
        page = put(page, name, lines)
    PAGE.write_text(page)


main()
