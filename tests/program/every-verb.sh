#!/bin/sh
# Every verb with every scheme, space, format and kind that it takes, on small input: each run must end with exit code 0 and nothing on
# standard error. A build under sanitizers finds here what no reader's fuzzer reaches. Usage: every-verb.sh BATTEN EXAMPLES
set -u
batten=$1
examples=$2
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0
runs=0

fail()
{
    echo "FAILED: $1"
    sed 's/^/    /' stderr
    failures=$((failures + 1))
}

# works ARGUMENTS…: the program must end with 0 and print no number that is none.
works()
{
    runs=$((runs + 1))
    "$batten" "$@" > stdout 2> stderr < /dev/null
    code=$?
    [ $code -eq 0 ] || fail "exit code $code: batten $*"
    [ ! -s stderr ] || fail "something on standard error: batten $*"
    ! grep -Eqiw 'nan' stdout || fail "no number in the output: batten $*"
}

# begins SECONDS ARGUMENTS…: the program must work, but only for so long; then it is stopped as by Ctrl-C.
begins()
{
    seconds=$1
    shift
    runs=$((runs + 1))
    timeout -s INT "$seconds" "$batten" "$@" > stdout 2> stderr < /dev/null
    code=$?
    [ $code -eq 0 ] || [ $code -eq 124 ] || fail "exit code $code: batten $*"
    [ ! -s stderr ] || grep -qx 'batten: stopped' stderr || fail "something on standard error: batten $*"
}

# Curves: every scheme in every space that has it.
printf '0,0\n0.3,0.4\n0.5,0.1\n0.2,-0.4\n0.1,-0.2\n' > plane.csv
printf '# space: euclidean\n# columns: 1,2,3,4\nx,y,z,u\n0,0,1,2\n3,4,2,2\n5,1,3,1\n2,-4,4,1\n' > euclidean.csv
printf '# space: sphere\n1,0,0\n0.8,0.6,0\n0,1,0\n0,0.6,0.8\n' > sphere.csv
printf '# space: disk\n0,0\n0.3,0.4\n0.5,0.1\n0.2,-0.4\n0.1,-0.2\n' > disk.csv
printf '# space: hyperbolic\n1,0,0\n1.25,0.75,0\n1.25,0.45,0.6\n1.25,-0.45,0.6\n' > hyperbolic.csv
printf '# space: rotation\ntime,qw,qx,qy,qz\n0,1,0,0,0\n1,0.96,0.28,0,0\n2,0.8,0.6,0,0\n4,0.8,0.48,0.36,0\n' > rotation.csv
cp "$examples/camera-keyframes.csv" rigid.csv
cp "$examples/tensor-path.csv" spd.csv
linear='chaikin corner-cutting:r=0.2,s=0.7 four-point four-point:w=0.05 six-point lane-riesenfeld:order=4 mask:1/4,3/4,3/4,1/4@-1'
angle='angle-4 angle-6 angle:mu=-0.1,sign=printed angle-4:adaptive=1 learned learned:fairness=0 learned:fairness=1'
log_exp='log-exp-4 log-exp-4:base=midpoint log-exp-4:parameters=chordal catmull-rom cubic log-exp-6 log-exp-lane-riesenfeld:order=2 geodesic:order=2'
hermite='spline hermite hermite:order=3'
for space in plane euclidean sphere disk hyperbolic rotation rigid spd; do
    case $space in
    plane) schemes="$linear $angle $log_exp $hermite" ;;
    euclidean) schemes="$linear $log_exp $hermite" ;;
    sphere | disk) schemes="$angle $log_exp $hermite" ;;
    hyperbolic) schemes="$log_exp $hermite" ;;
    *) schemes="$log_exp $hermite" ;;
    esac
    for scheme in $schemes; do
        case $scheme in hermite* | spline) verb=motion ;; *) verb=curve ;; esac
        works $verb $space.csv --scheme "$scheme" --levels 2 -o "out.csv"
        case $scheme in hermite* | spline) ;; *) works curve $space.csv --scheme "$scheme" --levels 2 --closed --json ;; esac
    done
    case $space in rotation | rigid | spd) verb=motion ;; *) verb=curve ;; esac
    works $verb $space.csv -o default.csv
    works measure $space.csv --json
    works measure $space.csv default.csv --json
