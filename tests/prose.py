#!/usr/bin/env python3
"""Counts the prose words of all tracked Markdown files and fails above a limit.

A word is a token with a letter or a digit. Fenced blocks do not count, nor does text between `<!-- generated -->` and
`<!-- /generated -->`: tables that a command of this repository prints.
"""

import re
import subprocess
import sys
from pathlib import Path

LIMIT = 20_000
# Written by a command from the first line to the last.
GENERATED = {"docs/study/study.md", "docs/stability/rows.md"}
OPEN, CLOSE = "<!-- generated -->", "<!-- /generated -->"


def words(path: Path) -> int:
    """The prose words of one file."""
    count, fence, generated = 0, "", False
    for line in path.read_text(encoding="utf-8").splitlines():
        text = line.strip()
        mark = re.match(r"`{3,}|~{3,}", text)
        if fence:
            if mark and text.startswith(fence) and not text.strip(fence[0]):
                fence = ""
        elif text in (OPEN, CLOSE):
            if generated == (text == OPEN):
                sys.exit(f"{path}: {text} without its partner")
            generated = text == OPEN
        elif mark:
            fence = mark.group()
        elif not generated:
            count += sum(any(c.isalnum() for c in token) for token in text.replace("|", " ").split())
    if fence or generated:
        sys.exit(f"{path}: a fenced block or generated text does not end")
    return count


def main() -> int:
    root = Path(__file__).resolve().parent.parent
    listed = subprocess.run(["git", "ls-files", "-z", "*.md"], cwd=root, check=True, capture_output=True, text=True)
    files = sorted(name for name in listed.stdout.split("\0") if name and name not in GENERATED)
    counts = {name: words(root / name) for name in files}
    total = sum(counts.values())
    for name, count in counts.items():
        print(f"{count:6} {name}")
    print(f"{total:6} of at most {LIMIT}")
    return int(total > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
