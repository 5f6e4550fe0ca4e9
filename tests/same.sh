#!/usr/bin/env bash
# Whether two builds of the program write the same: `tests/same.sh BEFORE AFTER`, each a path to the program. On the four
# fabrics: fit, compare, validate, check; a drape and a flag; a quick study. Seconds and versions may differ. Prints every
# file that differs otherwise, and how many were compared; fails if one differs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# = 2 ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }

outputs=$(mktemp -d)
trap 'rm -rf "$outputs"' EXIT

run() {
    local side=$1 program=$2 out=$outputs/$1
    mkdir -p "$out"
    for set in cotton-denim cotton-satin rayon-spandex-knit wool-cotton; do
        "$program" fit "fixtures/$set" --nodes 13x13 --out "$out/fit-$set" > "$out/fit-$set.txt" 2>&1 || true
        "$program" compare "fixtures/$set" --nodes 9x9 --out "$out/compare-$set" > "$out/compare-$set.txt" 2>&1 || true
        "$program" validate "fixtures/$set" --material "$out/fit-$set/material.json" --out "$out/validate-$set" \
            > "$out/validate-$set.txt" 2>&1 || true
        "$program" check "$out/fit-$set/material.json" > "$out/check-$set.txt" 2>&1 || true
    done
    for scene in drape flag; do
        "$program" simulate "fixtures/scenes/$scene.toml" --material "$out/fit-cotton-denim/material.json" \
            --out "$out/simulate-$scene" > "$out/simulate-$scene.txt" 2>&1 || true
    done
    "$program" study fixtures/cotton-denim --quick --out "$out/study" > "$out/study.txt" 2>&1 || true
    # Times, versions, and the folder itself.
    find "$out" -type f \( -name '*.txt' -o -name '*.json' -o -name '*.csv' -o -name '*.md' \) -print0 |
        xargs -0 sed -i -E \
            -e "s#$out#OUT#g" \
            -e 's/"(seconds|wall_seconds|seconds_[a-z_]+)": ?[0-9.e+-]+/"\1": 0/g' \
            -e 's/[0-9.]+ (s|ms|µs)\b/0 \2/g' \
            -e 's/"program": "fit-cloth [^"]*"/"program": "fit-cloth"/g'
    find "$out" -type f -name '*.csv' -print0 | while IFS= read -r -d '' table; do
        awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /seconds/) times[i] } NR > 1 { for (i in times) $i = 0 } 1' \
            "$table" > "$table.new" && mv "$table.new" "$table"
    done
}

run before "$1" &
run after "$2" &
wait

count=0 differ=0
while IFS= read -r file; do
    count=$((count + 1))
    if ! cmp -s "$outputs/before/$file" "$outputs/after/$file"; then
        differ=$((differ + 1))
        echo "differs: $file"
        case $file in *.txt | *.json | *.csv | *.md) diff "$outputs/before/$file" "$outputs/after/$file" | cut -c1-200 | head -n 6 || true ;; esac
    fi
done < <(cd "$outputs" && { cd before && find . -type f; cd ../after && find . -type f; } | sort -u)
echo "$count files compared, $differ differ"
[ "$differ" = 0 ]
