#!/bin/sh
# Every verb on bad input: exit code 1 (2 for a bad command line), one line on standard error that begins with "batten: " and names
# the place, nothing written, and a file that was there stays. Usage: bad-input.sh BATTEN
set -u
batten=$1
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

fail()
{
    echo "FAILED: $1"
    sed 's/^/    /' stderr
    failures=$((failures + 1))
}

# refused CODE PATTERN ARGUMENTS…: the program must end with CODE and say one line (two with the usage) that matches PATTERN.
refused()
{
    code=$1 pattern=$2
    shift 2
    echo untouched > out.csv
    rm -f out.png
    "$batten" "$@" > stdout 2> stderr < /dev/null
    got=$?
    lines=$(wc -l < stderr)
    [ $got -eq "$code" ] || fail "exit code $got instead of $code: batten $*"
    [ "$lines" -eq "$code" ] || fail "$lines lines on standard error: batten $*"
    head -n 1 stderr | grep -q '^batten: ' || fail "no 'batten: ' in front: batten $*"
    grep -Eq -e "$pattern" stderr || fail "the message does not match '$pattern': batten $*"
    [ "$(cat out.csv)" = untouched ] || fail "the output was touched: batten $*"
    [ ! -e out.png ] || fail "a picture was written: batten $*"
    [ -z "$(ls -A | grep -Ev '^(stdout|stderr|out\.csv|.*\.in.*)$')" ] || fail "files are left: $(ls -A): batten $*"
    [ ! -s stdout ] || fail "something on standard output: batten $*"
}

# full ARGUMENTS…: the program must end with 1 and say one line when standard output is a full disk.
full()
{
    "$batten" "$@" > /dev/full 2> stderr
    [ $? -eq 1 ] || fail "a full disk on standard output is not noticed: batten $*"
    [ "$(wc -l < stderr)" -eq 1 ] || fail "not one line on standard error: batten $*"
}

curve()
{
    refused 1 "$1" curve "$2" -o out.csv --picture out.png ${3:+--space "$3"}
}

printf '0,0\n1,0\nnan,1\n' > nan.in.csv
printf '0,0\n1,0\n1,inf\n' > inf.in.csv
printf '0,0\n1,0\n1\n' > short.in.csv
printf '0,0\n1,0\n1,x\n' > word.in.csv
printf '0,0\n1,0\n1e999,1\n' > overflow.in.csv
printf '0,0\n1,0\n1,0\n2,0\n' > repeated.in.csv
printf '1,0,0\n0,1,0\n0,-1,0\n' > antipodal.in.csv
printf '1,0,0\n0,2,0\n' > long.in.csv
printf '0,0\n0.5,0\n1,0\n' > rim.in.csv
printf 'time,x,y\n0,0,0\n2,1,0\n1,1,1\n' > unsorted.in.csv
printf 'x,y,t\n0,0,5\n\n0,0,0\n1,0,1\n2,1,1\n' > equal.in.csv
printf 'lon,lat,time\n0,0,0\n1,0,0\n' > tracked.in.csv
printf '# three of four\nqw,qx,qy\n1,0,0\n0,1,0\n' > keythree.in.csv
printf 'x,y,z,qx,qy,qz\n1,0,0,0,0,0\n0,1,0,0,0,0\n' > keyflux.in.csv
printf 'm11,m12,m13,m21,m22,m23,m31,m32\n1,0,0,0,1,0,0,0\n' > keyeight.in.csv
printf '0,0\n' > one.in.csv
: > empty.in.csv
printf '# nothing\n\n' > comments.in.csv
printf '{"type":"FeatureCollection","features":[]}' > none.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[1,1]' > cut.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[1,"a"]]}' > text.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[0,95]]}' > latitude.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[1e-4,0]]}' > short.in.geojson
printf '0,0\n1,0\n2,1\n' > plane.in.csv
printf '{"type":"LineString","coordinates":[[0,0],[400,5]]}' > longitude.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[180,0]]}' > antipodal.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[0,0],[1,1]]}' > repeated.in.geojson
printf '{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,1]]]}' > unclosed.in.geojson
printf 'v 0 0 0\nv 1 0 0\nl 1 3\n' > index.in.obj
printf 'v 0 0 0\nv 1 0 0\n' > noline.in.obj
printf 'v 0 0\xff 0\nl 1 1\n' > bytes.in.obj

