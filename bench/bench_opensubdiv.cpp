// Loop's and Catmull and Clark's schemes against OpenSubdiv, one thread each, in one run. Included on both sides: neighbours
// from the list of faces, the topology of all levels, positions of all levels, results in memory. OpenSubdiv gets flat
// arrays through its topology descriptor, makes no full topology on the last level, and interpolates in double precision.

#include "../tests/support/opensubdiv.hpp"
#include "../tests/support/polygon_makers.h"
#include "timing.h"

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace
{

constexpr int ROUNDS = 7;
constexpr double FLOOR = 4;

void refine_batten(const bat_mesh &mesh, bool loop, size_t levels)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = loop ? BAT_MESH_SCHEME_LOOP : BAT_MESH_SCHEME_CATMULL_CLARK;
    options.levels = levels;
    options.threads = 1;
    bat_mesh fine;
    bat_error error;
    if (bat_mesh_refine(&mesh, &options, &fine, nullptr, &error) != BAT_OK)
    {
        std::fprintf(stderr, "bench_opensubdiv: %s\n", error.text);
        std::exit(1);
    }
    bat_mesh_free(&fine);
}

/// How many times as fast we are, from medians of rounds in turn.
double ratio_of(const bat_mesh &mesh, bool loop, size_t levels)
{
    std::vector<double> ours, peers;
    for (int round = 0; round < ROUNDS; round++)
    {
        double start = seconds_now();
        refine_batten(mesh, loop, levels);
        ours.push_back(seconds_now() - start);
        start = seconds_now();
        peer::refine(mesh, loop, bat_mesh_rules{}, static_cast<int>(levels));
        peers.push_back(seconds_now() - start);
    }
    return median_of(peers.data(), peers.size()) / median_of(ours.data(), ours.size());
}

/// Print the ratios of refinements by `first`, ..., `last` levels.
void compare(const char *name, const bat_mesh &mesh, bool loop, size_t first, size_t last)
{
    bool below = false;
    std::printf("%-60s", name);
    for (size_t levels = first; levels <= last; levels++)
    {
        double ratio = ratio_of(mesh, loop, levels);
        below = below || ratio < FLOOR;
        std::printf(" %4.1f", ratio);
    }
    std::printf(" times as fast (floor %.0f)%s\n", FLOOR, below ? "  BELOW" : "");
}

/// Make every `step`th edge of the faces sharp for two levels.
void sharpen(bat_mesh &mesh, uint32_t step)
{
    mesh.creases = static_cast<bat_mesh_crease *>(mesh_room(mesh.face_count, sizeof *mesh.creases));
    for (uint32_t f = 0; f < mesh.face_count; f += step)
        mesh.creases[mesh.crease_count++] = {mesh.faces[peer::first_corner(mesh, f)],
                                             mesh.faces[peer::first_corner(mesh, f) + 1], 2};
}

} // namespace

int main()
{
    bat_mesh irregular = mesh_irregular(120, 60, 2);
    bat_mesh triangles = polygon_mixed(&irregular, 0, 1), mixed = polygon_mixed(&irregular, 0.8, 1);
    bat_mesh quads = polygon_torus(120, 60), cube = polygon_cube();
    std::printf("levels 1, 2, 3, 4\n");
    compare("Loop, 14,400 irregular triangles", triangles, true, 1, 4);
    compare("Catmull-Clark, 7,200 quads", quads, false, 1, 4);
    compare("Catmull-Clark, irregular triangles and quads", mixed, false, 1, 4);
    compare("Catmull-Clark, a cube, 8 levels", cube, false, 8, 8);
    sharpen(triangles, 10);
    sharpen(mixed, 10);
    compare("Loop, with creases", triangles, true, 1, 4);
    compare("Catmull-Clark, with creases", mixed, false, 1, 4);
    bat_mesh_free(&irregular);
    for (bat_mesh *mesh : {&triangles, &mixed, &quads, &cube})
        bat_mesh_free(mesh);
    return 0;
}
