#!/bin/sh
# What the program promises beyond what the library's tests say: pipes, formats by ending, JSON and nothing else, Ctrl-C.
# Usage: good-input.sh BATTEN EXAMPLES
set -u
batten=$1
examples=$2
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

check()
{
    what=$1
    shift
    "$@" || { echo "FAILED: $what"; failures=$((failures + 1)); }
}

# Whether a file holds one JSON object and nothing else: braces first and last, and the given text in it.
json()
{
    head -c 1 "$1" | grep -q '{' && tail -c 2 "$1" | grep -q '}' && grep -q "$2" "$1"
}

same()
{
    cmp -s "$1" "$2"
}

"$batten" curve - --levels 2 < "$examples/outline.csv" > piped.csv
"$batten" curve "$examples/outline.csv" --levels 2 -o file.csv --quiet
check "standard input to standard output gives the same bytes" same piped.csv file.csv
"$batten" curve "$examples/outline.csv" --levels 2 --threads 1 -o one.csv --quiet
check "one thread gives the same bytes" same one.csv file.csv
check "the directive # closed survives" grep -q '^# closed' file.csv
check "22 points give 88" test "$(grep -c '^[-0-9]' file.csv)" -eq 88

"$batten" curve "$examples/iss-track.geojson" --levels 3 -o track.geojson --quiet
check "properties survive" grep -q '"inclination":51.64' track.geojson
"$batten" curve "$examples/iss-track.geojson" --levels 3 -o track.csv --quiet
check "the ending decides the format" sh -c "sed 's/[^,]//g' track.csv | tail -1 | grep -q '^,,*$'"
"$batten" curve "$examples/camera-path.obj" --to csv --levels 1 > path.csv
check "an open curve of 10 points has 19 after a level" test "$(grep -c '^[-0-9]' path.csv)" -eq 19

"$batten" curve "$examples/outline.csv" --json -o out.csv > report.json
check "the report of curve is JSON" json report.json '"bending"'
"$batten" measure out.csv "$examples/outline.csv" --json > measure.json
check "measure prints JSON" json measure.json '"hausdorff"'
"$batten" analyze chaikin --json > analyze.json
check "analyze prints JSON" json analyze.json '"mask"'
"$batten" list schemes --json > list.json
check "list prints JSON" json list.json '"log-exp-4"'
"$batten" reproduce tension-iss --json > iss.json
check "reproduce prints JSON" json iss.json '"four-point-outward"'

"$batten" curve "$examples/hyperbolic.csv" --space disk -o disk.csv --picture disk.png --panel 0,1,3 > /dev/null
check "a picture is a PNG file" grep -q PNG disk.png
"$batten" curve "$examples/outline.csv" --levels 4 --scheme angle-6 -o truth.csv --quiet
"$batten" curve "$examples/outline.csv" --levels 4 --truth truth.csv --best-tension -o best.csv > best.txt
check "the tension search finds the truth's own tension" grep -q 'angle:mu=-0.250' best.txt

echo untouched > stopped.csv
"$batten" curve "$examples/outline.csv" --scheme angle-4:adaptive=1 --levels 24 --threads 1 -o stopped.csv 2> stopped.txt &
sleep 0.5
kill -INT $!
wait $!
check "Ctrl-C ends with 1" test $? -eq 1
check "Ctrl-C leaves the output alone" test "$(cat stopped.csv)" = untouched
check "Ctrl-C says so" grep -q stopped stopped.txt

for verb in curve measure analyze reproduce list; do
    check "batten $verb --help" sh -c "'$batten' $verb --help | grep -q '^usage: batten $verb'"
done
check "batten --version" sh -c "'$batten' --version | grep -q '^batten [0-9]'"

[ $failures -eq 0 ] && echo "the program does what it promises"
[ $failures -eq 0 ]