curve 'nan\.in\.csv:3: ' nan.in.csv
curve 'inf\.in\.csv:3: ' inf.in.csv
curve 'short\.in\.csv:3: ' short.in.csv
curve 'word\.in\.csv:3: ' word.in.csv
curve 'overflow\.in\.csv:3: ' overflow.in.csv
refused 1 'repeated\.in\.csv:3: curve 0, point 2: the point repeats' curve repeated.in.csv --strict -o out.csv --picture out.png
curve 'antipodal\.in\.csv:3: .*antipodal' antipodal.in.csv sphere
curve 'long\.in\.csv:2: .*unit length; --project moves points onto the space$' long.in.csv sphere
curve 'rim\.in\.csv:3: .*disk' rim.in.csv disk
curve 'unsorted\.in\.csv:4: the time 1 does not come after 2' unsorted.in.csv
curve 'equal\.in\.csv:6: the time 1 does not come after 1' equal.in.csv
curve 'tracked\.in\.csv:3: the time 0 does not come after 0' tracked.in.csv
curve "keythree\.in\.csv:2: a quaternion needs a column 'qz'" keythree.in.csv
curve "keyflux\.in\.csv:1: a quaternion needs a column 'qw'" keyflux.in.csv
curve "keyeight\.in\.csv:1: a rotation matrix needs a column 'm33'" keyeight.in.csv
curve 'one\.in\.csv:1: an open curve' one.in.csv
curve 'empty\.in\.csv: ' empty.in.csv
curve 'comments\.in\.csv:2: ' comments.in.csv
curve 'none\.in\.geojson: ' none.in.geojson
printf '{"type":"LineString","coordinates":[[0,0],[1,1]]}\n\n{"type":"LineString","coord' > cut.in.geojsonl
curve 'cut\.in\.geojsonl:3: ' cut.in.geojsonl
refused 1 'cut\.in\.geojsonl:3: ' curve cut.in.geojsonl --topology separate -o out.geojsonl
curve 'cut\.in\.geojson:1: ' cut.in.geojson
curve 'text\.in\.geojson.*position 1' text.in.geojson
curve 'latitude\.in\.geojson.*position 1.*a latitude outside.*; --space plane takes plane coordinates$' latitude.in.geojson
curve 'longitude\.in\.geojson.*a longitude outside.*; --space plane takes plane coordinates$' longitude.in.geojson
refused 1 'the name of their system; --crs names their system, as in EPSG:25833$' curve plane.in.csv --to geojson -o out.csv
refused 1 'no extent at 2 decimals; --precision can keep more decimals$' curve short.in.geojson --precision 2 -o out.csv --to geojson
curve 'antipodal\.in\.geojson.*antipodal' antipodal.in.geojson
refused 1 'repeated\.in\.geojson.*repeats' curve repeated.in.geojson --strict -o out.csv --picture out.png
echo '{"type":"Polygon","coordinates":[[[0,0],[2,2],[2,0],[0,2],[0,0]]]}' > bow.in.geojson
refused 1 'bow\.in\.geojson: polygon 0, ring 0, near 0, 0: the edge after this point crosses or touches another one$' curve bow.in.geojson --strict -o out.csv --to geojson
refused 1 'bow\.in\.geojson: the curve crosses or overlaps itself$' \
    curve bow.in.geojson --topology separate --strict -o out.csv --to geojson
echo '{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:25833"}},"features":[
{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[9,9],[9,12],[5,12],[9,9]]]}},
{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[1.888888888888889,3.777777777777778],
[1.6666666666666667,3.8333333333333335],[3.25,4.625],[4.2,3.2],[1.9230769230769231,3.7692307692307696],[2,4],
[1.888888888888889,3.777777777777778]]]}}]}' > near.in.geojson
refused 1 'near\.in\.geojson:3: feature 1, .*: the ring touches itself within rounding; --simple never leaves it as given$' \
    curve near.in.geojson --strict -o out.csv --to geojson
curve 'unclosed\.in\.geojson' unclosed.in.geojson
curve 'index\.in\.obj:3: ' index.in.obj
curve 'noline\.in\.obj:2: ' noline.in.obj
curve 'bytes\.in\.obj:1: ' bytes.in.obj
curve '^batten: missing\.in\.csv: cannot open: No such' missing.in.csv
curve '^batten: /: cannot read: Is a' /
for device in /dev/full /dev/zero; do
    [ -c $device ] || continue
    curve "^batten: $device: cannot read: a device" $device
    refused 1 "^batten: $device: cannot read: a device" measure $device
    refused 1 "^batten: $device: cannot read: a device" mesh $device --from obj -o out.csv --to obj
    refused 1 "^batten: $device: cannot read: a device" surface $device --from xyz -o out.csv --to xml
    refused 1 "^batten: $device: cannot read: a device" curve nan.in.csv --scheme learned --model $device -o out.csv
done
# Meshes.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n' > quad.in.obj
printf '{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]}' > bare.in.gltf
printf '{"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[1]}]}' > cycle.in.gltf
printf 'glTF\002\000\000\000\377\000\000\000\000\000\000\000JSON' > short.in.glb
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > one.in.obj
refused 1 'quad\.in\.obj:5: face 0 has 4 corners; --triangulate cuts it' mesh quad.in.obj --strict --scheme loop -o out.csv --to obj
refused 1 'bare\.in\.gltf: there is no accessor 0' mesh bare.in.gltf -o out.csv --to obj
refused 1 'cycle\.in\.gltf: node 1: .*descendant' mesh cycle.in.gltf -o out.csv --to obj
refused 1 'short\.in\.glb: the file has 20 bytes, but its header tells 255' mesh short.in.glb -o out.csv --to obj
# Sanitizers reserve more memory than any limit.
if [ -z "${BATTEN_SANITIZED:-}" ]; then
    refused 1 'one\.in\.obj: .*more than the 1 GB allowed; --levels [0-9]+ fits' mesh one.in.obj --levels 15 --max-memory 1000 -o out.csv --to obj
    printf 'x,y\n0,0\n1,1\n2,0\n' > long.in.csv
    for limit in 5 10 30; do
        refused 1 'long\.in\.csv: out of memory( \([1-9][0-9]* bytes wanted\))?; use a larger --max-memory$' \
            curve long.in.csv --levels 20 --max-memory $limit -o out.csv
    done
    [ "$("$batten" mesh --help all | grep -c -e --max-memory)" -eq 1 ] || fail "mesh has two options --max-memory"
