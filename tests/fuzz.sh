#!/usr/bin/env bash
# Fuzzes everything that fit-cloth reads, and curves on their way into a simulation: tests/fuzz/README.md.
#
#   tests/fuzz.sh SECONDS [TARGET …]    so long in all, as many targets at a time as there are cores (or JOBS); with SEED
#                                       set, the same inputs in the same order
#   tests/fuzz.sh --merge [TARGET …]    adds new inputs to the corpus: as few and small ones as reach the same code
#
# Exit code 1 if a target crashed, hung or took too much memory. Needs a C++ compiler, for libFuzzer; no nightly toolchain.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/fuzz"

seconds=${1:?tests/fuzz.sh SECONDS [TARGET …]}
shift
if [ $# -eq 0 ]; then
    for target in targets/*.rs; do set -- "$@" "$(basename "$target" .rs)"; done
fi
jobs=${JOBS:-$(nproc)}

# The flags of cargo fuzz without a sanitizer: safe Rust has no use for one. A --target keeps them from build scripts.
triple=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
    -Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-simplifycfg-branch-fold-threshold=0
    -Cllvm-args=-sanitizer-coverage-stack-depth --cfg fuzzing" \
    cargo build --quiet --release --locked --target "$triple" --target-dir target --bins
programs=target/$triple/release

# In memory, where there is such a file system: a target writes a file for every execution.
TMPDIR=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
mkdir -p target/log target/crashes
# An archive per target: hundreds of inputs of a few bytes each are one file.
for target in "$@"; do
    rm -rf "target/corpus/$target"
    mkdir -p "target/corpus/$target"
    [ ! -e "corpus/$target.tar.gz" ] || tar -xzf "corpus/$target.tar.gz" -C "target/corpus/$target"
done
# A header that promises a huge array must not get it.
ulimit -v 2097152

if [ "$seconds" = --merge ]; then
    for target in "$@"; do
        mkdir -p "target/found/$target" "$TMPDIR/$target"
        "$programs/$target" -set_cover_merge=1 -use_counters=0 "$TMPDIR/$target" "target/corpus/$target" \
            "target/found/$target" > "target/log/$target" 2>&1
        # The same inputs give the same bytes.
        tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=644 -C "$TMPDIR/$target" -c . |
            gzip -9n > "corpus/$target.tar.gz"
        echo "$target: $(find "$TMPDIR/$target" -type f | wc -l) inputs, $(wc -c < "corpus/$target.tar.gz") bytes"
    done
    exit
fi

each=$(((seconds * jobs + $# - 1) / $#))
fuzz() {
    mkdir -p "target/found/$1"
    dictionary=$(ls "dictionaries/$1.dict" 2>/dev/null || true)
    "$programs/$1" "target/found/$1" "target/corpus/$1" -max_total_time="$each" -max_len=4096 -timeout=10 -rss_limit_mb=1024 \
        ${SEED:+-seed="$SEED"} \
        ${dictionary:+-dict="$dictionary"} -artifact_prefix="target/crashes/$1-" -print_final_stats=1 > "target/log/$1" 2>&1
    echo $? > "target/log/$1.code"
}
export -f fuzz
export programs each
printf '%s\n' "$@" | xargs -P "$jobs" -I '{}' bash -c 'fuzz {}'

row='%-14s | %11s | %12s | %8s | %7s\n'
# shellcheck disable=SC2059
printf "$row" target executions 'a second' coverage crashes
failed=0
all=0
for target in "$@"; do
    log=target/log/$target
    crashes=0
    if [ "$(cat "$log.code")" != 0 ]; then
        crashes=1
        failed=1
        grep -a -E 'panicked|ERROR|SUMMARY|Test unit written' -A 2 "$log" >&2
    fi
    final() { sed -n "s/^stat::$1: *//p" "$log"; }
    executions=$(final number_of_executed_units)
    all=$((all + ${executions:-0}))
    # shellcheck disable=SC2059
    printf "$row" "$target" "$executions" "$(final average_exec_per_sec)" \
        "$(grep -a -o 'cov: [0-9]*' "$log" | tail -1 | cut -c 6-)" "$crashes"
done
echo "$all executions"
exit $failed
