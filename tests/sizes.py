"""What the project weighs, by part: `python -m tests.sizes [REVISION ...]`, a table for each revision of
git.

Lines and characters of .py, .toml, .json, .j2 and of the prose of findings; the share of lines above 100
columns; statements of Python without docstrings.
"""

import ast
import subprocess
import sys
from collections import Counter
from pathlib import Path

KINDS = (".py", ".toml", ".json", ".j2")
PARTS = ("sam", "fem_reference", "samfem", "verification", "tests", "docs")
COMMAND = ("verification/app/", "samfem.py")  # where samfem/ was
WIDE = 100


def part_of(path: str) -> str:
    """The part that a file counts for; empty for one that does not."""
    counts = path.endswith(KINDS) or path.endswith("findings.md")
    if not counts or path.startswith("reports/") or (path.endswith(".json") and not path.startswith(PARTS)):
        return ""
    if path.startswith(COMMAND):
        return "samfem"
    part = path.split("/")[0]
    if part in ("verification", "tests"):
        return part if path.endswith(".py") else f"{part}: .toml, .json, .j2, findings"
    return part if part in PARTS else "project files"


def statements(text: str) -> int:
    """Statements that are no docstrings."""
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.stmt)]
    return sum(not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)) for node in nodes)


def sizes(revision: str) -> dict[str, Counter]:
    """Part -> lines, characters, wide lines, statements and files of a revision."""
    listed = subprocess.run(
        ["git", "ls-tree", "-r", "--name-only", revision], capture_output=True, text=True, check=True
    )
    found: dict[str, Counter] = {}
    for path in listed.stdout.splitlines():
        if not (part := part_of(path)):
            continue
        shown = subprocess.run(["git", "show", f"{revision}:{path}"], capture_output=True, check=True)
        text = shown.stdout.decode()
        lines = text.splitlines()
        counted = Counter(files=1, lines=len(lines), characters=len(text))
        counted["wide"] = sum(len(line) > WIDE for line in lines)
        counted["statements"] = statements(text) if Path(path).suffix == ".py" else 0
        found.setdefault(part, Counter()).update(counted)
    found["sum"] = sum(found.values(), Counter())
    return found


if __name__ == "__main__":
    for name in sys.argv[1:] or ["HEAD"]:
        print(f"{name:48}{'files':>8}{'lines':>9}{'characters':>12}{'> 100':>8}{'statements':>12}")
        for one, of in sorted(sizes(name).items(), key=lambda item: item[0] == "sum"):
            share = f"{1e2 * of['wide'] / max(of['lines'], 1):.1f} %"
            print(
                f"{one:48}{of['files']:8}{of['lines']:9}{of['characters']:12}{share:>8}{of['statements']:12}"
            )