fi
# Keyframes.
# shellcheck disable=SC2059
key() { printf "time,qw,qx,qy,qz\n0,1,0,0,0\n$1"; }
key '1,nan,0,0,1\n' > keynan.in.csv
key '1,0,0,0,0\n' > keyzero.in.csv
key '1,2,0,0,0\n' > keylong.in.csv
key '1,0.6,0.8,0,0\n1,0.8,0.6,0,0\n' > keytime.in.csv
key '1,0.6,0.8,0,0\n# half a turn\n2,-0.8,0.6,0,0\n' > keyhalf.in.csv
key '1,1,0,0,0\n' > keysame.in.csv
key '1,0.6,0.8,0,0\n' > keygood.in.csv
printf 'time,qw,qx,qy\n0,1,0,0\n' > keyfew.in.csv
printf 'time,qw,qx,qy,qz,frame\n0,1,0,0,0,1\n' > keyname.in.csv
printf 'm11,m12,m13,m21,m22,m23,m31,m32,m33\n1,0,0,0,1,0,0,0,1\n1,0,0,0,1,0,0,0,1.00001\n' > keymatrix.in.csv
printf 'xx,xy,yy\n1,0,1\n1,2,1\n' > tensor.in.csv
printf '# a trajectory\n0 1 2 3 0 0 0 1\n1 1 2 3 0 0 1\n' > short.in.tum
keyframe()
{
    refused 1 "$1" curve "$2" -o out.csv --space "$3" --scheme hermite ${4:+--rate "$4"}
}
keyframe 'keynan\.in\.csv:3: ' keynan.in.csv rotation 10
keyframe 'keyzero\.in\.csv:3: .*zero' keyzero.in.csv rotation 10
keyframe 'keylong\.in\.csv:3: .*unit length' keylong.in.csv rotation 10
keyframe 'keytime\.in\.csv:4: .*after' keytime.in.csv rotation 10
keyframe 'keyhalf\.in\.csv:5: .*lines 3 and 5.*half a turn' keyhalf.in.csv rotation 10
keyframe 'keysame\.in\.csv:3: .*repeats.*lines 2 and 3' keysame.in.csv rotation
keyframe "keyfew\.in\.csv:1: .*'qz'" keyfew.in.csv rotation 10
keyframe "keyname\.in\.csv:1: .*'frame'" keyname.in.csv rotation 10
keyframe 'keymatrix\.in\.csv:3: .*not a rotation' keymatrix.in.csv rotation 10
keyframe 'tensor\.in\.csv:3: .*positive definite' tensor.in.csv spd 10
keyframe 'short\.in\.tum:3: 7 columns' short.in.tum rigid 10
keyframe 'not rotation' short.in.tum rotation 10
keyframe 'would be made' keygood.in.csv rotation 1e300
refused 1 'out\.csv: .*rigid' curve keygood.in.csv --rate 10 -o out.csv --to tum
refused 2 '--rate is 0, but must be finite and above 0' curve keygood.in.csv --rate 0 -o out.csv
refused 2 'exclude' curve keygood.in.csv --rate 10 --levels 3 -o out.csv
refused 2 'rate goes with' curve keygood.in.csv --rate 10 --scheme log-exp-4 -o out.csv
refused 2 'rate goes with' curve keygood.in.csv --rate 10 --scheme hermite:order=2 -o out.csv
refused 2 'velocities goes with' curve keygood.in.csv --velocities --scheme log-exp-4 -o out.csv
refused 2 'order' curve keygood.in.csv --scheme hermite:order=0 -o out.csv
refused 2 'order is 99, but must be from 1 to 10' curve keygood.in.csv --scheme hermite:order=99 -o out.csv
refused 2 'no scheme' curve keygood.in.csv --scheme hermite-spline -o out.csv
refused 2 '--tangents is 3, but must be resting, smooth, limited, 2 or 4' motion keygood.in.csv --tangents 3 -o out.csv
refused 2 'goes with --scheme spline' motion keygood.in.csv --scheme hermite --ends natural -o out.csv
refused 2 'by name goes with --scheme spline' motion keygood.in.csv --scheme hermite --tangents limited -o out.csv
printf '0\n1e6\n' > late.in.txt
refused 1 'time 1000000 is not within .*; --extrapolate goes on with constant velocity$' motion keygood.in.csv --times late.in.txt -o out.csv
printf '1\n0\n' > falling.in.txt
refused 1 'falling\.in\.txt:2: the time 0 does not come after 1' motion keygood.in.csv --times falling.in.txt -o out.csv
refused 2 'rate and --times exclude' motion keygood.in.csv --times late.in.txt --rate 2 -o out.csv
refused 1 'lower rate' motion keygood.in.csv --rate 1e14 -o out.csv
refused 2 'ends does not go with' curve keygood.in.csv --scheme hermite --ends free -o out.csv
refused 2 '2 or 4' curve keygood.in.csv --tangents 3 -o out.csv
refused 2 '--translation-weight is 0, but must be finite and above 0' curve keygood.in.csv --translation-weight 0 -o out.csv
printf '0,0\n1,0\n1,1\n' > good.in.csv
printf "0,0\n0.5,0\n0.5,0.5\n" > small.in.csv
printf '0,0\n1,0\n\n0,0\n0,1\n' > two.in.csv
printf '0,0\n1,0\n\n0,0\n' > single.in.csv
refused 1 'points' curve good.in.csv --levels 60 -o out.csv
refused 1 'points' curve good.in.csv --levels 44 -o out.csv
refused 1 '^batten: no/such/out\.csv: cannot write: No such' curve good.in.csv -o no/such/out.csv --picture out.png
refused 1 '^batten: no/such/out\.png: cannot write: No such' curve good.in.csv --picture no/such/out.png
refused 1 '^batten: out\.gif: .*must end in [^:]*$' curve good.in.csv --picture out.gif
refused 1 'linear scheme' curve small.in.csv --space disk --scheme six-point -o out.csv
refused 1 'missing' curve good.in.csv --truth missing.in.csv -o out.csv
refused 1 '2 curves cannot be compared with the 1 ' curve good.in.csv --truth two.in.csv -o out.csv
refused 1 'single\.in\.csv:4: curve 1: an open curve needs at least 2 points' curve single.in.csv --strict -o out.csv --picture out.png
refused 1 'angle-based' curve antipodal.in.csv --truth antipodal.in.csv --best-tension -o out.csv
refused 2 'several inputs, and --jobs, need a folder' curve good.in.csv other -o out.csv
refused 2 'missing' curve
refused 2 'no option' curve good.in.csv --level 3
refused 2 'needs a value' curve good.in.csv --levels
refused 2 'whole number' curve good.in.csv --levels 2.5
refused 2 'whole number' curve good.in.csv --levels -1
refused 2 '--max-edge is -1, but must be finite and above 0' curve good.in.csv --max-edge -1 -o out.csv
refused 2 '--tolerance is 0, but must be finite and above 0' curve good.in.csv --tolerance 0 -o out.csv
refused 2 '--tolerance is nan, but must be a finite number' curve good.in.csv --tolerance nan -o out.csv
refused 2 '--corner-angle is 0, but must be auto, or above 0 and at most 180' curve good.in.csv --corner-angle 0 -o out.csv
refused 2 '--corner-angle is 181, but must be auto, or above 0 and at most 180' curve good.in.csv --corner-angle 181 -o out.csv
refused 2 '--smooth is -3, but must be a length from 0 on, or auto' curve good.in.csv --smooth -3 -o out.csv
refused 2 'best-tension' curve good.in.csv --smooth 1 --best-tension --truth good.in.csv -o out.csv
refused 2 '--levels is 41, but must be from 0 to 40' curve good.in.csv --tolerance 1 --levels 41 -o out.csv
refused 2 'panel' curve good.in.csv --tolerance 1 --panel 1,2 --picture out.png
refused 2 'best-tension' curve good.in.csv --corner-angle 30 --best-tension --truth good.in.csv -o out.csv
refused 2 'max-edge does not go with' curve keygood.in.csv --scheme hermite --max-edge 1 -o out.csv
refused 1 'good\.in\.csv:1: the edge after point 0 needs more than the 2 levels .*; --levels' curve good.in.csv --max-edge 0.2 --levels 2 -o out.csv
refused 1 'good\.in\.csv:1: the edge after point 0 needs more than the 20 levels' curve good.in.csv --max-edge 1e-9 -o out.csv
refused 1 'order=3' curve good.in.csv --scheme chaikin --tolerance 0.1 -o out.csv
refused 1 'free ends' curve good.in.csv --closed --scheme four-point --ends free --corner-angle 30 -o out.csv
printf 'x,y,corner\n0,0,1\n1,0,yes\n' > corner.in.csv
printf 'time,x,y,corner\n0,0,0,1\n1,1,0,0\n' > cornertime.in.csv
curve "corner\.in\.csv:3: column 3: 'yes'" corner.in.csv
refused 1 'no corners' curve cornertime.in.csv --scheme hermite -o out.csv
refused 2 'no scheme' curve good.in.csv --scheme splines
refused 2 'no setting' curve good.in.csv --scheme chaikin:w=1
refused 2 'mask of 2 coefficients lies from -4 to 2, not 99' curve good.in.csv --scheme mask:1,1@99 -o out.csv
refused 2 'mask of 2 coefficients lies from -4 to 2, not -5' analyze mask:1,1@-5
refused 2 'model goes with --scheme learned' curve good.in.csv --scheme angle-4 --model good.in.csv -o out.csv
refused 2 'fairness goes with --scheme learned' curve good.in.csv --scheme angle-4 --fairness 0.5 -o out.csv
refused 2 'from 0 to 1' curve good.in.csv --fairness 1.5 -o out.csv
refused 2 'fairness' curve good.in.csv --fairness nan -o out.csv
refused 2 'fairness is 2, but must be from 0 to 1' curve good.in.csv --scheme learned:fairness=2 -o out.csv
refused 1 'good.in.csv: ' curve good.in.csv --scheme learned --model good.in.csv -o out.csv
refused 1 'none.in: cannot open' curve good.in.csv --scheme learned --model none.in -o out.csv
refused 1 'none.in: cannot open' reproduce tension-iss --model none.in
refused 2 'no row' reproduce curve-figures --model good.in.csv
refused 2 'no other curves' reproduce tension-iss --set resampled
refused 2 'no other curves' reproduce curve-figures --set published
refused 2 'one of published' reproduce tension-table1 --set stale
refused 2 'exclude' curve good.in.csv --closed --open
refused 2 'angle-based' curve good.in.csv --scheme learned --model none.in --truth good.in.csv --best-tension -o out.csv
refused 2 'given twice' curve good.in.csv --levels 2 --levels 3
refused 2 'there is no end rule' curve good.in.csv --ends none
refused 2 'json' curve good.in.csv --json -o -
refused 2 'exclude' curve good.in.csv --json --quiet
refused 2 'overwrite' curve good.in.csv -o out.csv --picture out.csv
refused 2 'overwrite' curve good.in.csv -o out.csv --picture ./out.csv
refused 2 'overwrite' curve good.in.csv -o new.svg --to csv --picture new.svg
refused 2 "no curve format .*'.dwg'" curve good.in.csv -o out.dwg
refused 2 'overwrite' curve good.in.csv -o out.csv --picture good.in.csv
refused 2 'overwrite' curve good.in.csv -o out.csv --picture small.in.csv --truth small.in.csv
refused 2 'needs --picture' curve good.in.csv -o out.csv --comb
refused 2 'needs --picture' curve good.in.csv -o out.csv --panel 0,1
refused 2 'needs --picture' curve good.in.csv -o out.csv --projection map
refused 2 'needs -o' curve good.in.csv --picture out.png --to csv
refused 2 'needs -o' curve good.in.csv --json --precision 3
refused 2 'needs --truth' curve good.in.csv -o out.csv --best-tension
refused 2 'truth needs' curve good.in.csv --truth good.in.csv
refused 2 'truth needs' curve good.in.csv --truth good.in.csv -o out.csv --quiet
refused 2 'angle-based' curve good.in.csv --truth good.in.csv -o out.csv --best-tension --scheme chaikin
refused 1 'there is no space' curve good.in.csv --space torus -o out.csv
refused 1 'missing' measure missing.in.csv good.in.csv
refused 1 'cannot be compared|coordinates' measure good.in.csv antipodal.in.csv
refused 2 'missing' measure
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > face.in.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' > beyond.in.obj
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' > flat.in.obj
refused 1 'beyond.in.obj:4' measure beyond.in.obj
refused 1 'good.in.csv' measure face.in.obj good.in.csv
refused 1 'second mesh has no area' measure face.in.obj flat.in.obj
refused 2 'geodesic is for curves' measure face.in.obj face.in.obj --geodesic
refused 2 'are for meshes' measure good.in.csv good.in.csv --samples 5
refused 2 'needs a second file' measure face.in.obj --at-vertices
refused 2 'picture needs a second file' measure face.in.obj --picture out.png
refused 2 'are for meshes' measure good.in.csv good.in.csv --picture out.png
refused 1 'no/such' measure face.in.obj face.in.obj --picture no/such/out.png
refused 1 'picture|ending|png' measure face.in.obj face.in.obj --picture out.gif
refused 2 'tolerance' measure face.in.obj face.in.obj --accuracy -1
refused 2 'no result' reproduce table99
refused 2 'needs -o FOLDER' reproduce all
refused 2 'goes with all' reproduce tension-iss --quick
refused 2 'no pictures' reproduce tension-table2 -o folder
refused 2 'no pictures' reproduce hermite-order -o folder
refused 2 'no row' reproduce hermite-order --model good.in.csv
refused 2 'no chance' reproduce hermite-figures --seed 2
refused 2 'no other curves' reproduce hermite-figures --set resampled
refused 1 'folder' reproduce hermite-figures -o good.in.csv/folder
refused 2 'no row' reproduce tension-table3 --model good.in.csv
refused 2 'no chance' reproduce tension-iss --seed 2
refused 2 'whole number' reproduce tension-table4 --seed two
mkdir solids.in
echo 'v 0 0' > solids.in/b.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 0 0 9\nv 1 0 9\nv 0 1 9\nf 4 5 6\n' > solids.in/a.obj
refused 1 'solids\.in/b\.obj:1: a vertex has' reproduce scan-solids --data solids.in
refused 1 'solids\.in/b\.obj:1: a vertex has' reproduce scan-verdict --data solids.in
rm solids.in/b.obj
refused 1 'solids\.in: no mesh is of one piece$' reproduce scan-solids --data solids.in
refused 1 'none.in: cannot open' reproduce tension-table2 --model none.in
refused 1 'none.in: cannot open' reproduce tension-mechanism --model none.in
refused 1 'good.in.csv: ' reproduce tension-mechanism --model good.in.csv
refused 1 'folder' reproduce tension-table3 -o good.in.csv/folder
refused 2 'takes no shapes' reproduce tension-table1 face.in.obj
refused 1 'no/such/fr1-xyz.txt: cannot open' reproduce motion-keyframes --data no/such
refused 2 'go with mesh-table2' reproduce motion-keyframes --vertices 7
refused 2 'needs --data FOLDER' reproduce real-curves
refused 2 'do not go with real-curves' reproduce real-curves --data . --vertices 7
refused 2 'goes with surface-clouds' reproduce real-curves --data . --clouds 7
refused 1 'no/such: the folder cannot be opened' reproduce real-curves --data no/such
refused 1 'there are no files FAMILY-truth.csv' reproduce real-curves --data .
refused 1 'none.in: cannot open' reproduce real-curves --data . --model none.in
refused 2 'needs --data FOLDER' reproduce real-meshes
refused 1 'no/such/coarse-by: the folder cannot be opened' reproduce real-meshes --data no/such
refused 2 'needs --data FOLDER' reproduce scan-verdict
refused 1 'no/such: the folder cannot be opened' reproduce scan-verdict --data no/such
refused 2 'comes without any' reproduce mesh-table2
refused 2 'not both' reproduce mesh-table2 face.in.obj --data .
refused 2 'go with mesh-table2' reproduce mesh-style --data .
refused 2 'go with mesh-ablations' reproduce mesh-table2 face.in.obj --epochs 3
refused 2 '2 shapes at most' reproduce mesh-style face.in.obj face.in.obj face.in.obj
refused 2 'two shapes' reproduce mesh-style face.in.obj
refused 2 'whole number' reproduce mesh-table2 face.in.obj --vertices 3
refused 2 'no row' reproduce mesh-ablations --model good.in.csv
refused 2 'no chance' reproduce mesh-table2 face.in.obj --seed 2
refused 1 'none.in: cannot open' reproduce mesh-table2 face.in.obj --model none.in
refused 1 'none.in.obj: cannot open' reproduce mesh-table2 none.in.obj
refused 1 'beyond.in.obj:4' reproduce mesh-ablations beyond.in.obj
refused 1 'cannot be opened' reproduce mesh-table2 --data no/folder
refused 1 'folder' reproduce mesh-ablations -o good.in.csv/folder
refused 2 'no list' list things
refused 2 'no model' train curves
refused 2 'one of published' train curve --recipe unpublished
refused 2 'one of consistency' train curve --without chamfer
refused 2 'only the published recipe' train curve --recipe batten --embedding none
refused 2 'only the published recipe' train curve --recipe batten --without bending
refused 2 'epochs' train curve --recipe batten --epochs 0
refused 1 'folder' train curve --output good.in.csv/folder
refused 1 'folder' train curve --recipe batten --output good.in.csv/folder
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n' > folded.in.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > triangle.in.obj
refused 2 'needs a SHAPE' train mesh
refused 2 'one of published' train mesh triangle.in.obj --recipe unpublished
refused 2 'two numbers' train mesh triangle.in.obj --vertices 9
refused 2 'two numbers' train mesh triangle.in.obj --vertices 3-9
refused 1 'batch' train mesh triangle.in.obj --pairs 2 --batch 3
refused 1 'none.in.obj: cannot open' train mesh none.in.obj
refused 1 'folded.in.obj: faces 0 and 1' train mesh triangle.in.obj folded.in.obj
refused 1 'folder' train mesh triangle.in.obj --output good.in.csv/folder
refused 2 'one of published' train surface --recipe unpublished
refused 2 'number, or two as in 2-5' train surface --degree 5-2
refused 2 'number, or two as in 2-5' train surface --points 50-
refused 2 'only the published recipe' train surface --recipe batten --uninformed
refused 1 '--points is 3, but must be 4' train surface --points 3
refused 1 'noise' train surface --noise -1
refused 1 'folder' train surface --output good.in.csv/folder
refused 2 'no scheme' analyze spline
refused 2 'linear|mask' analyze angle-4
refused 1 'even|odd|sum' analyze mask:1,1,1,1 --picture out.png

