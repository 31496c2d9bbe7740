#!/bin/sh
# What the program tells of a scan beyond its surface: simple shapes, a noise that contradicts the points, and pictures.
# Usage: inspection.sh BATTEN
set -u
batten=$1
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

# make EXPRESSIONS > FILE: 1,200 random points; awk's x, y in -1 .. 1, n(s) noise, and `at` for the point
make()
{
    awk "BEGIN { srand(7); for (i = 0; i < 1200; i++) { x = 2 * rand() - 1; y = 2 * rand() - 1; $1 } }
        function n(s) { return s * sqrt(-2 * log(1 - rand())) * cos(6.283185307179586 * rand()) }"
}

make 'printf "%.9g %.9g %.9g\n", x + n(.01), y + n(.01), .3 * sin(3 * x) * cos(2 * y) + n(.01)' > wave.xyz
"$batten" surface wave.xyz --noise 0.001 > low.txt
check "a noise ten times too small is told" grep -q '^note: --noise 0.001 contradicts the points, whose noise is about 0.0' low.txt
"$batten" surface wave.xyz --noise 0.1 --json > high.json
check "a noise ten times too large is told in JSON" grep -q '"--noise 0.1 contradicts the points, whose noise is about 0.0' high.json
"$batten" surface wave.xyz --noise 0.01 > right.txt
check "a noise that agrees is not" sh -c '! grep -q contradicts right.txt'

check "waves are no simple shape" sh -c '! grep -q "lie on" right.txt && grep -q "\"shape\": null" high.json'
make 'printf "%.9g %.9g %.9g\n", 12.003 * sin(x) + n(.01), 9 * y + n(.01), 12.003 * cos(x) + n(.01)' > cylinder.xyz
"$batten" surface cylinder.xyz > cylinder.txt
check "a cylinder is told" grep -q 'the points lie on a cylinder of radius 12\.0[01]' cylinder.txt
make 'r = sqrt(1 - y * y); printf "%.9g %.9g %.9g\n", 5 * r * cos(3.15 * x) + n(.01), 5 * r * sin(3.15 * x) + n(.01), 5 * y + n(.01)' > ball.xyz
"$batten" surface ball.xyz --json > ball.json
check "a closed sphere is told" sh -c 'grep -q "\"closed\": true" ball.json && grep -q "\"kind\": \"sphere\"" ball.json'

"$batten" surface wave.xyz --functions 64 -o wave.json --picture plain.svg --quiet
"$batten" surface wave.xyz --functions 64 --picture bands.svg --bands 0.01,0.02 --quiet
check "bands change the picture" sh -c 'test -s bands.svg && ! cmp -s plain.svg bands.svg'
for view in zebra curvature; do
    "$batten" surface wave.xyz --functions 64 --picture $view.png --view $view --quiet
    check "view $view" sh -c "head -c 4 $view.png | grep -q PNG"
done
"$batten" surface wave.json --picture converted.png --view zebra --quiet
check "a surface that is converted has views" test -s converted.png
"$batten" surface ball.xyz --shell --patches 100 --picture sides.svg --quiet
"$batten" surface ball.xyz --bands 0.01,0.02 --picture sides-bands.svg --quiet
check "bands change the picture of what becomes a shell" sh -c 'test -s sides-bands.svg && ! cmp -s sides.svg sides-bands.svg'
for view in zebra curvature; do
    for threads in 1 2; do
        OMP_NUM_THREADS=$threads "$batten" surface ball.xyz --shell --patches 100 --picture $view$threads.png --view $view --quiet
    done
    check "view $view of a shell, for any threads" cmp ${view}1.png ${view}2.png
done
check "views of a shell differ" sh -c '! cmp -s zebra1.png curvature1.png'
for wrong in "--bands 0.1" "--view zebra" "--picture x.png --bands 0.2,0.1" "--picture x.png --bands 1,2,3,4,5" \
    "--shell --view zebra"; do
    # shellcheck disable=SC2086
    "$batten" surface wave.xyz $wrong > wrong.txt 2>&1
    check "$wrong is refused" test $? -eq 2
done
exit $((failures > 0))
