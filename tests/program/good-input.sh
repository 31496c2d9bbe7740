#!/bin/sh
# What the program promises beyond what the library's tests say: pipes, formats by ending, JSON and nothing else, signals, progress.
# Usage: good-input.sh BATTEN EXAMPLES MODELS
set -u
batten=$1
examples=$2
models=$3
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
folder=$(pwd -P)
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

printf 'x,y,corner\n# closed\n0,0,1\n4,0,1\n4,3,1\n2,3.7,0\n0,3,1\n' > house.csv
"$batten" curve house.csv --levels 1 -o walls.csv --json > walls.json
check "corners survive, with new points between them" sh -c "grep -c ',1$' walls.csv | grep -q '^4$'"
check "an edge between corners stays straight" grep -q '^2,0,0$' walls.csv
check "the report counts corners" json walls.json '"corners": 4'
"$batten" curve "$examples/iss-track.geojson" --max-edge 200000 --tolerance 1000 -o dense.geojson > dense.txt
check "stops are metres on the sphere" grep -q 'levels, pieces up to 200000 m, within 1000 m of the limit' dense.txt
"$batten" curve "$examples/outline.csv" --tolerance 0.01 --threads 1 -o one.csv --quiet
"$batten" curve "$examples/outline.csv" --tolerance 0.01 --threads 4 -o four.csv --quiet
check "a tolerance gives the same bytes for any number of threads" same one.csv four.csv
"$batten" curve "$examples/coast-detailed.geojson" --smooth 20000 --levels 1 -o calm.geojson > calm.txt
check "smoothing tells its moves in metres" grep -Eq '^smoothed: points moved by [0-9.]+ m on average, by [0-9.e+]+ m at most$' calm.txt
"$batten" curve "$examples/coast-detailed.geojson" --smooth auto --levels 1 -o calm.geojson --json > calm.json
check "smoothing estimates the noise" json calm.json '"noise": [1-9]'

for _ in 1 2 3 4 5; do
    tr -d '\n' < "$examples/coast.geojson" | sed 's/^.*"features": *\[//; s/\] *} *$//'
    echo
done > coasts.geojsonl
"$batten" curve - --levels 2 --topology separate -o whole.geojsonl < coasts.geojsonl > whole.txt
"$batten" curve coasts.geojsonl --levels 2 -o parts.geojsonl --topology separate > parts.txt
check "a sequence goes through memory part by part with the same result" same parts.geojsonl whole.geojsonl
check "and with the same report" same parts.txt whole.txt
"$batten" curve - --from geojsonl --levels 2 --topology separate < coasts.geojsonl > parts.geojsonl
check "a sequence is piped" same parts.geojsonl whole.geojsonl
check "a sequence has a feature a line" test "$(wc -l < whole.geojsonl)" -eq 5
"$batten" curve "$examples/iss-track.geojson" --levels 3 -o track.geojson --quiet
check "properties survive" grep -q '"inclination":51.64' track.geojson
"$batten" curve "$examples/iss-track.geojson" --levels 3 -o track.csv --quiet
check "the ending decides the format" sh -c "sed 's/[^,]//g' track.csv | tail -1 | grep -q '^,,*$'"
"$batten" curve "$examples/camera-path.obj" --to csv --levels 1 > path.csv
check "an open curve of 10 points has 19 after a level" test "$(grep -c '^[-0-9]' path.csv)" -eq 19

"$batten" curve "$examples/camera-keyframes.csv" --rate 25 -o frames.tum --quiet
check "ten seconds are 251 frames" test "$(grep -c '^[-0-9]' frames.tum)" -eq 251
check "a keyframe is a frame" grep -q '^4 -0.7814 4.4316 2.4 ' frames.tum
cp frames.tum frames.txt
"$batten" curve frames.txt --space rigid --rate 25 -o again.txt --quiet
check "a trajectory may be a .txt file, and stays one" same again.txt frames.tum
printf '1311868171.131477 0 0 0 0 0 0 1\n1311868172.331406 1 0 0 0 0 0 1\n' > stamps.txt
cp stamps.txt stamps.tum
for name in stamps.txt stamps.tum -; do
    "$batten" motion "$name" --levels 0 --quiet --to tum < stamps.txt > whole.tum 2> stderr
    check "$name keeps whole seconds" grep -q '^1311868171.131477000 ' whole.tum