full --help
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > mesh.in.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n' > fins.in.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n' > repeated.in.obj
refused 2 '-o OUT is missing' decimate mesh.in.obj --vertices 3
refused 2 '--tolerance E is missing' decimate mesh.in.obj -o out.csv
refused 2 '--vertices and --tolerance exclude each other' decimate mesh.in.obj -o out.csv --to obj --vertices 3 --tolerance 1
refused 2 'vertices' decimate mesh.in.obj -o out.csv --to obj --vertices 0
refused 2 '--tolerance is nan, but must be .* above 0' decimate mesh.in.obj -o out.csv --to obj --tolerance nan
refused 2 '--ratio is 2, but must be above 0 and at most 1' decimate mesh.in.obj -o out.csv --to obj --ratio 2
refused 1 'fewer than the 999 wanted' decimate mesh.in.obj -o out.csv --to obj --faces 999
refused 2 'seed needs --random' decimate mesh.in.obj -o out.csv --vertices 3 --seed 2
refused 2 'exclude each other' decimate mesh.in.obj -o out.csv --to obj --vertices 3 --json --quiet
refused 2 '--min-quality is 2, but must be from 0 to 1' decimate mesh.in.obj -o out.csv --to obj --vertices 3 --min-quality 2
refused 2 '--bake' decimate quad.in.obj -o out.csv --to obj --vertices 3 --bake height=out.png
refused 2 '--lods' decimate quad.in.obj -o out.csv --to obj --lods 0.5,0.7
refused 2 '--map needs one mesh' decimate quad.in.obj -o out.csv --to obj --lods 0.5 --map out.map
refused 1 'no colours' decimate quad.in.obj -o out.csv --to obj --faces 2 --bake color
printf 'mtllib lost.in.mtl\nusemtl skin\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n' > lost.in.obj
refused 1 'materials lost.in.mtl: .*beside the mesh' decimate lost.in.obj -o out.csv --to obj --faces 1 --bake color
printf 'newmtl skin\nmap_Kd lost.in.png\n' > lost.in.mtl
refused 1 "file 'lost.in.png': .*without color" decimate lost.in.obj -o out.csv --to obj --faces 1 --bake color
printf 'no image' > lost.in.png
refused 1 "'lost.in.png' is not read: .*save it as PNG" decimate lost.in.obj -o out.csv --to obj --faces 1 --bake color
printf 'newmtl skin\nmap_Kd -s 2 2 0001.png\n' > lost.in.mtl
refused 1 "file '0001.png'" decimate lost.in.obj -o out.csv --to obj --faces 1 --bake color
rm lost.in.mtl lost.in.png
refused 1 'fins.in.obj: .*third at the edge.*; --repair cuts the mesh there$' decimate fins.in.obj --strict -o out.csv --to obj --vertices 3
refused 1 'no/such' decimate mesh.in.obj -o out.csv --to obj --vertices 3 --map no/such/map

