#!/usr/bin/env python3
"""Prints the public names of Choreonoid's headers that Rehearse's headers of the same name lack, each with a reason.

usage: public_names.py CHECKOUT OURS REASONS [PAGE]

CHECKOUT: of Choreonoid. OURS: the folder of <cnoid/...>. REASONS: a line per rule, PATTERN: REASON, where PATTERN is a
regular expression of HEADER/CLASS::NAME; the first that matches counts. A missing name without a reason is a failure,
and so is a rule that matches nothing. PAGE: a page whose table between the marks must be the one that is printed.
"""

import re
import sys
from pathlib import Path

FOLDERS = ("src/Body", "src/Util", "src/BodyPlugin", "src/Base", "src/MulticopterPlugin", "src/SceneEffectsPlugin")
MOST_LISTED = 60  # names of a header with one reason
LONGEST = 120  # of a cell with names
WORD = re.compile(r"[A-Za-z_]\w*$")
TOKEN = re.compile(r"[A-Za-z_]\w*|::|->|\d[\w.]*|\S")
NO_NAMES = {"operator", "const", "override", "final", "noexcept", "virtual", "static", "inline", "default", "delete",
            "explicit", "if", "while", "for", "return", "sizeof", "decltype", "static_cast", "void", "int", "double",
            "float", "bool", "char", "unsigned", "short", "long", "auto", "constexpr", "friend", "template", "typename"}


def tokens_of(text):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.S)
    text = re.sub(r'"(\\.|[^"\\])*"', '""', text)
    text = re.sub(r"^[ \t]*#(\\\n|[^\n])*", " ", text, flags=re.M)
    text = re.sub(r"\[\[.*?\]\]", " ", text, flags=re.S)
    return TOKEN.findall(text)


class Names:
    """Public names by class; those of a namespace are under ''. Bases by class."""

    def __init__(self):
        self.of = {}
        self.bases = {}

    def add(self, owner, name):
        if WORD.match(name) and name not in NO_NAMES and not name.startswith("CNOID_"):
            self.of.setdefault(owner, set()).add(name)

    def has(self, owner, name, seen=()):
        if name in self.of.get(owner, ()):
            return True
        return any(self.has(base, name, (*seen, owner)) for base in self.bases.get(owner, ()) if base not in seen)


def end_of(tokens, at, opening, closing):
    """The index behind the bracket that closes the one at `at`."""
    depth = 0
    while at < len(tokens):
        depth += (tokens[at] == opening) - (tokens[at] == closing)
        at += 1
        if depth == 0:
            break
    return at


def read_head(statement):
    """Of 'class EXPORT Name final : public Base': the name and the bases; None: it is no class with a body."""
    words = list(statement)
    while words and words[0] == "template":
        words = words[end_of(words, 1, "<", ">"):]
    if not words or words[0] not in ("class", "struct", "union"):
        return None
    colon = words.index(":") if ":" in words else len(words)
    head = [word for word in words[1:colon] if WORD.match(word) and word != "final" and not word.endswith("EXPORT")]
    bases = [word for word in words[colon:] if WORD.match(word) and word not in ("public", "virtual", "cnoid")]
    return (head[0] if head else "", bases)


def add_enum(names, owner, statement, body):
    head = [word for word in statement if WORD.match(word) and word not in ("enum", "class", "struct", "typedef")]
    if head:
        names.add(owner, head[0])
    expects = True
    for token in body:
        if expects and WORD.match(token):
            names.add(owner, token)
        expects = token == "," or (expects and not WORD.match(token))


def add_statement(names, owner, statement):
    """A declaration without its body."""
    words = list(statement)
    while words and words[0] == "template":
        words = words[end_of(words, 1, "<", ">"):]
    if not words or words[0] in ("friend", "class", "struct", "enum", "namespace", "extern") and "(" not in words:
        return
    if words[0] == "using":
        if "=" in words:
            names.add(owner, words[1])
        elif len(words) > 2:
            names.add(owner, words[-1])
        return
    if words[0] == "typedef":
        names.add(owner, words[-1])
        return
    if "operator" in words:
        return
    depth = 0  # of template arguments
    for i, token in enumerate(words):
        if token == "<" and i and WORD.match(words[i - 1]):
            depth += 1
        elif token == ">" and depth:
            depth -= 1
        elif token == "(" and depth == 0:
            if i and words[i - 1] != owner and (i < 2 or words[i - 2] not in ("~", "::")):
                names.add(owner, words[i - 1])
            return
        elif token in ("=", "{", ":") and depth == 0:
            words = words[:i]
            break
    while words and words[-1] == "]":
        words = words[:-3]
    if len(words) > 1:
        names.add(owner, words[-1])


