#!/usr/bin/env python3
"""Prints the tables of docs/cost.md from what `barwave cost --json` wrote: python3 docs/cost.py FILE.json ..."""

import json
import sys


def time(seconds):
    if seconds is None:
        return "not reached"
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def main():
    rows = []
    for name in sys.argv[1:]:
        with open(name) as file:
            rows.append(json.load(file))
    print("| scene | reference | scheme | order | 10 % | 1 % | 0.1 % | 0.01 % |")
    print("|---|---|---|---|---|---|---|---|")
    for study in rows:
        first = f"{study['scene']} | {study['reference']} ({study['reference_uncertainty']:.0e})"
        for scheme, order in study["orders"].items():
            ways = [r for r in study["reach"] if r["scheme"] == scheme]
            cells = [("\u2264 " if r["how"] == "point" else "") + time(r["step_wall_s"]) for r in ways]
            shown = "" if order is None else f"{order:.2f}"
            print("|", " | ".join([first, scheme, shown, *cells]), "|")
            first = " | "
    print()
    print("| scene | effect | ns added | ratio |")
    print("|---|---|---|---|")
    for study in rows:
        for e in study["effects"]:
            if e["ns_per_cell_step"] is not None:
                print(f"| {study['scene']} | {e['effect']} | {e['ns_per_cell_step']:.2f} | {e['ratio_to_none']:.2f} |")
    print()
    print("load before and after:", *[f"{s['load'][0]} {s['load'][1]};" for s in rows])


main()