refused 2 'missing' mesh
refused 2 'there is no output' mesh mesh.in.obj --quiet
refused 2 'there are learned, loop, catmull-clark, butterfly, midpoint, sqrt3' mesh mesh.in.obj -o out.csv --scheme chaikin
refused 2 'need --scheme learned' mesh mesh.in.obj -o out.csv --scheme loop --then loop
refused 2 'need --scheme learned' mesh mesh.in.obj -o out.csv --scheme butterfly --fairness 1
refused 2 'fairness' mesh mesh.in.obj -o out.obj --fairness 1.5
refused 2 "need --scheme loop or catmull-clark" mesh mesh.in.obj -o out.csv --scheme butterfly --limit
refused 2 '0 to 180' mesh mesh.in.obj -o out.csv --crease-angle 181
refused 2 'whole number' mesh mesh.in.obj -o out.csv --levels 33
refused 2 'exclude each other' mesh mesh.in.obj -o out.csv --to obj --json --quiet
refused 1 'more faces or vertices' mesh mesh.in.obj -o out.csv --to obj --levels 32
refused 1 'repeated.in.obj:4: face 0 has vertex 1, counted from 0, twice; --repair drops the face$' decimate repeated.in.obj --strict -o out.csv --to obj --vertices 3
refused 1 'repeated.in.obj:4: face 0 has vertex 1 twice; --repair drops the face$' mesh repeated.in.obj --strict -o out.csv --to obj
refused 1 'fins.in.obj: .*third at the edge.*; --repair cuts the mesh there$' mesh fins.in.obj --strict -o out.csv --to obj
refused 2 '--weld is -1, but must be 0 or a distance above it' mesh fins.in.obj --weld -1 -o out.csv --to obj
refused 1 'repeated.in.obj:4: face 0 has vertex 1, counted from 0, twice' measure repeated.in.obj --strict
{
    printf 'solid s\n'
    for z in 0 nan; do
        printf 'facet normal 0 0 1\nouter loop\nvertex 0 0 %s\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n' $z
    done
    printf 'endsolid s\n'
} > odd.in.stl
refused 1 'odd.in.stl:11: a corner of triangle 1 is not finite; --repair drops the triangle$' mesh odd.in.stl -o out.csv --to obj
refused 2 'needs --picture' mesh mesh.in.obj -o out.csv --to obj --beside loop
refused 2 'there is no mesh scheme' mesh mesh.in.obj --picture out.png --beside chaikin
refused 1 'none.in.obj: cannot open' mesh none.in.obj -o out.csv --to obj
refused 1 'mesh.in.obj: ' mesh mesh.in.obj -o out.csv --to obj --scheme learned --model mesh.in.obj

