"""Mutants of the sources, and which test catches each: the parts of scripts/mutants.sh.

A mutant is a text of a source file and what stands there instead. All are written into one copy
of the sources, each behind a question to the environment, so that one build serves all.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time

LIST = "tests/data/mutants.json"
TABLE = "docs/mutants.md"
CHOICE, REACHED = "FLYER_MPM_FAULT", "FLYER_MPM_FAULTS_REACHED"

# decomp holds the question, since both crates see it
QUESTION = """
/// Whether the sources are to behave as this mutant.
#[doc(hidden)]
#[inline]
pub fn mutant(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    let chosen = *CHOSEN.get_or_init(|| match std::env::var("%s") {
        Ok(number) => number.parse().expect("the number of a mutant"),
        Err(_) if std::env::var("%s").is_ok() => u32::MAX,
        Err(_) => u32::MAX - 1,
    });
    if chosen == u32::MAX {
        note(number);
    }
    chosen == number
}

#[cold]
fn note(number: u32) {
    use std::sync::atomic::{AtomicBool, Ordering};
    static SEEN: [AtomicBool; 1000] = [const { AtomicBool::new(false) }; 1000];
    if !SEEN[number as usize].swap(true, Ordering::Relaxed) {
        let path = std::env::var("%s").expect("it was there");
        let mut file = std::fs::File::options().create(true).append(true).open(path).expect("a log");
        std::io::Write::write_all(&mut file, format!("{number}\\n").as_bytes()).expect("room");
    }
}
""" % (CHOICE, REACHED, REACHED)


def mutants():
    with open(LIST, encoding="utf-8") as file:
        return json.load(file)


def place(mutant):
    """Where the text of a mutant begins and ends in its file, and that file's text."""
    with open(mutant["file"], encoding="utf-8") as file:
        text = file.read()
    before, marked, after = re.split("[«»]", mutant["find"])
    found = text.split(before + marked + after)
    if len(found) != 2:
        sys.exit(f"mutants: {len(found) - 1} places in {mutant['file']} read {mutant['find']!r}")
    start = len(found[0]) + len(before)
    return start, start + len(marked), text


def write(tree):
    """Writes all mutants into the copy of the sources in `tree`."""
    by_file = {}
    shared = "decomp/src/lib.rs"
    with open(shared, encoding="utf-8") as file:
        whole = file.read() + QUESTION
    with open(os.path.join(tree, shared), "w", encoding="utf-8") as file:
        file.write(whole)
    for number, mutant in enumerate(mutants()):
        by_file.setdefault(mutant["file"], []).append((*place(mutant), number, mutant["with"]))
    for path, places in by_file.items():
        crate = "crate" if path.startswith("decomp/") else "decomp"
        text = places[0][2]
        for start, end, _, number, other in sorted(places, reverse=True):
            guard = f"if {crate}::mutant({number})"
            own = text[start:end]
            # an expression may begin a statement, where braces would end it
            left, right = "{}" if own.endswith(";") else "()"
            text = f"{text[:start]}{left}{guard} {{ {other} }} else {{ {own} }}{right}{text[end:]}"
        with open(os.path.join(tree, path), "w", encoding="utf-8") as file:
            file.write(text)


def binaries(messages):
    """Test programs that cargo names: name, path, folder to run in."""
    found = []
    with open(messages, encoding="utf-8") as file:
        for line in file:
            message = json.loads(line) if line.startswith("{") else {}
            if message.get("executable") and message.get("profile", {}).get("test"):
                folder = os.path.dirname(message["manifest_path"])
                crate, target = os.path.basename(folder), message["target"]["name"]
                kind = "unit tests" if target in ("decomp", "flyer_mpm") else target
                name = f"decomp {kind}" if crate == "decomp" else kind
                if target != "flyer-mpm":
                    found.append({"name": name, "path": message["executable"], "folder": folder})
    return found


