#!/usr/bin/env python3
"""Whether two builds of the program compute the same: `tests/same.py BEFORE AFTER`, each a path to the program.

On the four fabrics: fit, compare, validate, check; a drape and a flag; a quick study. Every file is compared byte by byte
but for what may differ:

* seconds, versions (`schema`, `program`), the path of the output folder
* the column of seconds in a ranking; the study's text and plots over time (its CSV files are compared)
* words: a string with a space in it (JSON, CSV), everything but the numbers in texts, labels in SVG
* keys that were renamed: RENAMED, old to new
* the page, which holds the data of report.json

Prints every file that differs otherwise, and how many were compared; exit 1 if one differs."""

import csv, io, json, re, subprocess, sys, tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parent.parent
SETS = ["cotton-denim", "cotton-satin", "rayon-spandex-knit", "wool-cotton"]
RENAMED = {}
SECONDS = re.compile(r"seconds|peak_memory|saving")
NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
LAST_COLUMN = re.compile(r" *\S+$", re.MULTILINE)
TIMED = re.compile(r"error-time|parts|stages|study\.")
TIME = re.compile(r"[\d.]+ (?:s|ms|µs|min)\b|in [\d.]+ s|\d+ files?")


def commands(out):
    for name in SETS:
        data, fit = f"fixtures/{name}", out / f"fit-{name}"
        yield f"fit-{name}", ["fit", data, "--nodes", "13x13", "--out", fit]
        yield f"compare-{name}", ["compare", data, "--nodes", "9x9", "--out", out / f"compare-{name}"]
        yield f"validate-{name}", ["validate", data, "--material", fit / "material.json", "--out", out / f"validate-{name}"]
        yield f"check-{name}", ["check", fit / "material.json"]
    material = out / "fit-cotton-denim/material.json"
    for scene in ["drape", "flag"]:
        yield f"simulate-{scene}", ["simulate", f"fixtures/scenes/{scene}.toml", "--material", material, "--out", out / f"simulate-{scene}"]
    yield "study", ["study", "fixtures/cotton-denim", "--quick", "--out", out / "study"]


def run(program, out):
    out.mkdir()
    for name, arguments in commands(out):
        done = subprocess.run([program, *map(str, arguments)], cwd=ROOT, capture_output=True, text=True)
        (out / f"{name}.txt").write_text(f"exit {done.returncode}\n{done.stdout}")


def data(value, key=""):
    if isinstance(value, dict):
        timed = [i for i, name in enumerate(value.get("columns", [])) if SECONDS.search(str(name))]
        for row in value.get("rows", []) if timed else []:
            row[timed[0]] = "0"
        pairs = ((RENAMED.get(k, k), v) for k, v in value.items() if k not in ("schema", "program"))
        return {k: 0 if SECONDS.search(k) else data(v, k) for k, v in pairs}
    if isinstance(value, list):
        return [data(v, key) for v in value]
    return "words" if isinstance(value, str) and " " in value else value


def table(text):
    rows = list(csv.reader(io.StringIO(text)))
    header = [RENAMED.get(name, name) for name in rows[0]] if rows else []
    timed = [bool(SECONDS.search(name)) for name in header]
    cell = lambda value, i: "0" if i < len(timed) and timed[i] else "words" if " " in value else value
    return [header, *[[cell(value, i) for i, value in enumerate(row)] for row in rows[1:]]]


def compared(path):
    if TIMED.match(path.name) and path.suffix in (".txt", ".md", ".svg"):
        return None
    if path.suffix == ".json":
        return data(json.loads(path.read_text()))
    if path.suffix == ".csv":
        return table(path.read_text())
    if path.suffix in (".txt", ".md"):
        text = path.read_text()
        text = LAST_COLUMN.sub("", text) if text.split("\n")[1:2] and text.split("\n")[1].endswith("seconds") else text
        return NUMBER.findall(TIME.sub("", text))
    if path.suffix == ".svg":
        return re.sub(r">[^<]*<", "><", path.read_text())
    return None if path.suffix == ".html" else path.read_bytes()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        sides = [Path(folder) / "before", Path(folder) / "after"]
        with ThreadPoolExecutor() as pool:
            list(pool.map(run, map(str, map(Path.resolve, map(Path, sys.argv[1:]))), sides))
        names = sorted({p.relative_to(side) for side in sides for p in side.rglob("*") if p.is_file()})
        differ = 0
        for name in names:
            before, after = [compared(side / name) if (side / name).is_file() else "absent" for side in sides]
            if before != after:
                differ += 1
                print(f"differs: {name}")
                if isinstance(before, list) and isinstance(after, list):
                    print("   ", next(((a, b) for a, b in zip(before, after) if a != b), (len(before), len(after))))
        print(f"{len(names)} files compared, {differ} differ")
        sys.exit(differ > 0)


main()
