"""Checks the licence and the source of every dependency against deny.toml, without the network.

Usage: cargo metadata --format-version 1 | python3 .ci/licences.py deny.toml
Needs Python 3.11 (tomllib). Exits with 1 and a line for each crate that is not allowed.
"""

import json
import re
import sys
import tomllib


def allowed(expression, licences):
    """Whether an SPDX expression can be satisfied; "/" is the OR of older manifests."""
    words = re.findall(r"\(|\)|[^()\s/]+|/", expression)
    place = 0

    def either():
        nonlocal place
        answer = both()
        while place < len(words) and words[place] in ("OR", "/"):
            place += 1
            answer = both() or answer
        return answer

    def both():
        nonlocal place
        answer = one()
        while place < len(words) and words[place] == "AND":
            place += 1
            answer = one() and answer
        return answer

    def one():
        nonlocal place
        if place >= len(words):
            raise ValueError(expression)
        word = words[place]
        place += 1
        if word == "(":
            answer = either()
            if place >= len(words) or words[place] != ")":
                raise ValueError(expression)
            place += 1
            return answer
        if place < len(words) and words[place] == "WITH":
            word = f"{word} WITH {words[place + 1]}"
            place += 2
        return word in licences

    answer = either()
    if place != len(words):
        raise ValueError(expression)
    return answer


def test_the_parser():
    mit = {"MIT", "ISC", "Apache-2.0 WITH LLVM-exception"}
    assert allowed("MIT", mit) and allowed("GPL-3.0 OR MIT", mit) and allowed("GPL-3.0/MIT", mit)
    assert allowed("(GPL-3.0 OR MIT) AND ISC", mit) and allowed("MIT AND ISC OR GPL-3.0", mit)
    assert allowed("Apache-2.0 WITH LLVM-exception", mit)
    assert not allowed("Apache-2.0", mit) and not allowed("MIT AND GPL-3.0", mit)
    assert not allowed("GPL-3.0", mit) and not allowed("(MIT OR ISC) AND GPL-3.0", mit)


def main(rules_file):
    test_the_parser()
    with open(rules_file, "rb") as file:
        rules = tomllib.load(file)
    licences = set(rules["licenses"]["allow"])
    crates = json.load(sys.stdin)["packages"]
    wrong = []
    for crate in crates:
        name = f"{crate['name']} {crate['version']}"
        expression = crate["license"]
        if not expression:
            wrong.append(f"{name}: states no licence")
        elif not allowed(expression, licences):
            wrong.append(f"{name}: {expression} is not among the allowed licences")
        # None is a package of the project itself; everything else comes from a package registry.
        if not (crate["source"] or "registry+").startswith("registry+"):
            wrong.append(f"{name}: comes from {crate['source']}")
    print("\n".join(wrong) or f"{len(crates)} crates, all of allowed licences and sources")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
