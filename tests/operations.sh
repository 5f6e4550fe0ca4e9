#!/usr/bin/env bash
# Counts the floating-point arithmetic of one element, as compiled: additions and subtractions, multiplications, divisions and
# square roots of the functions in crates/sim/benches/elements.rs. They are compiled for this without loops, calls and packed
# arithmetic, so that what stands there is what is done; a function that has one nevertheless is marked. Needs objdump and an
# x86-64 machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

flags="-C no-vectorize-loops -C no-vectorize-slp -C llvm-args=-unroll-threshold=10000 -C llvm-args=-inline-threshold=10000"
# shellcheck disable=SC2086
cargo rustc -q -p cloth-sim --bench elements --profile bench --target-dir target/operations -- $flags
program=$(ls -t target/operations/release/deps/elements-* | grep -v '\.d$' | head -1)
printf '%-28s%6s%6s%6s%6s\n' function add mul div sqrt
objdump -d -C --no-show-raw-insn "$program" | awk '
    /^[0-9a-f]+ <.*>:$/ {
        name = $2; sub(/^<elements::/, "", name); sub(/>:$/, "", name)
        counted = name ~ /^(spring|soft_constraint|stvk|hinge)_(force|jacobian)/
        if (counted) { names[++n] = name; loop[name] = "" }
        next
    }
    counted && NF > 1 {
        where = $1; sub(/:/, "", where); op = $2
        if (op ~ /^(add|sub)sd$/) ++add[name]
        else if (op == "mulsd") ++mul[name]
        else if (op == "divsd") ++div[name]
        else if (op == "sqrtsd") ++root[name]
        else if (op ~ /^(add|sub|mul|div|sqrt)pd$/) loop[name] = loop[name] "  (packed)"
        else if (op ~ /^call/) loop[name] = loop[name] "  (calls " $3 " " $4 " " $5 ")"
        else if (op ~ /^j/ && sprintf("%16s", $3) < sprintf("%16s", where)) loop[name] = loop[name] "  (loop)"
    }
    END {
        for (i = 1; i <= n; i++) {
            name = names[i]
            printf "%-28s%6d%6d%6d%6d%s\n", name, add[name], mul[name], div[name], root[name], loop[name]
        }
    }'
