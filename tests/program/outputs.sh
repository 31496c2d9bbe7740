#!/bin/sh
# All outputs of a call appear together, or none does: failures, two outputs to one file, signals, special files; and `batten motion`
# gives what `batten curve` gives. Usage: outputs.sh BATTEN EXAMPLES
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
    "$@" || { echo "FAILED: $what"; sed 's/^/    /' "$folder/stderr"; failures=$((failures + 1)); }
}

same()
{
    cmp -s "$1" "$2"
}

# nothing CODE PATTERN ARGUMENTS…: the program must end with CODE and one line that matches PATTERN (two with the usage), and leave
# this folder as it was.
nothing()
{
    code=$1 pattern=$2
    shift 2
    for file in out.csv out.obj out.stl out.png out.map out.uv; do echo untouched > $file; done
    ls -lA --time-style=full-iso > ../before.$$
    "$batten" "$@" > "$folder.stdout" 2> "$folder.stderr" < /dev/null
    got=$?
    ls -lA --time-style=full-iso > ../after.$$
    cp "$folder.stderr" ../stderr
    check "exit code $got instead of $code: batten $*" test $got -eq "$code"
    check "not $code lines on standard error: batten $*" test "$(wc -l < ../stderr)" -eq "$code"
    check "the message does not match '$pattern': batten $*" grep -Eq -e "$pattern" ../stderr
    check "files have changed: batten $*" same ../before.$$ ../after.$$
    check "something on standard output: batten $*" test ! -s "$folder.stdout"
    rm -f ../before.$$ ../after.$$ "$folder.stdout" "$folder.stderr"
}

: > stderr
mkdir room
cd room || exit 1
printf '0,0\n1,0\n1,1\n' > good.csv
printf '1,0,0\n0,1,0\n' > sphere.csv
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' > mesh.obj
printf '0,0,0\n1,0,1e308\n' > huge.csv
printf 'v 0 0 0\nv 1e308 0 0\nv 0 1 0\nf 1 2 3\n' > huge.obj
awk 'BEGIN { srand(1); for (i = 0; i < 300; i++) { u = rand(); v = rand(); print u, v, 0.1 * u * v } }' > cloud.xyz

# A failure of any output, early or late.
nothing 1 'must end in' curve good.csv -o out.csv --picture out.bmp
nothing 1 'no/such.png: cannot write' curve good.csv -o out.csv --picture no/such.png
nothing 1 'no/such: cannot write' decimate mesh.obj -o out.obj --vertices 4 --map no/such
nothing 1 'sphere.csv: ' curve good.csv -o out.csv --truth sphere.csv
nothing 1 'sphere.csv: ' curve good.csv -o out.csv --picture out.png --truth sphere.csv
nothing 1 'out.png: ' curve huge.csv -o out.obj --levels 0 --scheme four-point --picture out.png
nothing 1 'out.stl: ' mesh huge.obj -o out.stl --levels 0 --scheme loop
nothing 1 'out.csv: .*rigid' curve sphere.csv -o out.csv --to tum --picture out.png
nothing 1 'must end in' mesh mesh.obj -o out.obj --picture out
nothing 1 'must end in' surface cloud.xyz --parameterization uniform --picture out.gif --parameters out.uv
nothing 1 'must end in' shape cage -o out.obj --picture out.gif
nothing 1 'must end in' measure mesh.obj mesh.obj --picture out.gif

