#!/bin/sh
# `batten reproduce all` makes what is missing in a folder, keeps what is there, and lists both.
# Usage: reproduce-all.sh BATTEN
set -eu
batten=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

fail() {
    echo "FAILED: $1"
    exit 1
}

# All but two results are there already; one of those two cannot be made without data.
mkdir out
"$batten" list results | awk '$1 != "all" && $1 != "tension-iss" && $1 != "real-meshes" && /^[a-z]/ { print $1 }' >names
while read -r name; do echo "of $name" >"out/$name.txt"; done <names
"$batten" reproduce all -o out --quick >printed
grep -q 'log-exp-4' out/tension-iss.txt || fail "tension-iss was not made"
[ "$(cat out/hermite-order.txt)" = 'of hermite-order' ] || fail "a result that was there was made again"
[ ! -e out/real-meshes.txt ] || fail "a result was made without its data"
state() {
    awk -F '\t' -v name="$1" '$1 == name { print $2 }' out/summary.tsv
}
[ "$(state tension-iss)" = made ] || fail "summary.tsv does not say that tension-iss was made"
[ "$(state hermite-order)" = kept ] || fail "summary.tsv does not say that hermite-order was kept"
[ "$(state real-meshes)" = 'left out: needs --data' ] || fail "summary.tsv does not say why real-meshes is missing"
[ "$(wc -l <out/summary.tsv)" -eq $(($(wc -l <names) + 3)) ] || fail "summary.tsv has not one line for each result"

# What exceeds its budget of time is left out, and so are trainings.
rm out/tension-iss.txt out/mesh-style.txt out/tension-table1.txt
"$batten" reproduce all -o out --budget 0.01 --without-trainings >printed 2>errors || fail "a result over its budget ends the call"
[ "$(state tension-table1)" = 'left out: over 0.01 s' ] || fail "summary.tsv does not say that tension-table1 took too long"
[ "$(state mesh-style)" = 'left out: a training' ] || fail "summary.tsv does not say that mesh-style is a training"
[ ! -e out/tension-table1.txt ] || fail "a result that was stopped has a file"
echo 'of mesh-style' >out/mesh-style.txt

# A result that fails leaves no file, and is named; the next call tries it again. Data are found below the folder of all data.
mkdir -p data/meshes
for name in $(cat names) tension-iss; do echo '{}' >"out/$name.json"; done
for call in 1 2; do
    "$batten" reproduce all -o out --quick --data data --json >printed 2>errors || fail "one failed result ends the call"
    [ "$(state real-meshes)" = failed ] || fail "call $call: summary.tsv does not say that real-meshes failed"
    [ ! -e out/real-meshes.json ] || fail "a failed result has a file"
    grep -q 'data/meshes' errors || fail "the folder of the meshes was not found"
done
