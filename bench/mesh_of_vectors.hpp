#ifndef BENCH_MESH_OF_VECTORS_HPP
#define BENCH_MESH_OF_VECTORS_HPP

#include "batten/mesh.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

/// @file
/// Meshes of other libraries as meshes of batten, for comparisons.

/// End the program with a message.
[[noreturn]] inline void stop(const char *what)
{
    (void)std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, what);
    std::exit(1);
}

/// A copy that free() releases.
template <typename Value> Value *copy_of(const std::vector<Value> &values)
{
    auto *copy = static_cast<Value *>(std::malloc(values.size() * sizeof(Value)));
    if (copy == nullptr)
        stop("out of memory");
    std::memcpy(copy, values.data(), values.size() * sizeof(Value));
    return copy;
}

/// A mesh of three coordinates for each vertex and three vertices for each face; bat_mesh_free() releases it.
inline bat_mesh mesh_of(const std::vector<double> &positions, const std::vector<uint32_t> &faces)
{
    bat_mesh mesh = {};
    mesh.positions = copy_of(positions);
    mesh.faces = copy_of(faces);
    mesh.vertex_count = positions.size() / 3;
    mesh.face_count = faces.size() / 3;
    return mesh;
}

#endif
