#!/usr/bin/env python3
"""Checks that each member that the pages of the API call "works" is called by a test.

usage: api_page.py TESTS PAGE...

TESTS: the folder of tests. Of a row whose second cell says "works", each name of the first cell must be an identifier in
a test's source, outside of comments and texts. A name that ends with ... stands for all that begin so, and needs one; a
name with a capital letter may be a part of an identifier.
"""

import re
import sys
from pathlib import Path

NAME = re.compile(r"[A-Za-z_]\w*(?:\.\.\.)?")
KINDS_OF_WORDS = {"T", "name", "id", "index", "text", "void"}  # of arguments and types, not of members


def identifiers(tests):
    found = set()
    for file in [*tests.glob("controllers/*.cpp"), *tests.glob("harness/controllers/*.cpp"),
                 *tests.glob("harness/session/*.cpp")]:
        text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", file.read_text(encoding="utf-8"), flags=re.S)
        text = re.sub(r'R"\((.*?)\)"|"(\\.|[^"\\\n])*"', " ", text, flags=re.S)
        found.update(re.findall(r"[A-Za-z_]\w*", text))
    return found


def names_that_work(page):
    for line in page.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.split(" | ")]
        if len(cells) < 2 or not cells[0].startswith("| ") or not cells[1].startswith("works"):
            continue
        for code in re.findall(r"`([^`]*)`", cells[0]):
            for part in re.sub(r"\([^)]*\)|<[^>]*>", " ", code).replace("\\|", " ").split():
                for name in NAME.findall(part.rsplit("::", 1)[-1] if not part.endswith("::") else ""):
                    if name not in KINDS_OF_WORDS:
                        yield name, line


def main():
    known = identifiers(Path(sys.argv[1]))
    count, missing = 0, []
    for page in map(Path, sys.argv[2:]):
        for name, line in names_that_work(page):
            count += 1
            begin = name.removesuffix("...")
            if begin != name:
                is_called = any(word.startswith(begin) for word in known)
            else:  # a part of names, as Warning of putWarning, has a capital letter
                is_called = name in known or (name[0].isupper() and any(name in word for word in known))
            if not is_called:
                missing.append(f"{page.name}: no test calls {name}, which works in: {line[:100]}")
    print(f"{count - len(missing)} of {count} members that work are called by a test")
    print("\n".join(missing))
    return 1 if missing or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