refused 2 'missing' shape
refused 2 '--to is for meshes' shape hull -o out.csv --to obj
refused 2 'unknown kind of shape' shape unicorn -o out.csv --to obj
refused 2 '--vertices is 100, but must be a whole number from 200' shape stone -o out.csv --to obj --vertices 100
refused 2 'whole number' shape stone -o out.csv --to obj --seed -1
refused 2 'there is no output' shape stone --quiet
refused 2 'exclude each other' shape cage -o out.csv --to obj --json --quiet
refused 2 'both need standard output' shape cage -o - --to obj --json
refused 2 'format' shape cage -o out.csv --to xyz
refused 1 'no/such' shape cage -o no/such/cage.obj
refused 1 'no/such' shape cage -o out.csv --to obj --picture no/such/cage.png

surface()
{
    pattern=$1
    shift
    refused 1 "$pattern" surface "$@" -o out.csv --to step --picture out.png
}

awk 'BEGIN { srand(1); for (i = 0; i < 300; i++) { u = rand(); v = rand(); print u, v, 0.1 * u * v } }' > cloud.in.xyz
awk 'NR == 8 { print "nan 0 0"; next } { print }' cloud.in.xyz > nan.in.xyz
awk 'NR == 4 { kept = $0 } NR == 9 { print kept; next } { print }' cloud.in.xyz > twice.in.xyz
head -n 3 cloud.in.xyz > three.in.xyz
: > empty.in.xyz
printf '0 0 0\n1 0 0\n1 1\n' > short.in.xyz
awk 'BEGIN { for (i = 0; i < 100; i++) print i, 2 * i, 3 * i }' > straight.in.xyz
awk '{ print } { print $1 + 5, $2, $3 }' cloud.in.xyz > two.in.xyz
awk 'BEGIN { for (i = 0; i < 600; i++) { z = (2 * i + 1) / 600 - 1; r = sqrt(1 - z * z); print r * cos(2.4 * i), r * sin(2.4 * i), z } }' > sphere.in.xyz
awk '{ print } { print $1 + 5, $2, $3 }' sphere.in.xyz > spheres.in.xyz
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' > closed.in.obj
surface 'empty.in.xyz: there are no points' empty.in.xyz
surface 'three.in.xyz: a surface patch needs at least four points' three.in.xyz
surface 'nan.in.xyz:8: point 7 is not finite' nan.in.xyz
surface 'short.in.xyz:3: point 2 has no z' short.in.xyz
surface 'twice.in.xyz:9: .* line 4' twice.in.xyz --strict
surface 'straight.in.xyz: no boundary loop' straight.in.xyz
surface 'two.in.xyz: .*several pieces' two.in.xyz
refused 2 'a shell has patches, not functions' surface sphere.in.xyz --shell --functions 100 -o out.step
surface 'sphere.in.xyz: no boundary loop.*--shell' sphere.in.xyz --corners 0,1,2,3
surface 'spheres.in.xyz: .*several pieces.*--shell' spheres.in.xyz --corners 0,1,2,3
surface 'closed.in.obj: .*closed' closed.in.obj --corners 0,1,2,3
surface 'none.in.xyz: cannot open' none.in.xyz
surface '^batten: cloud.in.xyz: the weight of smoothing 1e\+308 is out of range' cloud.in.xyz --parameterization uniform --smoothing 1e308
surface '--functions is 8, but must be 0 or at least the 16' cloud.in.xyz --functions 8
surface '--functions is 15, but must be 0 or at least the 16' cloud.in.xyz --functions 15 --degree 3
surface 'boundary of 301 points' cloud.in.xyz --boundary 301
surface "boundary's file: cannot open" cloud.in.xyz --boundary none.in.xyz
surface 'corner 1000 is not a boundary point' cloud.in.xyz --corners 1000,0,1,2
surface 'need the triangles' cloud.in.xyz --parameterization mean-value
surface 'none.in.uv: cannot open' cloud.in.xyz --parameterization none.in.uv
surface 'empty.in.xyz: 0 rows of parameters for 300 points' cloud.in.xyz --parameterization empty.in.xyz
surface 'cloud.in.xyz:1: .*more than u and v' cloud.in.xyz --parameterization cloud.in.xyz
surface 'cloud.in.xyz: ' cloud.in.xyz --model cloud.in.xyz
"$batten" surface cloud.in.xyz --parameterization uniform --functions 20 --force -o fit.in.xml --quiet
head -c 900 fit.in.xml > truncated.in.xml
surface 'truncated.in.xml:[0-9]+: ' truncated.in.xml
surface 'empty.in.xml: cannot open' empty.in.xml
refused 1 'no/such' surface cloud.in.xyz --parameterization uniform -o no/such/fit.step
refused 1 'no/such' surface cloud.in.xyz --parameterization uniform --parameters no/such/fit.uv
refused 2 'missing' surface
refused 2 '--tolerance is -1, but must be finite and above 0' surface cloud.in.xyz --tolerance -1
refused 2 '--tolerance is 0, but must be finite and above 0' surface cloud.in.xyz --tolerance 0
refused 2 'fill-holes goes with --trim' surface cloud.in.xyz --fill-holes 1
refused 2 'crease-angle goes with shells' surface cloud.in.xyz --trim --crease-angle 20
refused 2 'exclude each other' surface cloud.in.xyz --trim --parameterization learned
refused 2 'unit' surface cloud.in.xyz --unit cubit
refused 2 "--tolerance is 'x', but must be a finite number" surface cloud.in.xyz --tolerance x
refused 2 '--share is 1.5, but must be' surface cloud.in.xyz --tolerance 1 --share 1.5
refused 2 'share needs' surface cloud.in.xyz --share 0.9
refused 2 'exclude each other' surface cloud.in.xyz --noise 1 --smoothing 1
refused 2 'two as in 3,2' surface cloud.in.xyz --degree 0
refused 2 'two as in 3,2' surface cloud.in.xyz --degree 3,
refused 2 'two as in 3,2' surface cloud.in.xyz --degree 3,16
refused 2 'number of points from 4' surface cloud.in.xyz --boundary 3
refused 2 'four numbers' surface cloud.in.xyz --corners 1,2,3
refused 2 'there is no parameterization .fancy.; there are auto' surface cloud.in.xyz --parameterization fancy
refused 2 'goes with auto and learned' surface cloud.in.xyz --parameterization uniform --model good.in.csv
refused 2 'there are chord-length, centripetal, uniform' surface cloud.in.xyz --sides short
refused 2 "ending of .out.csv. names no format" surface cloud.in.xyz -o out.csv
refused 2 'no surface format' surface cloud.in.xyz -o out.csv --to brep
refused 2 'no cloud format' surface cloud.in.xyz --from dae
refused 2 'both need standard output' surface cloud.in.xyz -o - --to step --json
refused 2 'there is no output' surface cloud.in.xyz --quiet
refused 2 'surface already: --tolerance goes with points' surface fit.in.xml --tolerance 1

