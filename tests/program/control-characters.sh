#!/bin/sh
# Control characters of file names, arguments and file contents reach neither messages nor notes nor reports.
# Usage: control-characters.sh BATTEN
set -u
batten=$1
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0
# Escape, a line break, delete, the C1 character that stands for escape and "[" (in UTF-8), and a byte that is no UTF-8.
bad=$(printf 'n\033[31m\nm\177\302\233a\233b')
c1=$(printf '\302[\200-\237]')

# clean PATTERN ARGUMENTS...: the program prints a line that matches, and no control character but line breaks.
clean()
{
    pattern=$1
    shift
    "$batten" "$@" > printed 2>&1 < /dev/null
    if ! grep -q -e "$pattern" printed || [ -n "$(tr -d '\n' < printed | LC_ALL=C tr -d -c '\001-\037\177')" ] ||
        LC_ALL=C grep -q "$c1" printed || ! iconv -f utf-8 -t utf-8 printed > converted 2>&1; then
        echo "FAILED: batten $*" | cat -v
        cat -v printed | sed 's/^/    /'
        failures=$((failures + 1))
    fi
}

# Names.
printf '0,0\n1,0\n1,1\n' > "$bad.csv"
printf '0,0\n1,zzz\n1,1\n' > "$bad-cell.csv"
printf '1311868171.131477 0 0 0 0 0 0 1\n1311868172.331406 1 0 0 0 0 0 1\n' > "$bad.tum"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n' > "$bad.obj"
printf 'v 0 0 0\nf 1 2 3\n' > "$bad-face.obj"
clean 'cannot open' curve "$bad-none.csv" -o out.csv
clean 'n?.31m?m???a?b-cell.csv:2:' curve "$bad-cell.csv" -o out.csv
clean 'n?.31m?m???a?b.csv -> new/n' curve "$bad.csv" "$bad-cell.csv" -o new
clean '"input"' curve "$bad.csv" "$bad-cell.csv" -o new --json
clean 'treated as a motion' curve "$bad.tum" -o out.tum
clean 'n?.31m?m???a?b-face.obj:2:' mesh "$bad-face.obj" -o out.obj
clean 'n?.31m?m' mesh "$bad.obj" -o out.obj --scheme sqrt3
clean 'n?.31m' decimate "$bad-face.obj" -o out.obj --vertices 4
clean 'n?.31m' measure "$bad-face.obj"
clean 'n?.31m' surface "$bad.csv" -o out.xml
clean 'n?.31m' curve "$bad.csv" -o "$bad/none/out.csv"

# Arguments.
clean "no verb 'n?.31m" "$bad"
clean 'n?.31m' curve "$bad.csv" -o out.csv --scheme "$bad"
clean 'n?.31m' curve "$bad.csv" -o out.csv --levels "$bad"
clean 'n?.31m' curve "$bad.csv" -o out.csv "--$bad"

# Contents: names of columns, cells, features and their members, statements.
printf 'x,y,\033[31mhdr\302\233\n1,2,a\n2,3,b\n3,9,d\n' > column.csv
printf 'x,y\n1,\033]0;title\007\n2,3\n' > cell.csv
printf '{"type":"Feature","id":"\\u001b[31m\\u009b","properties":{"name":"\\u001b[31m\302\233"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,95],[0,0]]]}}' > feature.geojson
printf '{"type":"Feature","geometry":{"type":"\\u001b[31m","coordinates":[]}}' > type.geojson
printf 'v 0 0 0\n\033[31mnonsense 1\n' > statement.obj
clean 'note: ' curve column.csv -o out.csv
clean '"notes"' curve column.csv -o out.csv --json
clean 'cell.csv:2:' curve cell.csv -o out.csv
clean 'feature.geojson:' curve feature.geojson -o out.geojson
clean 'type.geojson:' curve type.geojson -o out.geojson
clean 'statement.obj:' mesh statement.obj -o out.obj

if [ $failures -gt 0 ]; then
    echo "$failures checks failed"
    exit 1
fi
