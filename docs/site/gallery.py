"""Draw the pictures of the gallery, each by the lines beside it, and write its page.

    python gallery.py PROGRAM FOLDER

The lines run in FOLDER/gallery with the files of examples/data; a line that fails stops the build.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# A title, and lines of the shell. The last word of the last line is the picture.
ROWS = [
    ("A map of 200 countries keeps its borders", "batten curve map.geojson --levels 3 --picture map.png"),
    ("A coast beside its truth", "batten curve coast.geojson --truth coast-detailed.geojson --picture coast.png"),
    ("The ground track of a satellite", "batten curve iss-track.geojson --levels 5 --projection both --picture iss.png"),
    ("An outline with curvature combs", "batten curve outline.csv --scheme angle-6 --levels 6 --comb --picture comb.png"),
    ("An outline level by level", "batten curve outline.csv --levels 5 --panel 0,1,2,5 --picture levels.png"),
    ("A curve in the hyperbolic disk", "batten curve hyperbolic.csv --space disk --levels 6 --picture disk.png"),
    ("A quarter of a circle", "batten curve quarter-arc.csv --scheme angle-6 --levels 5 --comb --picture arc.png"),
    ("A camera move", "batten motion camera-keyframes.csv --rate 25 --units m,s --picture camera.png"),
    ("A basic limit function", "batten analyze four-point --picture basis.png"),
    ("Chaikin's scheme", "batten analyze chaikin --picture chaikin.png"),
    ("A cage, learned beside Loop's scheme",
     "batten shape cage -o cage.obj\nbatten mesh cage.obj --scheme learned --levels 3 --beside loop --picture cage.png"),
    ("The same cage by Catmull and Clark's scheme", "batten mesh cage.obj --scheme catmull-clark --levels 3 --picture quads.png"),
    ("A creature", "batten shape creature --vertices 10000 --seed 3 -o creature.ply --picture creature.png"),
    ("The creature with 400 vertices",
     "batten decimate creature.ply --vertices 400 -o coarse.ply\nbatten mesh coarse.ply --levels 1 --picture coarse.png"),
    ("Fine again, and its distance from the creature",
     "batten mesh coarse.ply --scheme learned -o again.ply\nbatten measure again.ply creature.ply --picture distance.png"),
    ("A scan becomes a surface",
     "batten shape scan --vertices 6000 -o scan.xyz\nbatten surface scan.xyz -o scan.step --picture scan.png"),
    ("A closed body becomes a shell",
     "batten shape stone --vertices 4000 -o stone.ply\nbatten surface stone.ply --shell -o stone.step --picture stone.png"),
    ("A generated hull", "batten shape hull --vertices 3000 -o hull.xyz --picture hull.png"),
    ("A generated blade", "batten shape blade --vertices 3000 -o blade.xyz --picture blade.png"),
    ("A generated map", "batten shape map --countries 60 --seed 5 -o land.geojson --picture land.png"),
]  # fmt: skip


def main() -> None:
    program, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    work = folder / "gallery"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    for file in (ROOT / "examples/data").iterdir():
        if file.is_file():
            shutil.copyfile(file, work / file.name)
    path = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"}
    page = ["Gallery", "=======", "", "Each picture is made by the lines above it, from files of ``examples/data``.", ""]
    for title, lines in ROWS:
        done = subprocess.run(["sh", "-ec", lines], cwd=work, env=path, capture_output=True, text=True)
        picture = lines.split()[-1]
        if done.returncode != 0 or not (work / picture).exists():
            raise SystemExit(f"gallery: {lines}: {done.stderr.strip()}")
        page += [title, "-" * len(title), "", ".. code-block:: sh", ""]
        page += [f"   {line}" for line in lines.splitlines()] + ["", f".. image:: gallery/{picture}", f"   :alt: {title}", ""]
    pictures = {lines.split()[-1] for _, lines in ROWS}
    for file in work.iterdir():
        if file.name not in pictures:
            file.unlink()
    (folder / "gallery.rst").write_text("\n".join(page))


if __name__ == "__main__":
    main()
