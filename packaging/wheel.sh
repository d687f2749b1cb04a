#!/usr/bin/env bash
# Builds the wheel, installs it into an empty environment, and runs a case with it, from outside of the repository.
# With `zig` from PyPI the wheel runs on any Linux with glibc 2.17 or newer.
set -euo pipefail
cd "$(dirname "$0")/.."

environment="target/wheel-python"
rm -rf "$environment" target/wheels
python3 -m venv "$environment"
"$environment/bin/pip" install --quiet "maturin[zig]>=1.9,<2"
# maturin asks the first python on the path for zig
PATH="$PWD/$environment/bin:$PATH" maturin build --zig --compatibility manylinux2014 --out target/wheels
ls -l target/wheels

empty="$(mktemp -d)"
trap 'rm -rf "$empty"' EXIT
python3 -m venv "$empty/python"
"$empty/python/bin/pip" install --quiet --no-index --find-links target/wheels riprap
version="$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)"
cp cases/sliding_wedge.ron "$empty"
cd "$empty"
test "$(python/bin/riprap --version)" = "riprap $version"
python/bin/riprap check sliding_wedge.ron
python/bin/riprap run sliding_wedge.ron --until 0.5 --quiet
test -s runs/sliding_wedge/report.html
