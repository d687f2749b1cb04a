#!/usr/bin/env bash
# Builds the wheel, installs it into an empty environment, and runs from outside of the repository: a case, the tests of the
# module, its types, its notebooks. With `zig` from PyPI the wheel runs on any Linux with glibc 2.17 or newer.
set -euo pipefail
cd "$(dirname "$0")/.."

environment="target/wheel-python"
rm -rf "$environment" target/wheels
python3 -m venv "$environment"
"$environment/bin/pip" install --quiet "maturin[zig]>=1.9,<2"
# maturin asks the first python on the path for zig
PATH="$PWD/$environment/bin:$PATH" maturin build --zig --compatibility manylinux2014 --out target/wheels
ls -l target/wheels
test "$(stat --format=%s target/wheels/*.whl)" -lt 20000000

empty="$(mktemp -d)"
trap 'rm -rf "$empty"' EXIT
# the sdist has every file that the sources of the program include
"$environment/bin/maturin" sdist --out "$empty/sdist"
tar -xzf "$empty"/sdist/*.tar.gz --strip-components 1 -C "$empty/sdist"
grep -rHoE 'include_(str|bytes)!\("[^"]+' "$empty"/sdist/*/src | while IFS=: read -r source text; do
    included="$(dirname "$source")/${text#*\"}"
    test -f "$included" || { echo "the sdist lacks $included" >&2; exit 1; }
done
python3 -m venv "$empty/python"
export PATH="$empty/python/bin:$PATH"
pip install --quiet numpy
pip install --quiet --no-index --find-links target/wheels riprap
version="$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)"
cp cases/sliding_wedge.ron "$empty"
cp -r python/tests python/notebooks pyproject.toml "$empty"
cd "$empty"
test "$(riprap --version)" = "riprap $version"
riprap check sliding_wedge.ron
riprap run sliding_wedge.ron --until 0.5 --quiet
test -s runs/sliding_wedge/report.html

pip install --quiet pytest mypy nbclient nbformat ipykernel matplotlib
python -m pytest -q tests
# what users see, against what is compiled
python -m mypy tests
python -m mypy.stubtest riprap._riprap --ignore-disjoint-bases
for notebook in notebooks/*.ipynb; do
    jupyter execute "$notebook"
done