done
"$batten" curve "$examples/camera-keyframes.csv" --levels 2 -o levels.csv --quiet
check "keyframes are refined with their times" grep -q '^4,-0.7814,4.4316,2.4,' levels.csv
for scheme in hermite:order=3 log-exp-4 geodesic:order=2; do
    for file in camera-keyframes tensor-path; do
        "$batten" curve "$examples/$file.csv" --levels 3 --scheme $scheme -o scheme.csv --json > scheme.json
        check "$scheme refines $file" json scheme.json '"refined"'
    done
done
"$batten" curve "$examples/tensor-path.csv" --rate 4 --velocities > tensors.csv
check "velocities are written when asked for" grep -q '^time,xx,xy,xz,yy,yz,zz,vxx,vxy,vxz,vyy,vyz,vzz$' tensors.csv
check "the scheme list has the Hermite schemes" sh -c "'$batten' list schemes | grep -q '^hermite '"
check "the space list has the manifolds" sh -c "'$batten' list spaces | grep -q '^rigid'"

"$batten" curve "$examples/outline.csv" --json -o out.csv > report.json
check "the report of curve is JSON" json report.json '"bending"'
"$batten" measure out.csv "$examples/outline.csv" --json > measure.json
check "measure prints JSON" json measure.json '"hausdorff"'

printf '0,0\n8,0\n8,6\n5,6\n5,1\n4.5,1\n4.5,6\n0,6\n' > strait.csv
"$batten" curve strait.csv --closed --scheme six-point -o apart.csv > strait.txt
check "rings stay simple" grep -q '^kept simple: 1 of 1 curves .* 2 edges were drawn back$' strait.txt
check "a kept ring is simple" sh -c "'$batten' measure apart.csv | grep -q '^A is simple  *yes$'"
"$batten" curve strait.csv --closed --scheme six-point --simple never -o across.csv --json > strait.json
check "without the test nothing is checked" json strait.json '"checked": 0'
"$batten" measure across.csv --json > across.json
check "a ring may cross itself" json across.json '"simple": 0'
"$batten" curve strait.csv --open --scheme six-point -o open.csv --json > open.json
check "open curves are not tested" json open.json '"checked": 0'
"$batten" curve strait.csv --open --scheme six-point --simple always -o open.csv --json > open.json
check "open curves are tested when it is asked for" json open.json '"checked": 1'

printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' > pyramid.obj
printf 'OFF\n4 2 0\n0 0 3\n1 0 3\n1 1 3\n0 1 3\n3 0 1 2\n3 0 2 3\n' > square.off
"$batten" measure pyramid.obj --json > pyramid.json
check "an OBJ file of faces is a mesh" json pyramid.json '"genus": 0'
check "a mesh has its figures" sh -c '"$1" measure square.off | grep -q "boundary loops  *1$"' sh "$batten"
for ending in $("$batten" list formats | sed -n 's/^\([a-z0-9]*\) .*meshes: .*/\1/p'); do
    "$batten" mesh pyramid.obj --scheme midpoint --levels 0 -o "whole.$ending" --quiet
    cp "whole.$ending" whole
    "$batten" measure "whole.$ending" --json > known.json
    "$batten" measure whole --json > recognized.json
    check "measure recognizes the content of $ending" same known.json recognized.json
done
printf '{"type":"LineString","coordinates":[[0,0],[1,1],[2,1]]}' > line
check "GeoJSON is no glTF" sh -c '"$1" measure line | grep -q "bending energy"' sh "$batten"
"$batten" measure pyramid.obj square.off --json > distance.json
check "the distance of two meshes" json distance.json '"hausdorff_from_first": 3.0'
"$batten" measure --mesh - square.off --json < pyramid.obj > again.json
check "a mesh from standard input gives the same" same distance.json again.json
"$batten" measure square.off square.off --at-vertices --json > vertices.json
check "vertices alone prove nothing" json vertices.json '"hausdorff_bound": null'
"$batten" analyze chaikin --json > analyze.json
check "analyze prints JSON" json analyze.json '"mask"'
"$batten" list schemes --json > list.json
check "list prints JSON" json list.json '"log-exp-4"'
if [ -n "${BATTEN_LONG_TESTS:-}" ]; then
    "$batten" reproduce hermite-order --json > order.json
    check "reproduce hermite-order prints JSON" json order.json '"sphere x disk"'
