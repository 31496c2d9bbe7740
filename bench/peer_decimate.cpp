// Decimation against OpenMesh's decimater with its quadric module, in one run: how long each takes, and how far the result
// is from the mesh it came from.
//
//   peer_decimate [SHARE [MESH ...]]     SHARE: of the vertices that stay, default .01
//
// Without a mesh, a bumpy sphere of 50,000 vertices.

#include "batten/mesh_decimate.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "mesh_of_vectors.hpp"
#include "timing.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace
{

constexpr int REPEATS = 5;

struct Traits : OpenMesh::DefaultTraits
{
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using PeerMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// Rings of vertices between two poles, the radius going up and down.
bat_mesh bumpy_sphere(uint32_t rings, uint32_t spokes)
{
    const double pi = std::acos(-1.0);
    std::vector<double> positions;
    std::vector<uint32_t> faces;
    auto add = [&](double latitude, double longitude)
    {
        double x = std::cos(latitude) * std::cos(longitude), y = std::cos(latitude) * std::sin(longitude),
               z = std::sin(latitude), radius = 1 + 0.1 * std::sin(5 * x) * std::sin(6 * y + 1) + 0.05 * std::cos(9 * z + x);
        for (double coordinate : {radius * x, radius * y, radius * z})
            positions.push_back(coordinate);
    };
    for (uint32_t i = 0; i < rings; i++)
        for (uint32_t j = 0; j < spokes; j++)
            add(pi * ((i + 1.0) / (rings + 1.0) - 0.5), 2 * pi * j / spokes);
    add(-pi / 2, 0);
    add(pi / 2, 0);
    for (uint32_t j = 0; j < spokes; j++)
    {
        uint32_t next = (j + 1) % spokes, top = (rings - 1) * spokes;
        for (uint32_t i = 0; i + 1 < rings; i++)
        {
            uint32_t a = i * spokes + j, b = i * spokes + next, c = a + spokes, d = b + spokes;
            for (uint32_t corner : {a, b, d, a, d, c})
                faces.push_back(corner);
        }
        for (uint32_t corner : {rings * spokes, next, j, top + j, top + next, rings * spokes + 1})
            faces.push_back(corner);
    }
    return mesh_of(positions, faces);
}

PeerMesh to_openmesh(const bat_mesh &mesh)
{
    PeerMesh peer;
    std::vector<PeerMesh::VertexHandle> handles;
    for (size_t v = 0; v < mesh.vertex_count; v++)
        handles.push_back(peer.add_vertex({mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]}));
    for (size_t f = 0; f < mesh.face_count; f++)
        peer.add_face(handles[mesh.faces[3 * f]], handles[mesh.faces[3 * f + 1]], handles[mesh.faces[3 * f + 2]]);
    return peer;
}

bat_mesh from_openmesh(const PeerMesh &peer)
{
    std::vector<double> positions;
    std::vector<uint32_t> faces;
    for (auto vertex : peer.vertices())
        for (size_t c = 0; c < 3; c++)
            positions.push_back(peer.point(vertex)[c]);
    for (auto face : peer.faces())
        for (auto vertex : peer.fv_range(face))
            faces.push_back(static_cast<uint32_t>(vertex.idx()));
    return mesh_of(positions, faces);
}

double decimate_openmesh(const PeerMesh &fine, size_t vertices, bat_mesh &coarse)
{
    PeerMesh peer = fine;
    double begun = seconds_now();
    {
        OpenMesh::Decimater::DecimaterT<PeerMesh> decimater(peer);
        OpenMesh::Decimater::ModQuadricT<PeerMesh>::Handle quadric;
        decimater.add(quadric);
        decimater.module(quadric).unset_max_err();
        decimater.initialize();
        decimater.decimate_to(vertices);
        peer.garbage_collection();
    }
    double taken = seconds_now() - begun;
    bat_mesh_free(&coarse);
    coarse = from_openmesh(peer);
    return taken;
}

double decimate_batten(const bat_mesh &fine, size_t vertices, bool mapped, bat_mesh &coarse)
{
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    bat_mesh_map *map = nullptr;
    bat_error error;
    options.vertices = vertices;
    bat_mesh_free(&coarse);
    double begun = seconds_now();
    if (bat_mesh_decimate(&fine, &options, &coarse, mapped ? &map : nullptr, &error) != BAT_OK)
        stop(error.text);
    double taken = seconds_now() - begun;
    bat_mesh_map_free(map);
    return taken;
}

double mean_distance(const bat_mesh &coarse, const bat_mesh &fine)
{
    bat_mesh_distance distance;
    bat_error error;
    if (bat_mesh_compare(&coarse, &fine, nullptr, &distance, &error) != BAT_OK)
        stop(error.text);
    return distance.mean / distance.diagonal;
}

void compare(const char *name, const bat_mesh &fine, double share)
{
    auto vertices = static_cast<size_t>(share * static_cast<double>(fine.vertex_count));
    PeerMesh peer = to_openmesh(fine);
    bat_mesh theirs = {}, ours = {}, mapped = {};
    double times[3][REPEATS];
    for (int i = 0; i < REPEATS; i++)
    {
        times[0][i] = decimate_openmesh(peer, vertices, theirs);
        times[1][i] = decimate_batten(fine, vertices, false, ours);
        times[2][i] = decimate_batten(fine, vertices, true, mapped);
    }
    double openmesh = median_of(times[0], REPEATS), plain = median_of(times[1], REPEATS), map = median_of(times[2], REPEATS);
    double of_openmesh = mean_distance(theirs, fine), of_plain = mean_distance(ours, fine),
           of_map = mean_distance(mapped, fine);
    (void)std::printf("%s: %zu vertices to %zu\n"
                      "  OpenMesh          %6zu vertices  %8.1f ms  mean distance %.3e of the diagonal\n"
                      "  batten            %6zu vertices  %8.1f ms  %.3e   %.1f times as fast, distance times %.3f\n"
                      "  batten with a map %6zu vertices  %8.1f ms  %.3e   %.1f times the time without\n",
                      name, fine.vertex_count, vertices, theirs.vertex_count, 1e3 * openmesh, of_openmesh, ours.vertex_count,
                      1e3 * plain, of_plain, openmesh / plain, of_plain / of_openmesh, mapped.vertex_count, 1e3 * map,
                      of_map, map / plain);
    bat_mesh_free(&theirs);
    bat_mesh_free(&ours);
    bat_mesh_free(&mapped);
}

} // namespace

int main(int argc, char **argv)
{
    double share = argc > 1 ? std::atof(argv[1]) : 0.01;
    if (argc <= 2)
    {
        bat_mesh sphere = bumpy_sphere(158, 316);
        compare("bumpy sphere", sphere, share);
        bat_mesh_free(&sphere);
    }
    for (int i = 2; i < argc; i++)
    {
        bat_mesh mesh = {};
        bat_error error;
        if (bat_mesh_read(argv[i], nullptr, &mesh, &error) != BAT_OK)
            stop(error.text);
        compare(argv[i], mesh, share);
        bat_mesh_free(&mesh);
    }
    return 0;
}