# Two outputs to one file, by one path or several, and outputs to what is read.
ln out.obj twin.obj 2> stderr
ln -s out.obj link.obj
mkdir -p inner
nothing 2 'overwrite' decimate mesh.obj -o out.obj --vertices 4 --map out.obj
nothing 2 'overwrite' decimate mesh.obj -o out.obj --vertices 4 --map ./inner/../out.obj
nothing 2 'overwrite' decimate mesh.obj -o new.obj --vertices 4 --map inner/../new.obj
nothing 2 'overwrite' decimate mesh.obj -o link.obj --vertices 4 --map out.obj
nothing 2 'overwrite' decimate mesh.obj -o out.obj --vertices 4 --map mesh.obj
nothing 2 'overwrite' surface cloud.xyz -o out.obj --parameters out.obj
nothing 2 'overwrite' surface cloud.xyz --parameters cloud.xyz
nothing 2 'overwrite' mesh mesh.obj -o out.png --to obj --picture out.png
nothing 2 'overwrite' shape cage -o out.png --to obj --picture out.png
nothing 2 'overwrite' curve good.csv -o sphere.csv --truth sphere.csv
nothing 2 'overwrite' curve good.csv --picture good.csv
nothing 2 'overwrite' motion good.csv -o out.csv --picture out.csv
nothing 2 'standard output' curve good.csv -o out.csv --picture -
nothing 2 'standard output' decimate mesh.obj -o out.obj --vertices 4 --map -
nothing 2 'names no format' mesh mesh.obj -o out.csv
nothing 2 'names no format' decimate mesh.obj -o out.csv --vertices 4
nothing 2 'names no format' shape cage -o out.csv
rm -f twin.obj link.obj

# A disk that is too small for the mesh but not for the map.
(
    ulimit -f 40
    "$batten" shape gear -o gear.obj --vertices 2000 --quiet --picture gear.svg 2> ../stderr
    [ $? -ne 0 ]
)
check "a mesh that does not fit the disk is reported" test $? -eq 0
check "nothing is left of it" test ! -e gear.obj -a ! -e gear.svg -a -z "$(ls -A | grep '^\.')"

# The option that leads out.
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n' > square.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\nf 1 2 3\n' > thin.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n' > fins.obj
printf '1,0,0\n0,2,0\n' > long.csv
awk '{ print } NR == 5 { print }' cloud.xyz > twice.xyz
nothing 1 'square.obj:5: .*; --triangulate cuts' mesh square.obj --strict --scheme loop -o out.obj
nothing 1 'thin.obj:4: .*; --repair drops' decimate thin.obj --strict -o out.obj --vertices 3
nothing 1 'fins.obj: .*; --repair cuts' mesh fins.obj --strict -o out.obj
nothing 1 'long.csv:2: .*; --project moves' curve long.csv --space sphere -o out.csv
nothing 1 'twice.xyz:6: .*repeats' surface twice.xyz --strict -o out.obj
nothing 1 'huge.obj: the first mesh: vertex 1' measure huge.obj mesh.obj
nothing 1 'huge.obj: the second mesh: vertex 1' measure mesh.obj huge.obj
nothing 1 'sphere.csv: ' measure good.csv sphere.csv
nothing 1 'fins.obj: [^-]*$' surface fins.obj -o out.obj

# Together.
printf 'old' > out.csv
chmod 640 out.csv
"$batten" curve good.csv -o out.csv --picture out.png --quiet 2> ../stderr
check "all outputs appear" sh -c 'head -c 4 out.png | grep -q PNG && [ "$(wc -l < out.csv)" -gt 50 ]'
check "a file that is replaced keeps its rights" test "$(stat -c %a out.csv)" = 640
check "no temporary file stays" test -z "$(ls -A | grep '^\.')"
cp good.csv place.csv
"$batten" curve place.csv -o place.csv --quiet 2> ../stderr
"$batten" curve good.csv -o apart.csv --quiet 2> ../stderr
check "a file may be replaced by its own result" same place.csv apart.csv
"$batten" curve good.csv -o - --picture out.svg > piped.csv 2> ../stderr
check "standard output is written beside a picture" same piped.csv apart.csv
"$batten" curve good.csv -o /dev/stdout --picture out.svg > piped.csv 2> ../stderr
check "/dev/stdout is standard output" same piped.csv apart.csv
"$batten" curve good.csv -o /dev/null --picture out.svg > /dev/null 2> ../stderr
check "/dev/null is written directly" test -c /dev/null -a -s out.svg
"$batten" decimate mesh.obj -o /dev/null --to obj --vertices 4 --map /dev/null > /dev/null 2> ../stderr
check "two outputs may go to a device" test $? -eq 0
mkfifo pipe.csv
cat pipe.csv > read.csv &
"$batten" curve good.csv -o pipe.csv --quiet 2> ../stderr
wait $!
check "a pipe is written directly" same read.csv apart.csv
rm pipe.csv
ln -s target.csv dangling.csv
"$batten" curve good.csv -o dangling.csv 2> ../stderr
check "a link that leads nowhere is refused" test $? -eq 1 -a ! -e target.csv
rm dangling.csv