fi
"$batten" reproduce hermite-figures --json -o hermite > hermite.json
check "reproduce hermite-figures prints JSON" json hermite.json '"transport of directions"'
for figure in tensors orders spiral rotations; do
    check "figure $figure is drawn" test -s "hermite/hermite-$figure.svg" -a -s "hermite/hermite-$figure.png"
done
"$batten" reproduce tension-iss --json > iss.json
check "reproduce prints JSON" json iss.json '"four-point-outward"'
# Minutes under sanitizers, where test_tension_table runs the same.
if [ -n "${BATTEN_LONG_TESTS:-}" ]; then
    "$batten" reproduce tension-table1 --set unseen --json > unseen.json
    check "a table is taken on other curves" json unseen.json '"curves": 300'
    check "other curves have no published figures" sh -c '! grep -q published_mean_nn unseen.json'
fi

# learned_rows FILE SPACE: the fairnesses of a table's learned rows in a space, and "published" for the published network.
learned_rows()
{
    awk -v space="\"$2\"," '$1 == "\"space\":" { here = $2 == space; method = "" }
        $1 == "\"method\":" { method = $2 }
        here && method == "\"learned-published\"," && $1 == "\"curves\":" { printf "published " }
        here && method == "\"learned\"," && $1 == "\"fairness\":" { printf "%g ", $2 }' "$1"
}
for space in plane sphere disk; do
    [ -e unseen.json ] || break
    check "table 1 has the learned rows in the $space" test "$(learned_rows unseen.json $space)" = "published 0 0.25 0.5 0.75 1 "
done
check "table 5 has the learned rows" test "$(learned_rows iss.json sphere)" = "published 0 0.25 0.5 0.75 1 "
check "the published network has published figures on the track" sh -c 'grep -A 12 learned-published iss.json | grep -q published_g1'
for model in batten tension-published; do
    "$batten" reproduce tension-iss --json --model "$models/$model.safetensors" > model.json
    check "the program holds $model.safetensors" same model.json iss.json
done

"$batten" curve "$examples/hyperbolic.csv" --space disk -o disk.csv --picture disk.png --panel 0,1,3 > /dev/null
check "a picture is a PNG file" grep -q PNG disk.png
"$batten" curve "$examples/outline.csv" --levels 4 --scheme angle-6 -o truth.csv --quiet
"$batten" curve "$examples/outline.csv" --levels 4 --truth truth.csv --best-tension -o best.csv > best.txt
check "the tension search finds the truth's own tension" grep -q 'angle:mu=-0.25\b' best.txt

# What a process is doing, as far as /proc tells: it runs the program; it has computed for a fifth of a second; it has the pipe open;
# it writes a file in this folder; it trains.
runs() { [ "$(readlink "/proc/$1/exe")" = "$(readlink -f "$batten")" ]; }
computes() { [ "$(cut -d ' ' -f 14 "/proc/$1/stat")" -gt 20 ]; }
at_pipe() { ls -l "/proc/$1/fd" | grep -q "$folder/pipe"; }
writes() { ls -l "/proc/$1/fd" | grep -q "$folder/[#.]"; }
trains() { [ -s trainings/seed-1/full/log.csv ]; }

