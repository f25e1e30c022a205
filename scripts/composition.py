#!/usr/bin/env python3
"""Measure how many files of src an addition or a removal touches, and that the program compiles.

    scripts/composition.py            compile only
    scripts/composition.py --test     also run the unit tests of what remains after each removal

Works on a copy of the committed tree in a temporary folder. Each addition is a copy of an existing
model under another name, in a file of its own, and a line in the list of its kind. Prints one line
per change; exit code 1 if one touches more files than allowed or does not compile.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

# the unit tests need no speed
UNOPTIMIZED = "profile.release.package.flyer-mpm.opt-level=0"

ROOT = pathlib.Path(__file__).resolve().parent.parent

# kind: greatest number of files, file to copy, its new name, words to rename, list, line to copy
ADDITIONS = {
    "equation of state": (2, "material/eos/vinet.rs", "copied", [("Vinet", "Copied")],
                          "material/eos/mod.rs", "    Vinet: vinet::VinetParameters,"),
    "strength": (2, "material/strength/zerilli_armstrong.rs", "copied", [("ZerilliArmstrong", "Copied")],
                 "material/strength/mod.rs", r"    zerilli_armstrong::ZerilliArmstrong,"),
    "failure": (2, "material/failure/cochran_banner.rs", "copied", [("CochranBanner", "Copied")],
                "material/failure/mod.rs", r"    CochranBanner: .*"),
    "shape function": (2, "shape/bspline_cubic.rs", "copied", [("BsplineCubic", "Copied")],
                       "shape/mod.rs", r"    /// Cubic B-splines .*\n    bspline_cubic::.*"),
    "transfer": (3, "transfer/pic.rs", "copied", [("Pic", "Copied")],
                 "transfer/mod.rs", r"    /// Takes the nodal velocity \(.*\n    pic::Pic,"),
    "side": (2, "side/outflow.rs", "copied", [("Outflow", "Copied")],
             "side/mod.rs", r"    /// Open: .*\n    outflow::Outflow,"),
    "contact law": (2, "contact/frictionless.rs", "copied", [("Frictionless", "Copied")],
                    "contact/mod.rs", r"    /// Each body has its own.*\n.*\n    frictionless::Frictionless,"),
    "effect with columns and nodal fields": (
        2, "effects/heat_mixing.rs", "copied",
        [("HeatMixing", "Copied"), ("heat_mixing", "copied"), ("mixing_", "copied_"),
         ("heat mixing", "copied")],
        "effects/mod.rs", r"    heat_mixing::HeatMixing,"),
    "rule of the balance": (2, "balance/particles.rs", "copied", [("Particles", "Copied")],
                            "balance/mod.rs", r"    /// Number of particles that.*\n    particles::Particles,"),
    "quantity of a plan": (2, "accuracy/plan/quantities/l1.rs", "copied", [("L1", "Copied")],
                           "scene/model/planned_quantity.rs", r"            /// Relative L1.*\n            l1::L1,"),
}

# a column of tables is declared where it is computed
PROFILE_QUANTITY = (1, "effects/heat_mixing.rs", '        d.scalar("mixing_energy"',
                    '        d.output("mixing_mass", "kg", "mixing_mass");\n')

# effect: line in the list
REMOVALS = {
    "heat_mixing": "    heat_mixing::HeatMixing,\n",
    "erosion": "    erosion::ErosionEffect,\n",
    "body_force": "    body_force::BodyForceEffect,\n",
    "pores": "    pores::Pores,\n",
}


def run(*command, where):
    return subprocess.run(command, cwd=where, text=True, capture_output=True, check=False)


def changed(tree):
    """Files of src that differ from the commit."""
    run("git", "add", "-A", where=tree)
    names = run("git", "diff", "--cached", "--name-only", where=tree).stdout.split()
    return [name for name in names if name.startswith("src/") and "/tests/" not in name]


def renamed(text, words):
    for old, new in words:
        text = text.replace(old, new)
    return text


def add(tree, copied, name, words, registry, pattern):
    source, target = tree / "src" / copied, tree / "src" / registry
    text = source.read_text().split("#[cfg(test)]")[0]
    (source.parent / f"{name}.rs").write_text(renamed(text, words))
    text = target.read_text()
    line = re.search(pattern, text).group(0)
    module = pathlib.Path(copied).stem
    copy = renamed(line, words).replace(f"{module}::", f"{name}::")
    target.write_text(text.replace(line, f"{line}\n{copy}", 1))


def main():
    ok = True

    def report(what, tree, most, *cargo):
        nonlocal ok
        files = changed(tree)
        failed = [args for args in cargo if run("cargo", *args, where=tree).returncode]
        good = len(files) <= most and not failed
        ok &= good
        detail = f"cargo {' '.join(failed[0])} fails" if failed else ", ".join(files)
        print(f"{what:45} {len(files)} of {most}  {'ok' if good else 'MISSED'}  {detail}", flush=True)
        run("git", "reset", "-q", "--hard", where=tree)

    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder) / "tree"
        run("git", "clone", "-q", str(ROOT), str(tree), where=ROOT)
        os.environ.setdefault("CARGO_TARGET_DIR", str(ROOT / "target"))
        check = ("check", "--quiet", "--lib", "--bins")
        for kind, (most, *change) in ADDITIONS.items():
            add(tree, *change)
            report(kind, tree, most, check)
        most, file, before, line = PROFILE_QUANTITY
        file = tree / "src" / file
        file.write_text(file.read_text().replace(before, line + before, 1))
        report("quantity of a profile", tree, most, check)
        for effect, line in REMOVALS.items():
            (tree / f"src/effects/{effect}.rs").unlink()
            registry = tree / "src/effects/mod.rs"
            registry.write_text(registry.read_text().replace(line, "", 1))
            tests = [("test", "--quiet", "--release", "--lib", "--config", UNOPTIMIZED)] if "--test" in sys.argv[1:] else []
            report(f"without {effect}", tree, 2, check, *tests)
    sys.exit(0 if ok else 1)


if __name__ == "__main__":
    main()
