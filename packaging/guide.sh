#!/usr/bin/env bash
# Builds the guide into target/guide, with what it installs itself. Warnings are errors, broken links among them.
set -euo pipefail
cd "$(dirname "$0")/.."

environment="target/guide-python"
if ! cmp -s docs/requirements.txt "$environment/requirements.txt"; then
    rm -rf "$environment"
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet --disable-pip-version-check -r docs/requirements.txt
    cp docs/requirements.txt "$environment/requirements.txt"
fi

# pages of accuracy are made from results, beside a copy of the pages that are written
rm -rf target/guide-source target/guide
cp -r docs target/guide-source
python3 docs/accuracy.py target/guide-source/accuracy

RIPRAP_SOURCE="$PWD" "$environment/bin/sphinx-build" --fail-on-warning --keep-going --quiet -b html \
    -d target/guide-trees target/guide-source target/guide

# no page may need a network
if grep -rnEi '(src|@import|url\()[="( ]*["'"'"']?(https?:)?//' target/guide --include='*.html' --include='*.css' | head -5 | grep .; then
    echo "error: these pages of the guide load something from elsewhere" >&2
    exit 1
fi
if grep -rnE '<link [^>]*href="(https?:)?//' target/guide --include='*.html' | grep -v 'rel="canonical"' | head -5 | grep .; then
    echo "error: these pages of the guide link to a style or a font elsewhere" >&2
    exit 1
fi
echo "target/guide/index.html"