# signalled SIGNAL WHEN ARGUMENTS…: start the program and send it the signal once WHEN (of the above) holds, after ten seconds at
# most. It must end with exit code 1 and one line, leave what was there alone and nothing else behind.
signalled()
{
    signal=$1 when=$2
    shift 2
    echo untouched > out.csv
    touch stdout stderr
    ls -A > before
    env --default-signal=INT,TERM,HUP "$batten" "$@" > stdout 2> stderr 3>&- &
    process=$!
    tries=0
    until { runs $process && $when $process; } 2> /dev/null || [ $tries -eq 500 ]; do
        sleep 0.02
        tries=$((tries + 1))
    done
    kill -"$signal" $process
    wait $process 2> /dev/null
    check "SIG$signal ends batten $*" test $? -eq 1
    check "SIG$signal is reported in one line: batten $*" test "$(cat stderr)" = "batten: stopped"
    check "SIG$signal leaves the output alone: batten $*" test "$(cat out.csv)" = untouched
    check "SIG$signal leaves no files behind: batten $*" test "$(ls -A | grep -v '^before$')" = "$(grep -v '^before$' before)"
}

if [ -e /proc/self/fd ]; then
    mkfifo pipe.csv
    exec 3<> pipe.csv
    signalled INT computes curve "$examples/outline.csv" --scheme angle-4:adaptive=1 --levels 22 --threads 1 -o out.csv
    signalled INT at_pipe curve pipe.csv -o out.csv
    signalled INT at_pipe measure pipe.csv
    signalled INT at_pipe curve "$examples/outline.csv" --levels 12 -o pipe.csv
    exec 3>&-
    # A training that is stopped keeps where it stands.
    env --default-signal=INT "$batten" reproduce tension-table3 -o trainings > stdout 2> stderr &
    process=$!
    tries=0
    until { runs $process && trains; } 2> /dev/null || [ $tries -eq 500 ]; do
        sleep 0.02
        tries=$((tries + 1))
    done
    kill -INT $process
    wait $process 2> /dev/null
    check "SIGINT ends a training" test $? -eq 1
    check "a stopped training has a checkpoint" test -s trainings/seed-1/full/checkpoint.safetensors
    # Elsewhere the file has a name from the beginning, which stays behind.
    case $(stat -f -c %T .) in ext2/ext3 | xfs | btrfs | tmpfs)
        for signal in INT TERM HUP; do
            signalled $signal writes curve "$examples/outline.csv" --levels 18 -o out.csv
        done
        ;;
    esac
fi

# A terminal sees each percentage once, and the line goes away.
awk 'BEGIN { for (i = 0; i < 3000; i++) print "0,0\n1,0\n1,1\n" }' > many.csv
if script -qec true drawn.txt > stderr 2>&1; then
    script -qec "'$batten' curve many.csv --levels 6 -o drawn.csv --quiet" drawn.txt > /dev/null
    check "progress is drawn on a terminal" grep -q 'refining' drawn.txt
    check "progress is drawn once a percent" test "$(tr '\r' '\n' < drawn.txt | grep -c '^refining')" -le 101
else
    echo "skipped: no pseudo-terminal can be made here, so that progress on a terminal is not tested: $(head -n 1 stderr)"
fi
"$batten" curve many.csv --levels 6 -o drawn.csv --quiet 2> stderr
check "progress is not drawn into a file" test ! -s stderr
"$batten" curve many.csv --levels 1 -o drawn.csv > many.txt
check "the report of many curves says what its numbers are" grep -q 'total points.*mean bending.*largest angle' many.txt
"$batten" curve many.csv --levels 1 --truth many.csv -o drawn.csv --json > many.json
check "many curves have a distance to many truths" json many.json '"mean_nn"'

"$batten" curve "$examples/outline.csv" --json > alone.json
check "--json alone reports and writes no curves" same alone.json report.json

"$batten" reproduce tension-table2 --seed 2 --json > noise.json
check "tension-table2 --json has published figures beside ours" json noise.json '"published_g1"'

# Orders with equal exponents share a line.
"$batten" analyze lane-riesenfeld:order=40 > spline.txt
check "equal exponents share a line" grep -q 'orders 0 to 38: Hölder exponent 1, both bounds' spline.txt

