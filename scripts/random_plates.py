#!/usr/bin/env python3
"""Random impacts of two plates without `method`: warnings and errors of each run.

Draws two library materials, an impact speed from 200 m/s to 3 km/s and the sizes of both plates, on a
line, in a plane and about an axis; joined, with frictionless contact, with friction, and of materials
with strength. Prints for each scene the ratio of the warning of heat (see src/simulation/monitor),
other warnings and errors, and at the end the number of scenes without any.

    scripts/random_plates.py target/release/flyer-mpm --count 80
    scripts/random_plates.py target/release/flyer-mpm --set method='{"preset": "default", "heat_spreading": null}'
"""

import argparse
import json
import math
import random
import re
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

FLUIDS = [
    "aluminium_1100", "aluminium_2024", "copper", "gold", "iron", "lead", "lithium_fluoride", "nickel",
    "pmma", "sapphire", "steel_304", "steel_4340", "tantalum", "titanium", "tungsten",
]
WITH_STRENGTH = [
    "copper_johnson_cook", "steel_4340_johnson_cook", "aluminium_2024_johnson_cook",
    "copper_steinberg_guinan", "aluminium_6061_steinberg_guinan", "tantalum_steinberg_guinan",
]
KINDS = [
    "plane", "plane contact", "plane strength", "axis", "axis contact", "axis strength",
    "plane friction", "axis friction", "line", "line contact", "line strength",
]
CELL = 5e-5


def scene(seed, kind):
    """The scene of a seed."""
    draw = random.Random(seed)
    pool = WITH_STRENGTH if "strength" in kind else FLUIDS
    flyer, target = draw.choice(pool), draw.choice(pool)
    speed = round(math.exp(draw.uniform(math.log(200), math.log(3000))))
    thick, target_thick = draw.randint(10, 30) * CELL, draw.randint(20, 50) * CELL
    wide, target_wide = draw.randint(15, 40) * CELL, draw.randint(30, 60) * CELL
    end = 0.6 * (thick + target_thick) / 5000
    margin = math.ceil((1.2 * speed * end + 10 * CELL) / CELL) * CELL
    line, axis = kind.startswith("line"), kind.startswith("axis")

    def box(width, lower, upper):
        left = 0 if axis else -width
        return {"lower": [lower], "upper": [upper]} if line else {
            "lower": [left, lower], "upper": [width, upper]}

    made = {
        "title": f"{seed} {kind}: {flyer} on {target}, {speed} m/s",
        "domain": {**box(max(wide, target_wide) + margin, -target_thick - margin, thick + margin),
                   "cell_size": CELL},
        "time": {"end": end},
        "materials": {"flyer": {"library": flyer}, "target": {"library": target}},
        "bodies": [
            {"name": "flyer", "material": "flyer", "box": box(wide, 0, thick),
             "velocity": [-speed] if line else [0, -speed]},
            {"name": "target", "material": "target", "box": box(target_wide, -target_thick, 0)},
        ],
        "output": {"profiles": {"times": [end]}, "pictures": False},
    }
    if axis:
        made["domain"]["geometry"] = "axisymmetric"
        made["boundary"] = {"x_lower": "symmetry"}
    if "contact" in kind:
        made["contact"] = {"type": "frictionless"}
    if "friction" in kind:
        made["contact"] = {"type": "friction", "coefficient": round(draw.uniform(0.1, 0.5), 2)}
    return made


def run(program, seed, kind, sets):
    """Title of a scene, and what its run warns of."""
    made = scene(seed, kind)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.json"
        path.write_text(json.dumps(made))
        command = [program, path, "--output", Path(folder) / "out", "--threads", "1", *sets]
        done = subprocess.run(command, capture_output=True, text=True)
    text = re.sub(r"\s+", " ", done.stdout + done.stderr)
    found = [f"heat {ratio}" for ratio in re.findall(r"up to ([\d.]+) times the energy of one", text)]
    found += re.findall(r"warning: (?!some particles are hotter).{90}|error: .{90}", text)
    return made["title"], found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=22, help="number of scenes")
    parser.add_argument("--kinds", default=",".join(KINDS), help="kinds in turn, with commas between")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE",
                        help="edit of all scenes, as for the program")
    given = parser.parse_args()
    sets = [part for edit in given.set for part in ("--set", edit)]
    kinds = given.kinds.split(",")
    seeds = range(given.first, given.first + given.count)
    with ThreadPoolExecutor(2) as pool:
        work = lambda seed: run(given.program.resolve(), seed, kinds[seed % len(kinds)], sets)
        results = []
        for title, found in pool.map(work, seeds):
            results.append(found)
            print(f"{title} | {'; '.join(found)}", flush=True)
    heat = sum(any(line.startswith("heat") for line in found) for found in results)
    print(f"{len(results)} scenes: {sum(not found for found in results)} without warning or error, "
          f"{heat} with a warning of heat")


if __name__ == "__main__":
    main()