done
for ends in reflect extrapolate free; do
    works curve plane.csv --scheme four-point --ends $ends --levels 3 -o out.csv --snap --truth default.csv --space plane
done
for space in plane sphere disk rotation rigid spd; do
    works motion $space.csv --scheme hermite --velocities --tangents 4 --levels 2 -o out.csv
done
for space in rotation rigid spd; do
    for order in 1 2 3; do
        works motion $space.csv --scheme hermite:order=$order --levels 2
    done
    works motion $space.csv --scheme hermite --rate 7 -o motion.csv
    works motion $space.csv --scheme hermite --rate 7 --velocities --threads 2
done
printf '0.5\n1\n' > times.txt
for tangents in resting smooth limited 2 4; do
    works motion rigid.csv --tangents $tangents --times times.txt --velocities -o out.csv
done
for ends in auto not-a-knot natural clamped; do
    works motion rotation.csv --ends $ends --levels 1 -o out.csv
done
works motion rigid.csv --sigma 0.01,0.01 --outliers huber -o out.csv
printf 'time,roll,pitch,yaw\n0,0,0,0\n1,10,20,30\n' > angles.csv
works motion angles.csv --euler zyx,degrees -o out.csv
printf '1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n' > kitti.txt
printf '0\n0.1\n' > key-times.txt
works motion kitti.txt --key-times key-times.txt -o out.tum
works motion rigid.csv --rate 5 --translation-weight 0.2 -o motion.tum
works motion motion.tum --rate 9 --tangents 4 -o again.tum
works curve "$examples/iss-track.geojson" --levels 3 -o out.geojson --picture out.svg --projection both
works curve "$examples/camera-path.obj" --levels 3 -o out.obj
works curve "$examples/outline.csv" --levels 3 -o out.csv --picture out.png --comb --axes --title outline --panel 0,1,3
works curve "$examples/hyperbolic.csv" --levels 3 --picture out.pdf --comb
works curve "$examples/outline.csv" --scheme angle-4 --truth "$examples/outline.csv" --best-tension --levels 3
works measure "$examples/outline.csv" "$examples/quarter-arc.csv" --to-segments
works measure sphere.csv "$examples/iss-track.geojson" --geodesic --json

# Meshes: every scheme, closed and with a boundary, creases and texture coordinates, through every format.
works shape cage -o cage.obj
works shape mask -o mask.ply --vertices 500
printf 'v 0 0 0\nv 1 0 0\nv 2 0 1\nv 0 1 0\nv 1 1 1\nv 2 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 1\nvt 0 0\nvt 1 0\nvt 1 1\n' > sheet.obj
printf 'f 1/1 2/2 5/3\nf 1/1 5/3 4/2\nf 2/1 3/2 6/3\nf 2 6 5\nf 4 5 8\nf 4 8 7\nf 5 6 9\nf 5 9 8\n' >> sheet.obj
for mesh in cage.obj mask.ply sheet.obj; do
    for scheme in learned loop butterfly midpoint; do
        works mesh $mesh --scheme $scheme --levels 1 -o out.ply --json
    done
    [ $mesh = sheet.obj ] || works mesh $mesh --scheme sqrt3 --levels 2 -o out.stl --quiet
    works mesh $mesh --scheme loop --crease-angle 30 --limit -o out.off
    works mesh $mesh --levels 3 --then loop -o fine.obj --triangulate
    works mesh $mesh --levels 1 --picture out.png --beside loop
    works measure $mesh
    works measure $mesh fine.obj --samples 2000 --json
    works measure $mesh out.off --at-vertices --picture out.png
    works decimate $mesh -o coarse.obj --vertices 7 --map map.safetensors --json
    works decimate $mesh -o coarse.stl --vertices 7 --random 5 --seed 3
    works decimate $mesh -o coarse.ply --tolerance 5% --method quadric --json
    works decimate $mesh -o coarse.glb --vertices 7 --transfer --normals --bake normal=normal.png,occlusion --size 64
    works decimate $mesh -o chain.glb --lods 1,0.8 --json