# A torus of 20 by 10 cells whose texture coordinates are its vertices' numbers.
awk 'BEGIN {
    for (i = 0; i < 20; i++) for (j = 0; j < 10; j++) {
        u = i * 0.314159265; v = j * 0.628318531
        print "v", (1 + 0.4 * cos(v)) * cos(u), (1 + 0.4 * cos(v)) * sin(u), 0.4 * sin(v)
        print "vt", i / 20, j / 10
    }
    for (i = 0; i < 20; i++) for (j = 0; j < 10; j++) {
        a = i * 10 + j + 1; b = (i + 1) % 20 * 10 + j + 1; c = (i + 1) % 20 * 10 + (j + 1) % 10 + 1; d = i * 10 + (j + 1) % 10 + 1
        print "f", a "/" a, b "/" b, c "/" c
        print "f", a "/" a, c "/" c, d "/" d
    }
}' > torus.obj
"$batten" decimate torus.obj -o coarse.obj --vertices 50 --map map.safetensors --json > decimate.json
check "decimate --json says what is left" json decimate.json '"reached": true'
check "200 vertices give 50, a torus has twice as many faces" test "$(grep -c '^v ' coarse.obj) $(grep -c '^f ' coarse.obj)" = "50 100"
check "texture coordinates go along" test "$(grep -c '^vt ' coarse.obj)" -ge 50
check "the map is written" test -s map.safetensors
"$batten" decimate torus.obj -o - --to obj --vertices 50 < /dev/null > piped.obj
check "standard output gives the same bytes" same piped.obj coarse.obj
"$batten" decimate - --from obj -o random.obj --vertices 50 --random 100 --seed 7 < torus.obj > /dev/null
"$batten" decimate torus.obj -o again.obj --vertices 50 --random 100 --seed 7 --quiet
check "the same seed gives the same bytes" same random.obj again.obj
"$batten" decimate torus.obj -o again.obj --vertices 50 --random 100 --seed 8 --quiet
check "another seed gives others" sh -c '! cmp -s random.obj again.obj'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n' > fins.obj
"$batten" decimate torus.obj -o asset.gltf --method even --ratio 0.2 --bake normal=normal.png --size 128 --json > decimate.json
check "normals are baked into a file" test -s normal.png
check "and into glTF, with tangents" sh -c 'grep -q data:image/png asset.gltf && grep -q TANGENT asset.gltf'
check "the report tells how far they are" json decimate.json '"normal_turn": [0-9]'
{
    printf '%s' '{"asset":{"version":"2.0"},"buffers":[{"byteLength":48,"uri":"data:;base64,AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAQAAAAEAAAAAA"}],'
    printf '%s' '"bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12}],"accessors":[{"type":"VEC3","componentType":5126,"bufferView":0,"count":4},'
    printf '%s' '{"type":"VEC2","componentType":5126,"bufferView":0,"count":4}],"images":[{"uri":"wall.png"}],"textures":[{"source":0}],'
    printf '%s' '"materials":[{"name":"wall","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],'
    printf '%s' '"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"mode":5,"material":0}]}]}'
} > wall.gltf
"$batten" decimate wall.gltf -o again.gltf --faces 2 --bake normal --size 32 > notes.txt
check "a note tells that an atlas costs a material its images" grep -q '^note: images of materials are left out but for baked ones: an atlas' notes.txt
check "the material keeps its name" grep -q '"name":"wall"' again.gltf
printf 'mtllib skin.mtl\nusemtl skin\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n' > skin.obj
for i in 1 2 3 4 5 6; do
    cp normal.png skin$i.png
    printf 'newmtl skin\nmap_Kd skin%s.png\n' $i
