// Decimation by both methods against CGAL's (Lindstrom and Turk) and, where it is installed, meshoptimizer's, in one run:
// mean distances, the quality of the worst triangles, and times, as ratios to CGAL's.
//
//   peer_simplify SHARE MESH ...     SHARE: of the vertices that stay

#include "batten/mesh_decimate.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "mesh_of_vectors.hpp"
#include "timing.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#if defined(BENCH_MESHOPTIMIZER)
#include <meshoptimizer.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace
{

/// Processor time: other programs do not count.
double processor_seconds()
{
    timespec now = {};
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

namespace Simplification = CGAL::Surface_mesh_simplification;
using Point = CGAL::Simple_cartesian<double>::Point_3;
using Peer = CGAL::Surface_mesh<Point>;

constexpr int REPEATS = 3;
/// The share of triangles that count as the worst.
constexpr double WORST = 0.01;

enum
{
    CGAL_LINDSTROM_TURK,
    BATTEN_QUADRIC,
    BATTEN_MEMORYLESS,
    BATTEN_FAST,
    MESHOPTIMIZER,
    WAYS
};

const std::array<const char *, WAYS> NAMES = {"CGAL, Lindstrom-Turk", "batten, quadric", "batten, memoryless",
                                              "batten, fast", "meshoptimizer"};

Peer to_cgal(const bat_mesh &mesh)
{
    Peer peer;
    for (size_t v = 0; v < mesh.vertex_count; v++)
        peer.add_vertex(Point(mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]));
    for (size_t f = 0; f < mesh.face_count; f++)
        peer.add_face(Peer::Vertex_index(mesh.faces[3 * f]), Peer::Vertex_index(mesh.faces[3 * f + 1]),
                      Peer::Vertex_index(mesh.faces[3 * f + 2]));
    return peer;
}

bat_mesh from_cgal(const Peer &peer)
{
    std::vector<double> positions;
    std::vector<uint32_t> faces;
    for (auto vertex : peer.vertices())
        for (int c = 0; c < 3; c++)
            positions.push_back(peer.point(vertex)[c]);
    for (auto face : peer.faces())
        for (auto vertex : CGAL::vertices_around_face(peer.halfedge(face), peer))
            faces.push_back(static_cast<uint32_t>(vertex));
    return mesh_of(positions, faces);
}

/// Stops at a number of vertices.
struct Vertices_left
{
    size_t wanted;
    template <typename Cost, typename Profile>
    bool operator()(const Cost &cost, const Profile &profile, size_t initial, size_t current) const
    {
        (void)cost;
        (void)initial;
        (void)current;
        return profile.surface_mesh().number_of_vertices() <= wanted;
    }
};

double run_cgal(const Peer &fine, size_t vertices, bat_mesh &coarse)
{
    Peer peer = fine;
    double begun = processor_seconds();
    (void)Simplification::edge_collapse(peer, Vertices_left{vertices});
    peer.collect_garbage();
    double taken = processor_seconds() - begun;
    coarse = from_cgal(peer);
    return taken;
}

double run_batten(const bat_mesh &fine, size_t vertices, bat_mesh_decimate_method method, bat_mesh &coarse)
{
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    bat_error error;
    options.vertices = vertices;
    options.method = method;
    options.attributes = 0;
    options.threads = 1;
    double begun = processor_seconds();
    if (bat_mesh_decimate(&fine, &options, &coarse, nullptr, &error) != BAT_OK)
        stop(error.text);
    return processor_seconds() - begun;
}

#if defined(BENCH_MESHOPTIMIZER)
double run_meshoptimizer(const bat_mesh &fine, size_t faces, bat_mesh &coarse)
{
    std::vector<float> positions(fine.positions, fine.positions + 3 * fine.vertex_count);
    std::vector<unsigned int> from(fine.faces, fine.faces + 3 * fine.face_count), to(from.size());
    float error;
    double begun = processor_seconds();
    to.resize(meshopt_simplify(to.data(), from.data(), from.size(), positions.data(), fine.vertex_count, 3 * sizeof(float),
                               3 * faces, 1e10F, 0, &error));
    double taken = processor_seconds() - begun;
    std::vector<uint32_t> number(fine.vertex_count, BAT_MESH_NONE), corners;
    std::vector<double> kept;
    for (unsigned int vertex : to)
    {
        if (number[vertex] == BAT_MESH_NONE)
        {
            number[vertex] = static_cast<uint32_t>(kept.size() / 3);
            kept.insert(kept.end(), fine.positions + 3 * size_t{vertex}, fine.positions + 3 * size_t{vertex} + 3);
        }
        corners.push_back(number[vertex]);
    }
    coarse = mesh_of(kept, corners);
    return taken;
}
#endif

double run(int way, const bat_mesh &fine, const Peer &peer, size_t vertices, size_t faces, bat_mesh &coarse)
{
    bat_mesh_free(&coarse);
    (void)faces;
    switch (way)
    {
    case CGAL_LINDSTROM_TURK:
        return run_cgal(peer, vertices, coarse);
    case BATTEN_QUADRIC:
        return run_batten(fine, vertices, BAT_MESH_DECIMATE_METHOD_QUADRIC, coarse);
    case BATTEN_MEMORYLESS:
        return run_batten(fine, vertices, BAT_MESH_DECIMATE_METHOD_MEMORYLESS, coarse);
    case BATTEN_FAST:
        return run_batten(fine, vertices, BAT_MESH_DECIMATE_METHOD_FAST, coarse);
    default:
#if defined(BENCH_MESHOPTIMIZER)
        return run_meshoptimizer(fine, faces, coarse);
#else
        stop("no such way");
#endif
    }
}

/// The quality that WORST of the faces fall short of.
double worst_quality(const bat_mesh &mesh)
{
    std::vector<double> quality;
    for (size_t f = 0; f < mesh.face_count; f++)
    {
        double square = 0, edge[3][3], normal[3];
        for (size_t c = 0; c < 3; c++)
            for (size_t k = 0; k < 3; k++)
            {
                edge[c][k] = mesh.positions[3 * size_t{mesh.faces[3 * f + (c + 1) % 3]} + k] -
                             mesh.positions[3 * size_t{mesh.faces[3 * f + c]} + k];
                square += edge[c][k] * edge[c][k];
            }
        for (size_t k = 0; k < 3; k++)
            normal[k] = edge[0][(k + 1) % 3] * edge[1][(k + 2) % 3] - edge[0][(k + 2) % 3] * edge[1][(k + 1) % 3];
        quality.push_back(2 * std::sqrt(3.0) *
                          std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / square);
    }
    auto place = quality.begin() + static_cast<long>(WORST * static_cast<double>(quality.size()));
    std::nth_element(quality.begin(), place, quality.end());
    return *place;
}

/// The sums of logarithms over all meshes.
struct Totals
{
    double distance = 0, hausdorff = 0, seconds = 0, quality = 0;
};

void compare(const char *name, const bat_mesh &fine, double share, std::array<Totals, WAYS> &totals)
{
    auto vertices = static_cast<size_t>(share * static_cast<double>(fine.vertex_count));
    size_t faces = 0;
    Peer peer = to_cgal(fine);
    double first_time = 1;
    bat_mesh_distance first = {};
    (void)std::printf("%s: %zu vertices to %zu\n", name, fine.vertex_count, vertices);
    for (int way = 0; way < WAYS; way++)
    {
#if !defined(BENCH_MESHOPTIMIZER)
        if (way == MESHOPTIMIZER)
            continue;
#endif
        bat_mesh coarse = {};
        double times[REPEATS];
        for (double &time : times)
            time = run(way, fine, peer, vertices, faces, coarse);
        bat_mesh_distance distance;
        bat_error error;
        if (bat_mesh_compare(&coarse, &fine, nullptr, &distance, &error) != BAT_OK)
            stop(error.text);
        double taken = median_of(times, REPEATS), quality = worst_quality(coarse);
        if (way == CGAL_LINDSTROM_TURK)
        {
            first = distance;
            first_time = taken;
            faces = coarse.face_count;
        }
        totals[way].distance += std::log(distance.mean / first.mean);
        totals[way].hausdorff += std::log(distance.hausdorff / first.hausdorff);
        totals[way].seconds += std::log(first_time / taken);
        totals[way].quality += quality;
        (void)std::printf(
            "  %-22s %6zu vertices, %8.1f ms (%5.2f times as fast), mean distance %.3e of the diagonal (%.3f), "
            "Hausdorff (%.3f), quality of the worst %.3f\n",
            NAMES[way], coarse.vertex_count, 1e3 * taken, first_time / taken, distance.mean / distance.diagonal,
            distance.mean / first.mean, distance.hausdorff / first.hausdorff, quality);
        bat_mesh_free(&coarse);
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3)
        stop("peer_simplify SHARE MESH ...");
    std::array<Totals, WAYS> totals = {};
    double share = std::atof(argv[1]), count = argc - 2;
    for (int i = 2; i < argc; i++)
    {
        bat_mesh mesh = {};
        bat_error error;
        bat_mesh_read_options how = bat_mesh_read_defaults();
        how.triangulate = how.repair = true;
        if (bat_mesh_read(argv[i], &how, &mesh, &error) != BAT_OK)
            stop(error.text);
        compare(argv[i], mesh, share, totals);
        bat_mesh_free(&mesh);
    }
    (void)std::printf("geometric means over %g meshes, divided by CGAL's:\n", count);
    for (int way = 0; way < WAYS; way++)
        (void)std::printf("  %-22s mean distance %.3f, Hausdorff %.3f, speed %.2f; mean quality of the worst %.3f\n",
                          NAMES[way], std::exp(totals[way].distance / count), std::exp(totals[way].hausdorff / count),
                          std::exp(totals[way].seconds / count), totals[way].quality / count);
    return 0;
}
