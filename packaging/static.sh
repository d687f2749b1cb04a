#!/usr/bin/env bash
# A program for any Linux, without a C library: target/x86_64-unknown-linux-musl/dist/riprap.
set -euo pipefail
cd "$(dirname "$0")/.."

target="$(uname -m)-unknown-linux-musl"
rustup target add "$target"
cargo build --locked --profile dist --package riprap --target "$target"
program="target/$target/dist/riprap"
"$program" --version
ls -l "$program"
