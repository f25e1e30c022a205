#!/usr/bin/env python3
"""Executes the commands of the guide, and compares what they print with the pages.

    cargo build --release && scripts/guide.py [--write] [PAGE...]

Commands stand behind `$ ` in blocks ```console of docs/*.md; those of a page run one after the other in
an empty folder. Times and the speed depend on the machine and are written as `T`. `--write` puts the
present output into the pages. Of all other blocks of the pages and of README.md, the commands and
options of the program are looked up in its help.
"""

import argparse
import difflib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = Path(os.environ.get("FLYER_MPM", TARGET / "release" / "flyer-mpm"))
BLOCK = re.compile(r"```console\n(.*?)```", re.DOTALL)
ANY_BLOCK = re.compile(r"```\w*\n(.*?)```", re.DOTALL)


def masked(text):
    """The text without what depends on the machine."""
    text = re.sub(r"(rank|thread)(s?): \S+ s$", r"\1\2: T s", text, flags=re.MULTILINE)
    text = re.sub(r"[\d.]+ M particle-steps", "T M particle-steps", text)
    # digits of rounding errors
    return re.sub(r"(energy|momentum) (\d(\.\d+)?e-1\d|0\.0e0)", r"\1 1e-1x", text)


def environment(folder):
    """The program as `flyer-mpm` on the search path, and Open MPI on few cores and as root."""
    tools = Path(folder) / ".bin"
    tools.mkdir()
    (tools / "flyer-mpm").symlink_to(PROGRAM)
    mpi = {
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_hwloc_base_binding_policy": "none",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    }
    path = f"{tools}{os.pathsep}{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, **mpi, "PATH": path, "PYTHONPATH": str(ROOT / "python"), "INPUTS": str(ROOT / "inputs")}


def execute(block, folder, variables):
    """The block with the present output of its commands."""
    lines, made = block.splitlines(), []
    while lines:
        line = lines.pop(0)
        if not line.startswith("$ "):
            continue
        made.append(line)
        command = line[2:]
        while command.endswith("\\"):
            made.append(lines.pop(0))
            command = command[:-1] + made[-1]
        ended = subprocess.run(
            ["bash", "-c", command], cwd=folder, env=variables, text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )
        if ended.returncode != 0:
            raise SystemExit(f"{command}: exit code {ended.returncode}\n{ended.stdout}")
        made += masked(ended.stdout).splitlines()
    return "\n".join(made) + "\n"


def run_page(page, write):
    """Executes a page; returns the number of its blocks."""
    text = page.read_text()
    count = len(BLOCK.findall(text))
    if count == 0:
        return 0
    with tempfile.TemporaryDirectory() as folder:
        variables = environment(folder)
        present = BLOCK.sub(lambda found: f"```console\n{execute(found[1], folder, variables)}```", text)
    if write:
        page.write_text(present)
    elif present != text:
        names = {"fromfile": str(page), "tofile": "present output", "lineterm": ""}
        raise SystemExit("\n".join(difflib.unified_diff(text.splitlines(), present.splitlines(), **names)))
    return count


def help_of(command):
    """The help of a command of the program; empty if there is no such command."""
    ended = subprocess.run([PROGRAM, *command, "--help"], text=True, capture_output=True)
    return ended.stdout if ended.returncode == 0 else ""


def check_options(pages):
    """Looks up the commands and options in the blocks of the pages; returns their number."""
    helps, count = {}, 0
    for page in pages:
        for block in ANY_BLOCK.findall(page.read_text()):
            for call in re.findall(r"(?:^|[ /])flyer-mpm (?!is |writes )([^#\n|;]*)", block):
                words = call.split()
                command = []
                for word in words[:2]:
                    known = re.fullmatch(r"[a-z]+", word) and help_of([*command, word])
                    if not known or word == "help":
                        break
                    command.append(word)
                text = helps.setdefault(tuple(command), help_of(command))
                for option in re.findall(r"--[a-z-]+", call):
                    if option not in text:
                        raise SystemExit(f"{page}: flyer-mpm {call}: no option {option}")
                    count += 1
    return count


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--write", action="store_true", help="put the output into the pages")
    arguments.add_argument("pages", nargs="*", type=Path, help="default: all pages of docs/")
    given = arguments.parse_args()
    pages = given.pages or sorted((ROOT / "docs").glob("*.md"))
    blocks = sum(run_page(page, given.write) for page in pages if page.name != "terminal.md")
    options = check_options([*pages, ROOT / "README.md"])
    print(f"{blocks} blocks of commands executed, {options} options looked up")


if __name__ == "__main__":
    main()
