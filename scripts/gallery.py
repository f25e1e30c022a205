#!/usr/bin/env python3
"""Writes docs/gallery.md and docs/gallery/: one picture for each scene of inputs/ and inputs/hard/.

    cargo build --release && scripts/gallery.py [--reuse] [NAME...]

Each scene is run with its own settings, and the picture is one that the program has drawn, with fewer
pixels and colours. An animated PNG shows the frames of one scene. `--reuse` takes results in
target/gallery that are there already; names choose scenes. Needs numpy, h5py, matplotlib and Pillow.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = Path(os.environ.get("FLYER_MPM", TARGET / "release" / "flyer-mpm"))
RUNS = TARGET / "gallery"
PAGE = ROOT / "docs" / "gallery.md"
PICTURES = ROOT / "docs" / "gallery"

# greatest size of a picture [bytes], and its greatest width and height [pixels]
LARGEST, WIDTH, HEIGHT = 60_000, 640, 560

# the picture that shows most of a scene, where it is neither the x-t diagram nor the pressure in a plane
CHOSEN = {
    "disks": "speed",
    "free_slide": "speed",
    "gresho": "speed",
    "noh_axis": "density",
    "noh_cylindrical": "density",
    "quarter": "speed",
    "shear_layer": "speed",
    "sliding_block": "speed",
    "sod_2d": "density",
    "spinning_disk": "speed",
    "vortex": "speed",
}

# a quantity of the profiles, drawn by this script where no picture of the program shows the scene
PROFILES = {"heat_rod": "temperature"}

# the scene of the animation, and the number of its frames
ANIMATED, FRAMES = "disks", 24

HEAD = """# Gallery

One picture for each scene of `inputs/` and `inputs/hard/`, as the program draws it. `scripts/gallery.py` runs the
scenes and writes this page. The command below each picture makes it.
"""


def scenes():
    """Paths of all shipped scenes."""
    return sorted(ROOT.glob("inputs/*.json")) + sorted(ROOT.glob("inputs/hard/*.json"))


def run(scene, reuse):
    """Runs a scene; returns the folder of its results."""
    folder = RUNS / scene.stem
    if not (reuse and (folder / "summary.json").exists()):
        command = [PROGRAM, scene.relative_to(ROOT), "--output", folder, "--quiet"]
        subprocess.run(command, cwd=ROOT, check=True)
    return folder


def picture(name, folder):
    """The picture of a scene: the latest one of the chosen kind."""
    for stem in [CHOSEN.get(name, ""), "x_t_diagram", "pressure", "figure_4", "profile"]:
        found = sorted(folder.glob(f"{stem}*.png"), key=lambda path: path.stat().st_mtime) if stem else []
        if found:
            return found[-1]
    raise FileNotFoundError(f"{folder}: no picture; output.pictures is off")


def shrink(source, target):
    """Writes a picture with fewer pixels, and as many colours as the size allows."""
    image = Image.open(source).convert("RGB")
    image.thumbnail((WIDTH, HEIGHT), Image.LANCZOS)
    for colors in [256, 128, 64, 48, 32, 24, 16]:
        small = image.quantize(colors, dither=Image.Dither.NONE)
        small.save(target, optimize=True)
        if target.stat().st_size <= LARGEST:
            return
    raise ValueError(f"{target}: {target.stat().st_size} bytes with 16 colours")


def draw_profiles(quantity, folder):
    """Draws a quantity of all profiles on a line over the position; returns the picture."""
    import flyer_mpm
    from matplotlib import pyplot

    results = flyer_mpm.open(folder)
    figure, axis = pyplot.subplots(figsize=(6.4, 3.6))
    for time in results.times:
        profile = results.profile(time)
        axis.plot(profile["x"], profile[quantity], label=f"t = {time:g} s")
    axis.set_xlabel("Position (m)")
    axis.set_ylabel(f"{quantity.capitalize()} ({results.frames[0].unit(quantity)})")
    axis.set_title(results.summary["title"], loc="left", weight="bold")
    axis.legend()
    figure.savefig(folder / f"{quantity}.png", bbox_inches="tight")
    return folder / f"{quantity}.png"


def entry(scene, folder):
    """The section of a scene."""
    summary = json.loads((folder / "summary.json").read_text())
    place = scene.relative_to(ROOT)
    text = summary["scene"].get("description", "").strip()
    facts = f"{summary['particles']} particles, {summary['steps']} steps"
    return (
        f"## {scene.stem}\n\n{summary['title']}. {text}\n\n"
        f"![{summary['title']}](gallery/{scene.stem}.png)\n\n"
        f"`flyer-mpm {place}`: {facts}.\n"
    )


def animate(scene, reuse):
    """Writes an animated PNG of the speed of a scene in a plane."""
    import flyer_mpm
    import numpy

    folder = RUNS / f"{scene.stem}_frames"
    if not (reuse and (folder / "summary.json").exists()):
        end = json.loads((RUNS / scene.stem / "summary.json").read_text())["scene"]["time"]["end"]
        fields = json.dumps({"every": end / FRAMES, "quantities": ["velocity"]})
        command = [PROGRAM, scene.relative_to(ROOT), "--output", folder, "--quiet"]
        changes = ["--set", f"output.fields={fields}", "--set", "output.pictures=false"]
        subprocess.run([*command, *changes], cwd=ROOT, check=True)
    frames = list(flyer_mpm.open(folder).frames)
    speeds = [numpy.hypot(*frame["velocity"][:, :2].T) for frame in frames]
    greatest = max(speed.max() for speed in speeds)
    points = numpy.concatenate([frame.points[:, :2] for frame in frames])
    lower, upper = points.min(axis=0), points.max(axis=0)
    scale = 300 / (upper - lower).max()
    size = tuple(int(round(side)) + 20 for side in (upper - lower) * scale)
    images = []
    for frame, speed in zip(frames, speeds):
        image = Image.new("RGB", size, "white")
        draw = ImageDraw.Draw(image)
        for (x, y), value in zip((frame.points[:, :2] - lower) * scale, speed / greatest):
            color = (int(40 + 215 * value), int(70 + 110 * value), int(150 - 110 * value))
            draw.rectangle([x + 9, size[1] - y - 11, x + 11, size[1] - y - 9], fill=color)
        draw.text((10, 4), f"t = {frame.time:.3g} s", fill="black")
        images.append(image.quantize(16, dither=Image.Dither.NONE))
    target = PICTURES / f"{scene.stem}_animation.png"
    images[0].save(target, save_all=True, append_images=images[1:], duration=120, loop=0)
    if target.stat().st_size > 4 * LARGEST:
        raise ValueError(f"{target}: {target.stat().st_size} bytes")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--reuse", action="store_true", help="take earlier results")
    arguments.add_argument("names", nargs="*", help="scenes; default all, and the page is written")
    given = arguments.parse_args()
    PICTURES.mkdir(exist_ok=True)
    parts = [HEAD]
    for scene in scenes():
        if given.names and scene.stem not in given.names:
            continue
        folder = run(scene, given.reuse)
        if scene.stem in PROFILES:
            drawn = draw_profiles(PROFILES[scene.stem], folder)
        else:
            drawn = picture(scene.stem, folder)
        shrink(drawn, PICTURES / f"{scene.stem}.png")
        parts.append(entry(scene, folder))
        if scene.stem == ANIMATED:
            animate(scene, given.reuse)
            text = "The speed of the particles over time, as an animated PNG."
            parts.append(f"{text}\n\n![{text}](gallery/{scene.stem}_animation.png)\n")
    if not given.names:
        PAGE.write_text("\n".join(parts))


if __name__ == "__main__":
    main()
