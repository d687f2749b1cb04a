#!/usr/bin/env python3
"""Checks licenses, bans and sources of all dependencies against deny.toml, without a network.

`cargo deny check` does the same and knows the advisories, but takes minutes to compile.
"""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CRATES_IO = "registry+"


def allowed(expression, licenses):
    """Whether a license expression (SPDX, with the old slash for OR) can be met with these licenses."""
    words = re.findall(r"\(|\)|[^\s()]+", expression.replace("/", " OR "))

    def alternatives(at):
        is_met, at = conjunction(at)
        while at < len(words) and words[at] == "OR":
            other, at = conjunction(at + 1)
            is_met = is_met or other
        return is_met, at

    def conjunction(at):
        is_met, at = single(at)
        while at < len(words) and words[at] == "AND":
            other, at = single(at + 1)
            is_met = is_met and other
        return is_met, at

    def single(at):
        if words[at] == "(":
            is_met, at = alternatives(at + 1)
            if words[at] != ")":
                raise ValueError("a parenthesis is not closed")
            return is_met, at + 1
        name, at = words[at], at + 1
        if at < len(words) and words[at] == "WITH":
            name, at = f"{name} WITH {words[at + 1]}", at + 2
        return name in licenses, at

    is_met, end = alternatives(0)
    if end != len(words):
        raise ValueError(f"`{words[end]}` is not expected")
    return is_met


def faults(packages, rules):
    """Violations of the rules, a line each."""
    licenses = set(rules["licenses"]["allow"])
    banned = {entry["name"] for entry in rules["bans"]["deny"]}
    sources = {CRATES_IO + url for url in rules["sources"]["allow-registry"]}
    for package in packages:
        name = f"{package['name']} {package['version']}"
        license = package["license"]
        try:
            if not license or not allowed(license, licenses):
                yield f"{name}: license {license or 'unknown'} is not in deny.toml"
        except (ValueError, IndexError) as error:
            yield f"{name}: license `{license}` cannot be read: {error}"
        if package["name"] in banned:
            yield f"{name} is banned by deny.toml"
        # those of this repository have no source
        if package["source"] is not None and package["source"] not in sources:
            yield f"{name} comes from {package['source']}"


def self_test():
    """Expressions whose value is known."""
    for expression, expected in [
        ("MIT", True),
        ("GPL-3.0", False),
        ("MIT/GPL-3.0", True),
        ("MIT AND GPL-3.0", False),
        ("GPL-3.0 AND MIT OR ISC", True),
        ("(MIT OR GPL-3.0) AND ISC", True),
        ("(MIT OR ISC) AND GPL-3.0", False),
        ("Apache-2.0 WITH LLVM-exception", False),
    ]:
        assert allowed(expression, {"MIT", "ISC"}) == expected, expression
    rules = {
        "licenses": {"allow": ["MIT"]},
        "bans": {"deny": [{"name": "bad"}]},
        "sources": {"allow-registry": ["https://a"]},
    }
    package = {"name": "bad", "version": "1.0.0", "license": "GPL-3.0", "source": "git+https://b"}
    assert len(list(faults([package], rules))) == 3


def main():
    self_test()
    rules = tomllib.loads((ROOT / "deny.toml").read_text())
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--all-features"]
    output = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    packages = json.loads(output)["packages"]
    found = list(faults(packages, rules))
    for fault in found:
        print(f"error: {fault}", file=sys.stderr)
    print(f"{len(packages)} packages, {len(found)} violations of deny.toml")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
