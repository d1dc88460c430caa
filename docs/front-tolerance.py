#!/usr/bin/env python3
"""Draws docs/front-tolerance.svg from docs/front-tolerance.csv. Needs nothing but Python: python3 docs/front-tolerance.py"""

import csv
import math
from pathlib import Path

HERE = Path(__file__).parent
WIDTH, HEIGHT, LEFT, TOP, GAP_X, GAP_Y = 250, 190, 62, 40, 70, 72
COLOURS = ["#1f77b4", "#d95f02", "#2a9d5c", "#c02942", "#7b5ea7", "#8c564b", "#d46fb5", "#666666", "#a39a1d", "#17a3b5"]
# Title, column, decades of the vertical axis.
PANELS = [
    ("events", "events", (2, 7)),
    ("fronts at the end", "fronts at end", (0, 2)),
    ("time, s", "time (s)", (-4, 1)),
    ("true error, stress or plastic strain", "error", (-3, 1)),
    ("estimated error", "estimate", (-3, 1)),
]
TOLERANCES = (-2.15, -0.85)


def place(panel):
    return LEFT + (panel % 3) * (WIDTH + GAP_X), TOP + (panel // 3) * (HEIGHT + GAP_Y)


def text(x, y, content, anchor="middle", size=12):
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}">{content}</text>'


def axes(panel, title, low, high):
    x0, y0 = place(panel)
    out = [f'<rect x="{x0}" y="{y0}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>']
    out.append(text(x0 + WIDTH / 2, y0 - 10, title, size=13))
    for decade in range(low, high + 1):
        y = y0 + HEIGHT * (high - decade) / (high - low)
        out.append(f'<path d="M{x0} {y:.1f}h{WIDTH}" stroke="#e4e4e4"/>')
        power = f'10<tspan dy="-5" font-size="9">{decade}</tspan>'
        out.append(text(x0 - 6, y + 4, power, "end"))
    for tolerance in (1e-2, 3e-2, 1e-1):
        out.append(text(across(x0, tolerance), y0 + HEIGHT + 17, f"{tolerance:g}"))
    out.append(text(x0 + WIDTH / 2, y0 + HEIGHT + 34, "front-tolerance"))
    return out


def across(x0, tolerance):
    low, high = TOLERANCES
    return x0 + WIDTH * (math.log10(tolerance) - low) / (high - low)


def curve(panel, points, low, high, colour):
    x0, y0 = place(panel)
    at = [(across(x0, t), y0 + HEIGHT * (high - math.log10(v)) / (high - low)) for t, v in points]
    out = [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in at]
    if at:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in at)
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
    return out


def main():
    with open(HERE / "front-tolerance.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    names = list(dict.fromkeys(row["case"] for row in rows))
    body = []
    for panel, (title, column, (low, high)) in enumerate(PANELS):
        body += axes(panel, title, low, high)
        for name, colour in zip(names, COLOURS):
            values = [(float(r["front tolerance"]), r[column]) for r in rows if r["case"] == name]
            # Zero has no place on a logarithmic axis; an empty field was not measured.
            points = [(t, float(v)) for t, v in values if v and float(v) > 0]
            body += curve(panel, points, low, high, colour)
    x0, y0 = place(5)
    for k, (name, colour) in enumerate(zip(names, COLOURS)):
        y = y0 + 8 + 19 * k
        body.append(f'<path d="M{x0} {y}h22" stroke="{colour}" stroke-width="2.5"/>')
        body.append(text(x0 + 30, y + 4, name, "start"))
    width, height = place(2)[0] + WIDTH + 20, place(5)[1] + HEIGHT + 46
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">'
    white = f'<rect width="{width}" height="{height}" fill="white"/>'
    (HERE / "front-tolerance.svg").write_text("\n".join([head, white, *body, "</svg>"]) + "\n")


main()
