#!/usr/bin/env bash
# Which lines the unit tests run of the readers of files, of the curves and of the least squares. Prints every file with
# the lines that no test runs, then a table of the three groups; fails where a group is below 95 %. Needs cargo-tarpaulin
# (`cargo install cargo-tarpaulin --locked`), which compiles everything anew, instrumented, into target/coverage.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=target/coverage
mkdir -p "$folder"
# Build scripts are instrumented too, and leave their counts here.
trap 'rm -f build_rs_cov.profraw' EXIT
cargo tarpaulin --engine llvm --skip-clean --locked --lib -p cloth-sim -p cloth-data -p cloth-fit -p cloth-scene -p fit-cloth \
    --timeout 900 --target-dir "$folder" --out Lcov --output-dir "$folder" > "$folder/log" 2>&1 ||
    { tail -n 30 "$folder/log" >&2; exit 1; }

awk -F '[:,]' -v root="$PWD/" '
    function group(file) {
        if (file ~ /(^|\/)tests(\/|\.rs)/) return ""
        if (file ~ /^crates\/data\/src\/(io|curve_file|points|strip)(\/|\.rs)/ || file ~ /^crates\/fit\/src\/material(\/|\.rs)/) return "readers"
        if (file ~ /^crates\/scene\/src\/scene(\/|\.rs)/) return "readers"
        if (file ~ /^crates\/sim\/src\/curve(\/|\.rs)/) return "curves"
        if (file ~ /^crates\/fit\/src\/optimise\/(least_squares|gauss_newton)(\/|\.rs)/) return "least squares"
        return ""
    }
    $1 == "SF" { file = $2; sub("^" root, "", file); of = group(file); count = run = 0; missed = "" }
    $1 == "DA" && of != "" { ++count; if ($3 > 0) ++run; else missed = missed " " $2 }
    $1 == "end_of_record" && of != "" && count > 0 {
        printf "%-55s %4d of %4d%s\n", file, run, count, missed == "" ? "" : ", not" missed
        lines[of] += count; covered[of] += run
    }
    END {
        print "\n| group | lines | covered | % |\n|---|---|---|---|"
        names[1] = "readers"; names[2] = "curves"; names[3] = "least squares"
        for (i = 1; i <= 3; i++) {
            name = names[i]
            if (lines[name] == 0) { print name ": no line was measured" > "/dev/stderr"; exit 1 }
            percent = 100 * covered[name] / lines[name]
            printf "| %s | %d | %d | %.1f |\n", name, lines[name], covered[name], percent
            if (percent < 95) low = 1
        }
        exit low
    }' "$folder/lcov.info"