refused 2 'needs --data FOLDER with nefertiti' reproduce surface-nefertiti
refused 2 'needs --data FOLDER with face' reproduce surface-face
refused 1 'no/such/nefertiti-532.xyz: cannot open' reproduce surface-nefertiti --data no/such --json
refused 2 'makes its clouds itself' reproduce surface-shapes --data .
refused 2 'needs both --model and --uninformed' reproduce surface-ablation --model good.in.csv
refused 2 'uninformed goes with' reproduce surface-clouds --uninformed good.in.csv
refused 2 "--points is '50,x', but must be up to" reproduce surface-clouds --points 50,x
refused 2 '--degrees is 16, but must be up to' reproduce surface-clouds --degrees 16
refused 2 'go with surface-clouds' reproduce surface-shapes --noise 0
refused 2 'clouds goes with' reproduce mesh-style --clouds 3
refused 1 'good.in.csv: ' reproduce surface-clouds --model good.in.csv

full --version
full help list
full list schemes
full list spaces --json
full analyze chaikin
full analyze chaikin --json
full analyze four-point --sweep w=0.05:0.07
full measure good.in.csv
full measure good.in.csv small.in.csv --json
full curve good.in.csv
full curve good.in.csv -o out.csv
full curve good.in.csv --json
full shape cage
full shape cage -o - --to obj
full reproduce tension-iss
full reproduce hermite-order

