#!/usr/bin/env python3
"""Draws docs/growth.svg from docs/growth.csv: python3 docs/growth.py"""

import csv
import math
from pathlib import Path

HERE = Path(__file__).parent
WIDTH, HEIGHT, LEFT, TOP, GAP = 380, 300, 62, 46, 70
CELLS, TIMES = (2, 7), (-3, 2)
MEASURED = {"1": "#1f77b4", "2": "#d95f02"}
PROJECTED, LIMIT = "#7b5ea7", "#666666"
# As in src/solver/fd/sweep.rs and sizes.rs: cells of a block, least blocks of a thread, most steps of a pass through the bar, and blocks
# of a thread for each of them.
BLOCK, LEAST_BLOCKS, STEPS_A_PASS, BLOCKS_A_STEP = 256, 64, 32, 16
# The machine of the projection, which was not measured: cores, and bytes per second of eight channels of DDR4-3200.
CORES, BANDWIDTH = 64, 205e9


def across(panel, cells):
    low, high = CELLS
    return LEFT + panel * (WIDTH + GAP) + WIDTH * (math.log10(cells) - low) / (high - low)


def down(time):
    low, high = TIMES
    return TOP + HEIGHT * (high - math.log10(time)) / (high - low)


def text(x, y, content, anchor="middle", size=12):
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}">{content}</text>'


def power(decade):
    return f'10<tspan dy="-5" font-size="9">{decade}</tspan>'


def axes(panel, title):
    x0 = LEFT + panel * (WIDTH + GAP)
    out = [f'<rect x="{x0}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>']
    out.append(text(x0 + WIDTH / 2, TOP - 14, title, size=14))
    for decade in range(TIMES[0], TIMES[1] + 1):
        y = down(10.0**decade)
        out.append(f'<path d="M{x0} {y:.1f}h{WIDTH}" stroke="#e4e4e4"/>')
        out.append(text(x0 - 6, y + 4, power(decade), "end"))
    for decade in range(CELLS[0], CELLS[1] + 1):
        out.append(text(across(panel, 10.0**decade), TOP + HEIGHT + 18, power(decade)))
    out.append(text(x0 + WIDTH / 2, TOP + HEIGHT + 36, "cells"))
    return out


def line(panel, points, colour, dashes=""):
    path = " ".join(f"{across(panel, cells):.1f},{down(time):.1f}" for cells, time in points)
    dash = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.8"{dash}/>'


def projection(cells, alone, bytes_per_cell):
    """Time of a cell-step on many cores, ns: as fast as they compute, or as fast as the bar comes through the cache."""
    blocks = cells // BLOCK
    cores = max(1, min(CORES, blocks // LEAST_BLOCKS))
    steps = STEPS_A_PASS if cores == 1 else min(STEPS_A_PASS, blocks // cores // BLOCKS_A_STEP)
    return max(alone / cores, 1e9 * 2 * bytes_per_cell / steps / BANDWIDTH)


def main():
    with open(HERE / "growth.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    time = "time of a cell-step (ns)"
    body = [f'<g transform="translate(16 {TOP + HEIGHT / 2}) rotate(-90)">{text(0, 0, "ns per cell and step")}</g>']
    for panel, bar in enumerate(["elastic", "bilinear"]):
        of = {n: [r for r in rows if r["bar"] == bar and r["threads"] == n] for n in MEASURED}
        body += axes(panel, "all cells elastic" if bar == "elastic" else "all cells flow, isotropic hardening")
        size = max(float(r["bytes a cell"]) for r in of["1"] if r["bytes a cell"])
        for threads, colour in MEASURED.items():
            points = [(float(r["cells"]), float(r[time])) for r in of[threads]]
            body.append(line(panel, points, colour))
            body += [f'<circle cx="{across(panel, c):.1f}" cy="{down(t):.1f}" r="3" fill="{colour}"/>' for c, t in points]
        alone = [(int(r["cells"]), float(r[time])) for r in of["1"]]
        body.append(line(panel, [(c, projection(c, t, size)) for c, t in alone], PROJECTED, "6 4"))
        triad = 1e9 * float(of["2"][0]["triad (GB/s)"])
        for steps, dashes in ((1, "2 3"), (STEPS_A_PASS, "2 6")):
            limit = 1e9 * 2 * size / steps / triad
            body.append(line(panel, [(1e2, limit), (1e7, limit)], LIMIT, dashes))
    legend = [
        (MEASURED["1"], "", "1 thread"),
        (MEASURED["2"], "", "2 threads"),
        (PROJECTED, "6 4", f"projection: {CORES} cores, {BANDWIDTH / 1e9:.0f} GB/s"),
        (LIMIT, "2 3", "memory bandwidth (triad, 2 threads), every cell read and written in every step"),
        (LIMIT, "2 6", f"the same, every cell read and written once in {STEPS_A_PASS} steps, as it is done"),
    ]
    for k, (colour, dashes, label) in enumerate(legend):
        y = TOP + HEIGHT + 64 + 19 * k
        body.append(f'<path d="M{LEFT} {y}h30" stroke="{colour}" stroke-width="2" stroke-dasharray="{dashes or "none"}"/>')
        body.append(text(LEFT + 40, y + 4, label, "start"))
    width, height = LEFT + 2 * WIDTH + GAP + 20, TOP + HEIGHT + 64 + 19 * len(legend)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">'
    white = f'<rect width="{width}" height="{height}" fill="white"/>'
    (HERE / "growth.svg").write_text("\n".join([head, white, *body, "</svg>"]) + "\n")


main()
