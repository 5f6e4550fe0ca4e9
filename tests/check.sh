#!/usr/bin/env bash
# What to run before a push: tests, format, length of the prose, lints, documentation. `tests/check.sh --long` runs the
# ignored tests too, which take the full counts (100 000 states, 100 seeds).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cargo test --workspace
cargo fmt --all -- --check
cargo fmt --manifest-path tests/fuzz/Cargo.toml -- --check
python3 tests/prose.py
cargo clippy --workspace --all-targets -- -D warnings
# The target on real measurements is left out of plain test runs, and so of --all-targets.
cargo clippy -p fit-cloth-tests --test real -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps
if [ "${1:-}" = "--long" ]; then
    cargo test --workspace -- --ignored --nocapture
fi