done

# Surfaces.
works shape hull -o hull.xyz --vertices 300
works shape scan -o scan.xyz --vertices 400
for parameterization in learned shape-preserving inverse-distance uniform stretch-minimizing; do
    works surface hull.xyz --parameterization $parameterization --functions 40 -o out.json
done
works surface sheet.obj --parameterization mean-value --functions 16 -o out.vtk
works surface scan.xyz -o out.xml --parameters out.uv --picture out.png --json
works surface scan.xyz --parameterization out.uv --degree 3,2 --tolerance 0.05 --robust --noise 0.01 -o out.step
works surface scan.xyz --parameterization uniform --published --slide-boundary --final-corrections 1 --corrections 2 --smoothing 1e-4 -o out.obj
works surface out.xml -o out.json
works surface scan.xyz --strict --trim --fill-holes 0.1 --unit m -o out.igs --picture out.png
works surface out.json -o out.step

# Analysis and lists.
for scheme in $linear; do
    works analyze "$scheme"
    works analyze "$scheme" --json --depth 6 --picture out.svg
done
works analyze four-point --sweep w=0.05:0.07 --smoothness 1
for list in schemes spaces models shapes parameterizations results; do
    works list $list
    works list $list --json
done

# One epoch of every training, and results that come fast.
works train surface --epochs 1 --steps 1 --points 50 --output surface
works train surface --uninformed --epochs 1 --steps 1 --points 50 --adam --output uninformed
works train surface --recipe batten --epochs 1 --steps 1 --batch 1 --points 50-60 --degree 2 --output surface-batten
works train surface --recipe batten --epochs 1 --steps 1 --batch 1 --points 50-60 --degree 2 --output surface-batten --resume --json
works train mesh cage.obj --pairs 1 --epochs 1 --vertices 20-40 --output mesh
works train mesh cage.obj --pairs 1 --epochs 1 --vertices 20-40 --relative --surface --without differences --output mesh-parts
works train mesh cage.obj --pairs 1 --epochs 1 --vertices 20-40 --learn-loop --without correspondence --output mesh-loop
works mesh sheet.obj --model mesh/model.safetensors --levels 1 -o out.obj
works surface hull.xyz --parameterization learned --model uninformed/model.safetensors --functions 20 -o out.obj
if [ -n "${BATTEN_LONG_TESTS:-}" ]; then
    begins 10 train mesh cage.obj --recipe batten --pairs 1 --resampled 1 --epochs 1 --vertices 20-40 --output mesh-batten
    begins 20 train curve --recipe batten --epochs 1 --output tension-batten
fi
begins 10 train curve --epochs 1 --output tension
for result in tension-iss tension-mechanism hermite-figures; do
    works reproduce $result --json
done
mkdir curves
printf '# closed\n1,0\n0.7,0.7\n0,1\n-0.7,0.7\n-1,0\n-0.7,-0.7\n0,-1\n0.7,-0.7\n' > curves/ring-truth.csv
printf '# closed\n1,0\n0,1\n-1,0\n0,-1\n' > curves/ring-even.csv
works reproduce motion-keyframes --json
works reproduce motion-keyframes
works reproduce real-curves --data curves --json
works reproduce real-curves --data curves
works reproduce surface-clouds --clouds 1 --points 50 --noise 0.01 --degrees 2
begins 10 reproduce curve-figures -o figures

[ $failures -eq 0 ] && echo "$runs runs, all good"
[ $failures -eq 0 ]
