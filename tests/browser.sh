#!/usr/bin/env bash
# Opens report.html in Chromium, as a reader does: tests/browser/page.test.mjs. Needs Node.js 20 and Chromium.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# The program as the other tests have built it.
cargo test --workspace --no-run
npm ci --prefix tests/browser --no-audit --no-fund --silent
node --test tests/browser/
