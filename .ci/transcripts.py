#!/usr/bin/env python3
"""Runs every transcript of the README and the manual, and compares it with what is printed there.

    .ci/transcripts.py PROGRAM            exits with 1 and shows the differences if a page is not what PROGRAM prints
    .ci/transcripts.py PROGRAM --write    puts what PROGRAM prints into the pages
    … --only docs/sweep.md                these pages only

A transcript is a block marked ```console whose first line is "$ command". All of a page's commands run in one scratch
directory that holds copies of reports/ and distributions/. Comments in front of a block steer it:

    <!-- before: command -->              a command to run first; it is not shown
    <!-- shown: /from/../to/ ; /from/+2 -->   the parts of the output that are shown, the rest is "…": from the first line that
                                          matches /from/ (after the part before) to the next that matches /to/, or so many more
"""
import difflib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"((?:<!-- (?:before|shown): .*? -->\n)*)```console\n\$ (.*?)\n(.*?)```\n", re.S)
COMMENT = re.compile(r"<!-- (before|shown): (.*?) -->\n", re.S)


def run(command: str, place: Path, program: Path) -> list[str]:
    """The lines that a command prints."""
    tools = place / ".tools"
    tools.mkdir(exist_ok=True)
    link = tools / "reeldown"
    if not link.exists():
        link.symlink_to(program)
    environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "NO_COLOR": "1", "COLUMNS": "100"}
    command = command.replace("cargo run --release --", "reeldown").replace("cargo run --release", "reeldown")
    done = subprocess.run(["bash", "-c", command], cwd=place, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False)
    if done.returncode in (1, 2, 101) and "error:" not in done.stdout:
        raise SystemExit(f"`{command}` ended with {done.returncode}:\n{done.stdout}")
    lines = [line.rstrip() for line in done.stdout.rstrip("\n").split("\n")]
    while lines and not lines[0]:
        lines.pop(0)
    return lines


def part(lines: list[str], wanted: str) -> list[str]:
    """The parts of an output that a page shows."""
    shown: list[str] = []
    at = 0
    for piece in (piece.strip() for piece in wanted.split(" ; ")):
        match = re.fullmatch(r"/(.*?)/(?:\+(\d+)|\.\./(.*)/)?", piece)
        if not match:
            raise SystemExit(f"cannot read the part {piece!r}")
        begin, count, end = match.groups()
        start = next((k for k in range(at, len(lines)) if re.search(begin, lines[k])), None)
        if start is None:
            raise SystemExit(f"no line matches /{begin}/ in\n" + "\n".join(lines))
        if end is not None:
            stop = next((k for k in range(start, len(lines)) if re.search(end, lines[k])), None)
            if stop is None:
                raise SystemExit(f"no line matches /{end}/ after /{begin}/ in\n" + "\n".join(lines))
        else:
            stop = start + int(count or 0)
        if start > at:
            shown.append("…")
        shown += lines[start:stop + 1]
        at = stop + 1
    if at < len(lines):
        shown.append("…")
    return shown


def page(path: Path, program: Path) -> str:
    """A page with its transcripts as the program prints them."""
    with tempfile.TemporaryDirectory(prefix="transcripts-") as scratch:
        place = Path(scratch)
        for name in ("reports", "distributions"):
            shutil.copytree(ROOT / name, place / name)

        def again(block: re.Match) -> str:
            comments, command, _ = block.groups()
            wanted = None
            for kind, text in COMMENT.findall(comments):
                if kind == "before":
                    run(text, place, program)
                else:
                    wanted = text
            lines = run(command, place, program)
            lines = part(lines, wanted) if wanted else lines
            return f"{comments}```console\n$ {command}\n" + "\n".join(lines) + "\n```\n"

        return BLOCK.sub(again, path.read_text())


def main() -> None:
    arguments = sys.argv[1:]
    if not arguments or arguments[0].startswith("-"):
        raise SystemExit(__doc__)
    program = Path(arguments.pop(0)).resolve()
    write = "--write" in arguments
    only = arguments[arguments.index("--only") + 1:] if "--only" in arguments else None
    pages = [Path(p).resolve() for p in only] if only else [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    stale = 0
    for path in pages:
        before = path.read_text()
        after = page(path, program)
        count = len(BLOCK.findall(before))
        if before == after:
            print(f"{path.relative_to(ROOT)}: {count} transcripts, as printed")
        elif write:
            path.write_text(after)
            print(f"{path.relative_to(ROOT)}: written anew")
        else:
            stale += 1
            sys.stdout.writelines(difflib.unified_diff(before.splitlines(True), after.splitlines(True),
                                                       f"{path.relative_to(ROOT)}", "what the program prints"))
    if stale:
        raise SystemExit(f"{stale} pages are stale: .ci/transcripts.py PROGRAM --write")


if __name__ == "__main__":
    main()
