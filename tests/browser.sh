#!/usr/bin/env bash
# Opens report.html in Chromium, as a reader does: tests/browser/page.test.mjs. Needs Node.js and Chromium.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cargo build --workspace
npm ci --prefix tests/browser --no-audit --no-fund --silent
node --test tests/browser/
