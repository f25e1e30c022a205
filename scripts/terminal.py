#!/usr/bin/env python3
"""Writes docs/terminal.md: what the program prints for six scenes.

    cargo build --release && scripts/terminal.py

Times depend on the machine and are replaced by `T s`; everything else has the same digits on every
machine and build. A test (tests/contract/terminal.rs) compares the shock tube.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "flyer-mpm"

# heading, template or scene of inputs/, what there is to see, arguments
SCENES = [
    ("Plate impact", "plate_impact", "An impact on a line, with its exact solution.", []),
    ("Spall", "spall", "Particles fail in tension.", []),
    ("Shock tube", "shock_tube", "Two gases with an exact solution.", []),
    ("Taylor bar", "taylor_bar", "A rod that strikes a wall, in axial symmetry.", []),
    (
        "Plate of finite width",
        "flyer_2d",
        "An impact in a plane, with the exact solution of its middle, on coarse cells.",
        ["--set", "domain.cell_size=4e-5"],
    ),
    ("Sphere", "sphere", "A scene in a plane without an exact solution.", []),
]

HEAD = """# Terminal output

The lines that a run prints, for five templates of `flyer-mpm new` and a scene of `inputs/`. The
[glossary](glossary.md) explains the labels. `scripts/terminal.py` writes this page, with `T s` in place of times.
"""


def masked(text):
    """The text without times of this machine."""
    return re.sub(r"(rank|thread)(s?): \S+ s$", r"\1\2: T s", text, flags=re.MULTILINE)


def printed(name, arguments, folder):
    """What a run of a scene prints, warnings included."""
    if (ROOT / "inputs" / "templates" / f"{name}.json").exists():
        subprocess.run([PROGRAM, "new", name], cwd=folder, check=True, capture_output=True)
    else:
        shutil.copy(ROOT / "inputs" / f"{name}.json", folder)
    command = [PROGRAM, f"{name}.json", *arguments, "--progress", "never"]
    run = subprocess.run(
        command, cwd=folder, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    return masked(run.stdout)


def main():
    parts = [HEAD]
    with tempfile.TemporaryDirectory() as folder:
        for heading, name, what, arguments in SCENES:
            text = printed(name, arguments, folder)
            command = " ".join([f"{name}.json", *arguments])
            block = f"```text\n$ flyer-mpm {command}\n{text}```"
            parts.append(f"## {heading}\n\n{what}\n\n{block}\n")
    (ROOT / "docs" / "terminal.md").write_text("\n".join(parts))


if __name__ == "__main__":
    main()
