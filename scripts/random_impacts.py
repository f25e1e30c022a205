#!/usr/bin/env python3
"""Random plane impacts in both frames: errors against the exact solution, as quantiles.

Draws impacts of 24 materials (handbook c0, s and gamma0; S. P. Marsh (1980), LASL Shock Hugoniot
Data, and M. A. Meyers (1994), Dynamic Behavior of Materials, table 5.1), speeds from 200 m/s to
4 km/s and flyers of 15 to 120 cells, runs each with the method of `inputs/flyer.json` in the
updated-Lagrangian and in the total-Lagrangian frame, and prints the median and the 95 % quantile of
E1, plateau, noise, overshoot and second plateau of two profiles of each impact. Plateaus shorter
than 20 cells are not counted. The flyer is the plate with the higher impedance.

    scripts/random_impacts.py target/release/flyer-mpm --count 60 --set heat_mixing='{"coefficient": 10}'
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

# density [kg/m3], c0 [m/s], s, gamma0
MATERIALS = {
    "silver": (10490, 3229, 1.595, 2.38), "beryllium": (1851, 7998, 1.124, 1.16),
    "bismuth": (9836, 1826, 1.473, 1.10), "cadmium": (8639, 2434, 1.684, 2.27),
    "cobalt": (8820, 4752, 1.315, 1.97), "chromium": (7117, 5173, 1.473, 1.42),
    "indium": (7279, 2419, 1.536, 1.80), "magnesium": (1740, 4492, 1.263, 1.42),
    "molybdenum": (10206, 5124, 1.233, 1.52), "niobium": (8586, 4438, 1.207, 1.47),
    "palladium": (11991, 3948, 1.588, 2.26), "platinum": (21419, 3598, 1.544, 2.40),
    "tin": (7287, 2608, 1.486, 2.11), "thorium": (11680, 2133, 1.263, 1.26),
    "uranium": (18950, 2487, 2.200, 1.56), "vanadium": (6100, 5077, 1.201, 1.29),
    "zinc": (7138, 3005, 1.581, 1.96), "zirconium": (6505, 3757, 1.018, 1.09),
    "brass": (8450, 3726, 1.434, 2.04), "teflon": (2153, 1841, 1.707, 0.59),
    "polystyrene": (1044, 2746, 1.319, 1.18), "polyethylene": (915, 2901, 1.481, 1.64),
    "epoxy": (1186, 2730, 1.493, 1.13), "polycarbonate": (1193, 1933, 1.420, 0.61),
}
CELL = 1e-5
SEED = 7


def impacts(count):
    """Flyer, target, speed [m/s] and cells of the flyer."""
    draw = random.Random(SEED)
    for _ in range(count):
        pair = [draw.choice(sorted(MATERIALS)) for _ in range(2)]
        flyer, target = sorted(pair, key=lambda name: -MATERIALS[name][0] * MATERIALS[name][1])
        speed = math.exp(draw.uniform(math.log(200), math.log(4000)))
        yield flyer, target, round(speed), draw.randint(15, 120)


def plateau_cells(flyer, target, speed, thickness, time):
    """Length of the target's plateau behind the shock [cells]."""
    hugoniot = lambda m, u: m[0] * (m[1] + m[2] * u) * u
    low, high = 0.0, speed
    for _ in range(100):
        u = 0.5 * (low + high)
        low, high = (u, high) if hugoniot(target, u) < hugoniot(flyer, speed - u) else (low, u)

    def wave(m, u):
        """Lagrangian speeds of the shock and of the head of the fan behind it."""
        rho, c0, s, gamma = m
        shock, p = c0 + s * u, hugoniot(m, u)
        chi = u / shock
        slope = rho * c0**2 * (
            (1 + s * chi) / (1 - s * chi) ** 3 * (1 - gamma * chi / 2)
            - gamma * chi / (2 * (1 - s * chi) ** 2)
        )
        return shock, math.sqrt((slope + gamma * p) / rho)

    shock, head = wave(target, u)
    in_flyer = wave(flyer, speed - u)
    arrival = thickness / in_flyer[0] + thickness / in_flyer[1]
    length = shock * time - head * max(0.0, time - arrival)
    return max(0.0, length) * (1 - u / shock) / CELL