"$batten" help nothing > stdout 2> stderr
[ $? -eq 2 ] && grep -q "no verb 'nothing'" stderr || fail "batten help nothing"

# Limits end the program with one line, whatever its libraries wait for.
refused 1 'the time of --max-seconds is over' reproduce hermite-order --max-seconds 0.05
"$batten" shape mask --vertices 300 -o limit.in.obj --quiet
# A limit and a call are lists of words.
# shellcheck disable=SC2086
for limit in '-v 200000' '-d 60000'; do
    (
        ulimit $limit
        for verb in 'list schemes' 'measure good.in.csv' 'surface cloud.in.xyz -o limited.step' 'shape cage --max-memory 300' \
            'curve good.in.csv -o limited.csv' 'motion good.in.csv -o limited.csv' 'mesh one.in.obj -o limited.ply --quiet' \
            'decimate limit.in.obj --vertices 100 -o limited.ply' 'measure limit.in.obj' 'analyze chaikin' 'completion bash' 'manual curve' \
            'shape mask --vertices 300 -o limited.obj' 'reproduce tension-iss -o limited' 'curve good.in.csv --picture limited.png' \
            'train curve --epochs 1 -o limited --max-seconds 2' 'train surface --epochs 1 -o limited --max-seconds 2'; do
            timeout -s KILL 60 "$batten" $verb > stdout 2> stderr
            code=$?
            [ $code -le 1 ] && [ "$(wc -l < stderr)" -le 1 ] && ! grep -q libgomp stderr || echo "ulimit $limit, batten $verb: exit $code" >> limits
        done
    )
done
[ ! -s limits ] || fail "$(cat limits)"
rm -rf limits limited*

[ $failures -eq 0 ] && echo "all bad input is refused"
[ $failures -eq 0 ]
