#!/bin/sh
# Generated maps are valid in longitude and latitude, and their features do not overlap, as GEOS sees them. Exit code 77 where
# no Python has Shapely. Usage: generated-map.sh BATTEN
set -u
batten=$1
here=$(cd "$(dirname "$0")" && pwd)
for python in python3 /usr/bin/python3 ''; do
    [ -n "$python" ] || { echo "no Python with Shapely"; exit 77; }
    "$python" -c 'import shapely' 2>/dev/null && break
done
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
"$batten" shape map -o default.geojson --quiet || exit 1
"$batten" shape map --countries 12 --detail 1 --seed 2 -o small.geojson --quiet || exit 1
"$batten" shape map --countries 60 --detail 6 --seed 3 -o fine.geojson --quiet || exit 1
"$batten" shape map --countries 500 --detail 1 --seed 4 -o many.geojson --quiet || exit 1
"$python" -W ignore "$here/check-coverage.py" default.geojson small.geojson fine.geojson many.geojson