def scene(impact, frame, changes):
    flyer, target, speed, cells = impact
    root = Path(__file__).resolve().parent.parent
    made = json.loads((root / "inputs/flyer.json").read_text())
    thickness, length = cells * CELL, 8 * cells * CELL + 1e-3
    _, c0, s, _ = MATERIALS[target]
    end = 0.9 * length / (c0 + s * speed)
    margin = math.ceil(1.2 * speed * end / CELL) * CELL + 4e-4
    made["domain"] = {"lower": [-thickness - margin], "upper": [length + margin], "cell_size": CELL}
    made["time"]["end"] = end
    made["method"].pop("frame", None)
    if frame == "total_lagrangian":
        made["method"]["frame"] = frame
    made["materials"] = {
        name: {"density": rho, "eos": {"type": "mie_gruneisen", "c0": c, "s": s, "gamma0": g}}
        for name, (rho, c, s, g) in MATERIALS.items() if name in (flyer, target)
    }
    for body, material, ends, velocity in [
        (made["bodies"][0], flyer, (-thickness, 0.0), speed),
        (made["bodies"][1], target, (0.0, length), 0.0),
    ]:
        body.update(material=material, velocity=[velocity],
                    box={"lower": [ends[0]], "upper": [ends[1]]})
    made["output"] = {"profiles": {"times": [0.5 * end, end]}, "pictures": False}
    made.update(changes)
    return made


def quantile(values, share):
    values = sorted(values)
    return values[max(0, math.ceil(share * len(values)) - 1)] if values else math.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="key at the top of the scenes, with a JSON value")
    parser.add_argument("--method", action="append", default=[], metavar="KEY=VALUE",
                        help="key of the method, with a JSON value")
    arguments = parser.parse_args()
    split = lambda texts: {k: json.loads(v) for k, v in (text.split("=", 1) for text in texts)}
    changes, method = split(arguments.set), split(arguments.method)
    program = arguments.program.resolve()
    with tempfile.TemporaryDirectory() as folder:
        for frame in ("updated_lagrangian", "total_lagrangian"):
            found = {name: [] for name in ("e1_cells", "plateau", "noise", "overshoot", "second_plateau")}
            failed = 0
            for impact in impacts(arguments.count):
                made = scene(impact, frame, changes)
                made["method"].update(method)
                path = Path(folder) / "scene.json"
                path.write_text(json.dumps(made))
                out = Path(folder) / "results"
                run = subprocess.run([program, path, "--output", out, "--quiet"], cwd=folder,
                                     capture_output=True, text=True)
                if run.returncode:
                    failed += 1
                    print(f"{impact}: {run.stderr.strip()[:200]}", file=sys.stderr)
                    continue
                flyer, target, speed, cells = impact
                for profile in json.loads((out / "summary.json").read_text())["profiles"]:
                    errors = profile["errors"]
                    length = plateau_cells(MATERIALS[flyer], MATERIALS[target], speed, cells * CELL,
                                           profile["time"])
                    for name, values in found.items():
                        of_plateau = name in ("plateau", "noise")
                        if errors.get(name) is not None and not (of_plateau and length < 20):
                            values.append(abs(errors[name]) * (1 if name == "e1_cells" else 100))
            print(f"{frame}: {failed} failed")
            for name, values in found.items():
                unit = "cells" if name == "e1_cells" else "%"
                print(f"  {name:14} median {quantile(values, 0.5):.4f}, 95 % "
                      f"{quantile(values, 0.95):.4f}, largest {max(values, default=math.nan):.4f} {unit} "
                      f"({len(values)} profiles)", flush=True)


if __name__ == "__main__":
    main()
