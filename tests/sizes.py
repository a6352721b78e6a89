"""What the project weighs: `python -m tests.sizes [REVISION ...]`, a table by part for each revision of git.

Files and lines of .py, .toml, .json, .j2 and the prose of findings; statements of Python without docstrings.
"""

import ast
import subprocess
import sys
from collections import Counter

KINDS = (".py", ".toml", ".json", ".j2")
PARTS = ("sam", "fem_reference", "samfem", "verification", "tests", "docs")


def part_of(path: str) -> str:
    """The part that a file counts for; empty for one that does not."""
    counts = path.endswith((*KINDS, "findings.md")) and not path.startswith("reports/")
    part = path.split("/")[0]
    if not counts or part not in PARTS:
        return "project files" if counts and not path.endswith(".json") else ""
    return part if part not in ("verification", "tests") or path.endswith(".py") else f"{part}: tables"


def git(*words: str) -> str:
    return subprocess.run(["git", *words], capture_output=True, check=True).stdout.decode()


def sizes(revision: str) -> dict[str, Counter]:
    """Part -> files, lines and statements of a revision."""
    found: dict[str, Counter] = {}
    for path in filter(part_of, git("ls-tree", "-r", "--name-only", revision).splitlines()):
        text = git("show", f"{revision}:{path}")
        nodes = (
            [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.stmt)] if path.endswith(".py") else []
        )
        texts = [isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant) for n in nodes]
        own = Counter(files=1, lines=len(text.splitlines()), statements=len(nodes) - sum(texts))
        found.setdefault(part_of(path), Counter()).update(own)
    return found | {"sum": sum(found.values(), Counter())}


if __name__ == "__main__":
    for name in sys.argv[1:] or ["HEAD"]:
        print(f"{name:24}{'files':>8}{'lines':>9}{'statements':>12}")
        for one, of in sizes(name).items():
            print(f"{one:24}{of['files']:8}{of['lines']:9}{of['statements']:12}")
