#!/usr/bin/env python3
"""Writes the tables and pictures of the cost of accuracy to docs/accuracy.md, from the results of
scripts/accuracy_cost.sh in output/studies/.

    scripts/accuracy_cost.sh && scripts/accuracy_cost.py [STUDY ...]

Without names it writes those of all studies. A table is the list of cheapest choices of a study, a
picture its curves of error against CPU time.
"""

import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STUDIES = ROOT / "output" / "studies"
PAGE = ROOT / "docs" / "accuracy.md"

# study, its picture, and the picture in docs/
PICTURES = [
    ("schemes", "cost_1us", "accuracy_cost"),
    ("impacts_cost", "cost", "accuracy_cost_impacts"),
    ("plane_vortex", "cost", "accuracy_cost_vortex"),
    ("plane_noh", "cost", "accuracy_cost_noh"),
    ("plane_disk", "cost", "accuracy_cost_disk"),
    ("plane_oblique", "cost", "accuracy_cost_oblique"),
    ("plane_flyer", "cost", "accuracy_cost_flyer_2d"),
    ("plane_sphere", "cost", "accuracy_cost_sphere"),
]


def with_table(text: str, study: str) -> str:
    """The page with the list of choices of a study between its marks."""
    begin, end = f"<!-- begin {study} -->\n", f"<!-- end {study} -->"
    table = (STUDIES / study / "choices.md").read_text()
    pattern = re.escape(begin) + ".*?" + re.escape(end)
    text, count = re.subn(pattern, lambda _: begin + table + end, text, flags=re.DOTALL)
    if count != 1:
        raise SystemExit(f"{PAGE.name}: no place for the table of {study}")
    return text


def main() -> None:
    known = [study for study, _, _ in PICTURES]
    wanted = sys.argv[1:] or known
    if unknown := [study for study in wanted if study not in known]:
        raise SystemExit(f"unknown study: {', '.join(unknown)}; allowed: {', '.join(known)}")
    text = PAGE.read_text()
    for study, picture, name in PICTURES:
        if study not in wanted:
            continue
        text = with_table(text, study)
        shutil.copyfile(STUDIES / study / f"{picture}.png", ROOT / "docs" / f"{name}.png")
    PAGE.write_text(text)


if __name__ == "__main__":
    main()