done > skin.mtl
"$batten" decimate skin.obj -o skin.glb --faces 1 --bake color=skin.png --size 16 > notes.txt
check "of a material that is told several times the last image counts" test -s skin.png
"$batten" decimate torus.obj -o chain.gltf --lods 1,0.5,0.25 > /dev/null
check "levels of detail are in one file" grep -q '"MSFT_lod":{"ids":\[1,2\]}' chain.gltf
{
    printf 'mtllib skin.mtl\nusemtl skin\n'
    cat torus.obj
} > skin.obj
printf 'newmtl bone\nKd 1 0 0\nnewmtl skin\nKd 0 0 0\nmap_Kd -clamp on -s 1 1 1 normal.png\n' > skin.mtl
"$batten" decimate skin.obj -o skin.gltf --lods 0.5,0.25 --transfer --bake color=skin.png --size 128 > /dev/null
check "the image of a material is baked into one of the same colours" test "$(wc -c < skin.png)" -gt 2000
check "and serves all levels" sh -c 'grep -q "MSFT_lod" skin.gltf && test "$(grep -o TEXCOORD_0 skin.gltf | wc -l)" = 2'
printf 'v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 1 0\nv 1 1 0 0 0 1\nf 1 2 3\nf 2 4 3\n' > painted.obj
"$batten" decimate painted.obj -o painted.gltf --faces 2 --bake color --size 32 > /dev/null
check "baked colours replace those of the vertices" sh -c 'grep -q baseColorTexture painted.gltf && ! grep -q COLOR_0 painted.gltf'
"$batten" decimate fins.obj -o again.obj --vertices 9 > notes.txt
check "what is harmless is repaired with a note" grep -q '^note: repaired: 1 edges of more than two faces' notes.txt
printf 'v 0 0 0 1 1 nan\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\nf 1 1 2\n' > odd.obj
"$batten" measure odd.obj > notes.txt
check "measure notes values that are not finite" grep -q '^note: 1 values that are not finite were set to 0' notes.txt
check "and faces with a vertex twice" grep -q '^note: repaired: 1 faces with a vertex twice were dropped' notes.txt
check "--repair splits what is no manifold" "$batten" decimate fins.obj -o again.obj --vertices 9 --repair --quiet

"$batten" mesh torus.obj -o fine.obj --quiet
"$batten" mesh torus.obj -o - --to obj --threads 1 > piped.obj
check "mesh gives the same bytes to a pipe and with one thread" same piped.obj fine.obj
for scheme in loop butterfly midpoint; do
    "$batten" mesh torus.obj -o fine.ply --scheme $scheme --levels 1 --json > mesh.json
    check "mesh --json says what is made by $scheme" json mesh.json "\"scheme\": \"$scheme\""
done
check "a level makes four faces of one" test "$(sed -n 's/.*"faces": \([0-9]*\).*/\1/p' mesh.json | tr '\n' ' ' | awk '{print $2 / $1}')" = 4
"$batten" mesh torus.obj --levels 1 --limit --crease-angle 80 --picture mesh.png --quiet
check "mesh draws a picture" sh -c 'head -c 4 mesh.png | grep -q PNG'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n' > textured.obj
"$batten" mesh textured.obj -o fine.obj --scheme sqrt3 --quiet 2> note.txt
check "sqrt3 says that texture is left out" grep -q 'left out' note.txt
"$batten" mesh torus.obj -o round.obj --levels 2 --quiet
mkdir shapes
cp round.obj shapes/ring.obj
cp round.obj shapes/coarse-ring.obj
cp torus.obj shapes/small.obj
cp round.obj shapes/spot.obj
"$batten" reproduce mesh-table2 --data shapes --json -o table > table.json 2> note.txt
check "mesh-table2 --json has its rows" json table.json '"mean_distance"'
check "mesh-table2 compares three schemes" test "$(sed -n 's/.*"scheme": "\([a-z]*\)".*/\1/p' table.json | tr '\n' ' ')" = "loop butterfly learned "
check "what was learned from and what is coarse is left out" sh -c '! grep -q "spot\|coarse-ring" table.json'
check "a small shape is left out and said to be" sh -c 'grep -q "small.obj: left out" note.txt && grep -q "\"small\"" table.json'
check "mesh-table2 draws a picture" sh -c 'head -c 4 table/ring.png | grep -q PNG'
"$batten" reproduce mesh-table2 round.obj --vertices 300 > table.txt
check "mesh-table2 shows the published ratios" grep -q '^Victoria ' table.txt
if [ -n "${BATTEN_LONG_TESTS:-}" ]; then
    "$batten" reproduce mesh-ablations torus.obj torus.obj -o ablations --epochs 1 --pairs 1 --json > ablations.json
    check "mesh-ablations --json has every variant" json ablations.json '"learn-loop"'