# Signals: while the files are written, and between the first and the last of them. An open file without a name is "(deleted)".
runs() { [ "$(readlink "/proc/$1/exe")" = "$(readlink -f "$batten")" ]; }
staged() { [ -n "$(ls -A | grep '^\.batten')" ] || find "/proc/$process/fd" -lname "$PWD/*(deleted)" | grep -q .; }
stopped()
{
    signal=$1
    shift
    for file in out.obj out.png; do echo untouched > $file; done
    env --default-signal=INT,TERM,HUP "$batten" "$@" > /dev/null 2> ../stderr &
    process=$!
    tries=0
    until { runs $process && staged; } 2> /dev/null || [ $tries -eq 2000 ]; do
        sleep 0.005
        tries=$((tries + 1))
    done
    kill -"$signal" $process
    wait $process 2> /dev/null
    check "SIG$signal ends with exit code 1: batten $*" test $? -eq 1
    check "SIG$signal is reported in one line: batten $*" test "$(cat ../stderr)" = "batten: stopped"
    check "SIG$signal changes nothing: batten $*" test "$(cat out.obj out.png)" = "$(printf 'untouched\nuntouched')"
    check "SIG$signal leaves no temporary file: batten $*" test -z "$(ls -A | grep '^\.')"
}
if [ -e /proc/self/exe ]; then
    "$batten" shape gear -o gear.obj --vertices 2000 --quiet
    for signal in INT TERM HUP; do
        stopped $signal mesh gear.obj --scheme loop --levels 5 -o out.obj --picture out.png
    done
fi

# Motions.
for file in camera-keyframes.csv tensor-path.csv; do
    for options in "" "--levels 3 --velocities" "--rate 7" "--scheme hermite:order=3 --levels 2" "--tangents 4 --rate 3"; do
        # shellcheck disable=SC2086
        "$batten" curve "$examples/$file" $options -o curve.csv --json > curve.json 2> hint.txt
        # shellcheck disable=SC2086
        "$batten" motion "$examples/$file" $options -o motion.csv --json > motion.json 2> ../stderr
        check "motion gives the bytes of curve: $file $options" same curve.csv motion.csv
        check "motion gives the report of curve: $file $options" same curve.json motion.json
        check "motion gives no hint: $file $options" test ! -s ../stderr
        check "curve gives a hint: $file $options" grep -q "^batten: .*$file .*see .batten motion --help.$" hint.txt
    done
done
"$batten" curve "$examples/camera-keyframes.csv" --scheme log-exp-4 -o curve.csv --quiet 2> hint.txt
check "other schemes give no hint" test ! -s hint.txt
"$batten" motion "$examples/camera-keyframes.csv" --translation-weight 2 --rate 25 -o heavy.tum --quiet 2> ../stderr
"$batten" motion "$examples/camera-keyframes.csv" --rate 25 -o light.tum --quiet 2> ../stderr
check "frames are written at a rate" test "$(grep -c '^[-0-9]' light.tum)" -eq 251
nothing 2 'no scheme for points with tangents' motion good.csv --scheme chaikin -o out.csv
nothing 2 'no option' motion good.csv --fairness 0.5 -o out.csv
nothing 2 'exclude each other' motion good.csv --rate 5 --levels 2 -o out.csv
nothing 1 'missing.csv: cannot open' motion missing.csv -o out.csv

[ $failures -eq 0 ] && echo "outputs appear together"
[ $failures -eq 0 ]