def read(tokens, names, owner="", is_public=True):
    at, statement = 0, []
    while at < len(tokens):
        token = tokens[at]
        if owner and token in ("public", "protected", "private") and tokens[at + 1 : at + 2] == [":"]:
            is_public, statement, at = token == "public", [], at + 2
        elif token == ";":
            if is_public:
                add_statement(names, owner, statement)
            statement, at = [], at + 1
        elif token == "{":
            end = end_of(tokens, at, "{", "}")
            body = tokens[at + 1 : end - 1]
            class_head = read_head(statement)
            if statement and (statement[0] in ("namespace", "extern")):
                read(body, names, owner)
                statement = []
            elif "enum" in statement[:2]:
                if is_public:
                    add_enum(names, owner, statement, body)
            elif class_head and "(" not in statement:
                name, bases = class_head
                if is_public:
                    names.add(owner, name)
                names.bases.setdefault(name, []).extend(bases)
                names.of.setdefault(name, set())
                read(body, names, name, statement[0] != "class" and "class" not in statement)
            elif "=" in statement and "(" not in statement:
                at = end
                continue
            else:
                if is_public:
                    add_statement(names, owner, statement)
                statement = []
            at = end
            if tokens[at : at + 1] == [";"]:
                statement, at = [], at + 1
        else:
            statement.append(token)
            at += 1


def names_of(files):
    names = Names()
    for file in files:
        read(tokens_of(file.read_text(encoding="utf-8", errors="replace")), names)
    return names


def missing_names(checkout, ours):
    own = names_of(sorted(ours.glob("*.h")))
    count, missing = 0, []
    for header in sorted(ours.glob("*.h")):
        theirs = next((checkout / folder / header.name for folder in FOLDERS
                       if (checkout / folder / header.name).is_file()), None)
        if theirs is None:
            continue
        found = names_of([theirs])
        for owner, names in sorted(found.of.items()):
            for name in sorted(names):
                count += 1
                if not own.has(owner, name):
                    missing.append(f"{header.stem}/{owner}::{name}" if owner else f"{header.stem}/{name}")
    return count, missing


def read_rules(file):
    rules = []
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            pattern, reason = line.split(": ", 1)
            rules.append((re.compile(pattern), reason.strip()))
    return rules


def rows_of(header, reason, members):
    """Rows of the table, whose cells are short."""
    rows, names = [], []
    for member in [*members, None]:
        if member is None or len(" ".join([*names, member])) > LONGEST:
            rows.append(f"| {header} | `{' '.join(names)}` | {reason} |")
            names = []
        names.append(member)
    return rows


def table_of(count, missing, rules):
    """The lines of the table, the names without a reason, the rules that match nothing."""
    by_reason, without, used = {}, [], set()
    for name in missing:
        rule = next((rule for rule in rules if rule[0].match(name)), None)
        if rule is None:
            without.append(name)
            continue
        used.add(rule)
        header, member = name.split("/", 1)
        by_reason.setdefault((header, rule[1]), []).append(member.removeprefix(header + "::"))
    lines = [f"{count - len(missing)} of {count} public names of these headers exist here.", "",
             "| header | names | not here, because |", "| --- | --- | --- |"]
    for (header, reason), members in sorted(by_reason.items()):
        lines += rows_of(header, reason, members) if len(members) <= MOST_LISTED else [
            f"| {header} | {len(members)} names | {reason} |"]
    return lines, without, [pattern.pattern for pattern, reason in rules if (pattern, reason) not in used]


def main():
    checkout, ours, reasons = map(Path, sys.argv[1:4])
    count, missing = missing_names(checkout, ours)
    lines, without, unused = table_of(count, missing, read_rules(reasons))
    print("\n".join(lines))
    for name in without:
        print(f"missing without a reason: {name}")
    for pattern in unused:
        print(f"matches no missing name: {pattern}")
    wrong = bool(without or unused)
    if len(sys.argv) > 4:
        page = Path(sys.argv[4]).read_text(encoding="utf-8")
        if "\n".join(lines) not in page:
            print(f"{sys.argv[4]} doesn't have this table")
            wrong = True
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