fi
"$batten" reproduce mesh-style torus.obj torus.obj -o style --epochs 1 --pairs 1 > style.txt
check "mesh-style draws a picture" sh -c 'head -c 4 style/style.png | grep -q PNG'
check "mesh --repair splits what is no manifold" "$batten" mesh fins.obj -o fine.obj --repair --quiet
check "list schemes names those for meshes" sh -c "'$batten' list schemes | grep -q '^butterfly'"

"$batten" shape gear -o gear.ply --vertices 2000 --seed 7 --json > gear.json
check "shape --json says what is made" json gear.json '"seed": 7'
"$batten" shape gear -o - --to ply --vertices 2000 --seed 7 > piped.ply
check "the same seed gives the same shape, to a pipe too" same piped.ply gear.ply
"$batten" shape gear -o other.ply --vertices 2000 --seed 8 --quiet
check "another seed gives another shape" sh -c '! cmp -s other.ply gear.ply'
check "a shape is a closed manifold" sh -c "'$batten' measure gear.ply | grep -Eq '^closed +yes'"
"$batten" shape cage -o cage.obj --picture cage.png > cage.txt
check "a cage has its own number of vertices" grep -qx 'cage: 162 vertices, 320 faces' cage.txt
check "shape draws a picture" sh -c 'head -c 4 cage.png | grep -q PNG'
check "a cloud is a shape" sh -c "'$batten' shape hull -o hull.xyz --vertices 500 --json | grep -q '\"points\": 500'"
check "a cloud's file says its boundary" sh -c 'head -n 1 hull.xyz | grep -q "boundary points first"'
check "a cloud is drawn" sh -c "'$batten' shape scan --vertices 500 --picture scan.png --quiet && head -c 4 scan.png | grep -q PNG"
"$batten" shape map --countries 12 --detail 1 -o map.geojson --picture map.png --quiet
check "a map is a shape" sh -c 'grep -c "\"kind\":\"country\"" map.geojson | grep -qx 9 && head -c 4 map.png | grep -q PNG'
"$batten" shape map --countries 12 --detail 1 -o - > piped.geojson
check "the same seed gives the same map, to a pipe too" same piped.geojson map.geojson
"$batten" mesh cage.obj --levels 1 --picture alone.png --quiet
"$batten" mesh cage.obj --levels 1 --picture beside.png --beside butterfly --quiet
check "mesh --beside draws one more mesh" sh -c '! cmp -s alone.png beside.png'
"$batten" mesh cage.obj -o fine.ply --quiet
"$batten" measure fine.ply cage.obj --json > plain.json
"$batten" measure fine.ply cage.obj --json --picture distances.png > drawn.json
check "measure --picture changes no figure" same plain.json drawn.json
check "measure draws a picture of distances" sh -c 'head -c 4 distances.png | grep -q PNG'
for kind in $("$batten" list shapes | cut -d ' ' -f 1 | grep -vx map); do
    check "shape $kind" "$batten" shape "$kind" --vertices 500 -o shape.ply --quiet
done

"$batten" train surface --recipe batten --epochs 1 --steps 1 --batch 1 --points 50-60 --degree 2 -o trained --json > trained.json
"$batten" shape scan -o scan.xyz --vertices 1500 --seed 2 --quiet
model=trained/model.safetensors
"$batten" surface scan.xyz --model $model --functions 150 -o scan.step --picture scan.png --parameters scan.uv --json > scan.json
check "surface --json says what was chosen" json scan.json '"chosen": "'
check "surface --json has all candidates" sh -c 'grep -c "\"parameters\": \"" scan.json | grep -qx 4'
check "the boundary of a scan is found" grep -q '"boundary_found": true' scan.json
check "the surface is STEP" grep -q B_SPLINE_SURFACE_WITH_KNOTS scan.step
check "surface draws a picture" sh -c 'head -c 4 scan.png | grep -q PNG'
check "every point has its parameters" test "$(wc -l < scan.uv)" -eq "$(grep -vc '^#' scan.xyz)"
"$batten" surface scan.xyz --parameterization ./scan.uv --functions 150 -o given.xml --json > given.json
check "parameters can be given" json given.json '"chosen": "given"'
"$batten" surface - --from xyz --parameterization shape-preserving --functions 100 -o - --to xml < scan.xyz > piped.xml
"$batten" surface scan.xyz --parameterization shape-preserving --functions 100 --threads 1 -o file.xml --quiet
check "surface gives the same bytes to a pipe and with one thread" same piped.xml file.xml
"$batten" surface file.xml -o file.json --quiet
"$batten" surface file.json -o again.xml --json > convert.json
check "a surface survives XML to JSON to XML" same again.xml file.xml
check "a conversion says what it holds" json convert.json '"levels"'
for ending in step vtk obj; do
    "$batten" surface file.xml -o converted.$ending --quiet
    check "a surface is written as $ending" test -s converted.$ending