def run(binary, limit, *words, **environment):
    """Runs a test program, or its tests of these names, up to the first failure: what failed, or
    None; and the seconds taken."""
    start = time.monotonic()
    process = subprocess.Popen(
        [binary["path"], "--test-threads=2", *words],
        cwd=binary["folder"],
        env={**os.environ, "CARGO_MANIFEST_DIR": binary["folder"], **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        stdin=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    late = []

    def ring(*_):
        late.append(True)
        end(process)

    signal.signal(signal.SIGALRM, ring)
    signal.alarm(int(limit))
    failed, begun = None, set()
    for line in process.stdout:
        test = re.match(r"test (\S+)(?: - should panic)? \.\.\. (.*)", line)
        if test and "FAILED" in test[2]:
            failed = test[1]
            end(process)
            break
    process.stdout.close()
    code = process.wait()
    signal.alarm(0)
    if failed is None and late:
        failed = f"(no end within {int(limit)} s)"
    elif failed is None and code != 0:
        failed = f"(ended with {code})"
    return failed, time.monotonic() - start


def end(process):
    """Ends a test program and what it started: mpirun first ends its ranks itself."""
    for kind in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, kind)
        except ProcessLookupError:
            return
        time.sleep(0.2)


def reached(log):
    """The mutants that a log names; the log is removed."""
    if not os.path.exists(log):
        return []
    with open(log, encoding="utf-8") as file:
        lines = file.read().split()
    os.remove(log)
    return sorted(set(map(int, lines)))


def baseline(folder, found):
    """Runs all tests without a mutant; notes their times and the mutants that each reaches: of a
    program as a whole, and of each unit test, which are many and fast."""
    for binary in found:
        log = os.path.join(folder, f"reached-{binary['name'].replace(' ', '-')}")
        reached(log)
        failed, binary["seconds"] = run(binary, 1800, **{REACHED: log})
        if failed:
            sys.exit(f"mutants: {binary['name']}, {failed} fails without a mutant")
        binary["reaches"] = reached(log)
        if binary["name"].endswith("unit tests"):
            listed = [binary["path"], "--list", "--format=terse"]
            out = subprocess.run(listed, check=True, capture_output=True, text=True).stdout
            names = [line.removesuffix(": test") for line in out.splitlines()]
            binary["tests"] = {}
            for name in names:
                run(binary, 600, "--exact", name, **{REACHED: log})
                binary["tests"][name] = reached(log)
        print(f"{binary['name']}: {binary['seconds']:.0f} s, {len(binary['reaches'])} mutants", flush=True)


def try_all(folder, found, only):
    """Runs each mutant against the tests that reach it, fast ones first, until one fails."""
    path = os.path.join(folder, "results.json")
    results = json.load(open(path, encoding="utf-8")) if os.path.exists(path) else {}
    for number, mutant in enumerate(mutants()):
        if only and not any(word in mutant["what"] or word in mutant["file"] for word in only):
            continue
        # one that was interrupted goes on
        result = results.get(mutant["what"], {"test": None, "ran": []})
        if only:
            result = {"test": None, "ran": []}
        elif result["test"]:
            continue
        # tests that are known to look there
        for name, *words in (near.split() for near in mutant.get("near", [])):
            binary = next((b for b in found if b["name"] == name), None)
            if binary and not result["test"] and name not in result["ran"]:
                failed, _ = run(binary, 300, *words, **{CHOICE: str(number)})
                late = failed and failed.startswith("(no end")
                result["test"] = None if late else failed and f"{name}: {failed}"
        reaching = [b for b in found if number in b["reaches"] and b["name"] not in result["ran"]]
        for binary in [] if result["test"] else sorted(reaching, key=lambda b: b["seconds"]):
            limit, chosen = 60 + 2 * binary["seconds"], {CHOICE: str(number)}
            tests = [test for test, reaches in binary.get("tests", {}).items() if number in reaches]
            failed, _ = run(binary, limit, *(["--exact", *tests] if tests else []), **chosen)
            result["ran"].append(binary["name"])
            if failed:
                result["test"] = f"{binary['name']}: {failed}"
                break
        results[mutant["what"]] = result
        print(f"{number} {mutant['what']}: {result['test'] or 'SURVIVES ' + str(result['ran'])}", flush=True)
        with open(path + ".new", "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)
        os.replace(path + ".new", path)


def table(folder):
    """Writes the table of all results."""
    with open(os.path.join(folder, "results.json"), encoding="utf-8") as file:
        results = json.load(file)
    groups = {}
    for mutant in mutants():
        groups.setdefault(mutant["group"], []).append(mutant)
    caught = sum(bool(results.get(m["what"], {}).get("test")) for m in mutants())
    lines = [
        "# Mutants",
        "",
        "Faults that were put into the sources by hand, and the test that finds each. `scripts/mutants.sh` writes this page from",
        "`tests/data/mutants.json`. Test programs run from fast to slow, each up to its first failure, so that other tests may",
        "find a fault too.",
        "",
        f"{len(mutants())} mutants, {caught} caught; for those that survive, the reason is given.",
    ]
    for group, members in groups.items():
        lines += ["", f"## {group}", "", "| file | mutant | caught by |", "|---|---|---|"]
        for mutant in members:
            test = results.get(mutant["what"], {}).get("test")
            end = f"`{test}`" if test else f"survives: {mutant.get('why', 'not examined')}"
            lines.append(f"| `{mutant['file']}` | {mutant['what']} | {end} |")
    with open(TABLE, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def main():
    task, folder, *rest = sys.argv[1:]
    if task == "write":
        write(os.path.join(folder, "tree"))
    elif task == "table":
        table(folder)
    else:
        known = os.path.join(folder, "baseline.json")
        if task == "baseline":
            found = binaries(os.path.join(folder, "build.json"))
            if os.path.exists(os.path.join(folder, "results.json")):
                os.remove(os.path.join(folder, "results.json"))
            baseline(folder, found)
            with open(known, "w", encoding="utf-8") as file:
                json.dump(found, file)
        with open(known, encoding="utf-8") as file:
            try_all(folder, json.load(file), rest)


if __name__ == "__main__":
    main()
