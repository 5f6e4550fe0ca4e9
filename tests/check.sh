#!/usr/bin/env bash
# What to run before a push: tests, format, length of the prose, lints, documentation, licences of the
# dependencies. `tests/check.sh --long` looks for their known faults too, and runs the ignored tests, which take the full
# counts (100 000 states, 100 seeds).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cargo test --workspace
cargo fmt --all -- --check
cargo fmt --manifest-path tests/fuzz/Cargo.toml -- --check
# Its own lock file follows that of the workspace.
cargo metadata --locked --format-version 1 --manifest-path tests/fuzz/Cargo.toml > /dev/null
python3 tests/prose.py
cargo clippy --workspace --all-targets -- -D warnings
# The target on real measurements is left out of plain test runs, and so of --all-targets.
cargo clippy -p fit-cloth-tests --test real -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps
# cargo install --locked cargo-deny
cargo deny --log-level error check licenses bans sources
if [ "${1:-}" = "--long" ]; then
    # Downloads the database of known faults.
    cargo deny check advisories
    # The oldest Rust that Cargo.toml promises; in between, clippy knows which functions it has.
    minimum=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
    rustup run --install "$minimum" cargo check --workspace --locked --target-dir "target/rust-$minimum"
    cargo test --workspace -- --ignored --nocapture
fi