done
"$batten" surface scan.xyz --parameterization uniform --tolerance 0.02 --degree 3,2 --share 0.9 --robust --force -o file.vtk > surface.txt
check "VTK has the data points with their distances" grep -q 'SCALARS' file.vtk
check "the report has rounds" grep -Eq '^ +0 +12 +1 ' surface.txt
"$batten" shape hull -o hull.xyz --vertices 400 --quiet
first=$(sed -n 's/^# corners \([0-9]*\) \([0-9]*\) \([0-9]*\) \([0-9]*\)/\2,\3,\4,\1/p' hull.xyz)
awk 'BEGIN { for (i = 0; i < 1200; i++) { z = (2 * int(i / 2) + 1) / 600 - 1; r = sqrt(1 - z * z)
    print r * cos(1.2 * i) + i % 2 * 4, r * sin(1.2 * i), z } }' > spheres.xyz
"$batten" surface spheres.xyz -o spheres.step > spheres.txt
check "closed pieces become a shell by default" grep -q '^pieces 2, left out 0' spheres.txt
check "two closed pieces are two solids" sh -c 'grep -c "=MANIFOLD_SOLID_BREP" spheres.step | grep -qx 2'
"$batten" surface hull.xyz --parameterization shape-preserving --corners "$first" --functions 60 --parameters hull.uv --quiet
check "corners are where they are asked for" awk -v row="$((${first%%,*} + 1))" 'NR == row { found = $1 < 0.01 && $2 < 0.01 } END { exit !found }' hull.uv
"$batten" shape cage -o cage.obj --quiet
printf 'v 0 0 0\nv 1 0 0\nv 2 0 1\nv 0 1 0\nv 1 1 1\nv 2 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 1\nf 1 2 5\nf 1 5 4\nf 2 3 6\nf 2 6 5\nf 4 5 8\nf 4 8 7\nf 5 6 9\nf 5 9 8\n' > sheet.obj
"$batten" surface sheet.obj --model $model --functions 16 --json > sheet.json
check "a mesh has mean values among its candidates" json sheet.json 'mean-value'
"$batten" reproduce surface-clouds --model $model --clouds 2 --points 50,60 --noise 0.01 --degrees 2 --json > clouds.json
check "surface-clouds --json has its rows" json clouds.json '"excess"'
check "surface-clouds tries eight ways on two sizes" test "$(grep -c '"method"' clouds.json)" -eq 16
"$batten" reproduce surface-ablation --model $model --uninformed $model --clouds 2 > ablation.txt
check "surface-ablation shows the published errors" grep -q '^uninformed .*0.00293' ablation.txt
check "list parameterizations names them" sh -c "'$batten' list parameterizations | grep -q '^shape-preserving'"

for verb in curve motion decimate mesh surface measure shape analyze reproduce list; do
    for help in "$verb --help" "$verb -h" "help $verb"; do
        check "batten $help" sh -c "'$batten' $help | grep -q '^usage: batten $verb'"
    done
done
check "batten -h" sh -c "'$batten' -h | grep -q '^usage: batten VERB'"
check "batten --version" sh -c "'$batten' --version | grep -q '^batten [0-9]'"

[ $failures -eq 0 ] && echo "the program does what it promises"
[ $failures -eq 0 ]
