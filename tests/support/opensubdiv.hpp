// Refinement by OpenSubdiv, for tests and benchmarks.
#ifndef TESTS_SUPPORT_OPENSUBDIV_HPP
#define TESTS_SUPPORT_OPENSUBDIV_HPP

#include "batten/mesh_refine.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <array>
#include <memory>
#include <vector>

namespace peer
{

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

/// A row of values that OpenSubdiv adds up.
template <int N> struct Row
{
    double p[N];
    void Clear()
    {
        for (double &x : p)
            x = 0;
    }
    void AddWithWeight(const Row &other, double weight)
    {
        for (int i = 0; i < N; i++)
            p[i] += weight * other.p[i];
    }
};

using Point = Row<3>;
using Place = Row<2>;

/// A mesh in OpenSubdiv's own types.
struct Description
{
    std::vector<int> face_sizes, corners, crease_ends, corner_vertices, texture;
    std::vector<float> crease_weights, corner_weights;
    Far::TopologyDescriptor::FVarChannel channel;
    Far::TopologyDescriptor descriptor;
};

/// The first corner of a face.
inline uint32_t first_corner(const bat_mesh &mesh, size_t face)
{
    return mesh.offsets != nullptr ? mesh.offsets[face] : static_cast<uint32_t>(3 * face);
}

inline void describe(const bat_mesh &mesh, Description &made)
{
    size_t corners = first_corner(mesh, mesh.face_count);
    for (size_t f = 0; f < mesh.face_count; f++)
        made.face_sizes.push_back(static_cast<int>(first_corner(mesh, f + 1) - first_corner(mesh, f)));
    made.corners.assign(mesh.faces, mesh.faces + corners);
    for (size_t i = 0; i < mesh.crease_count; i++)
    {
        made.crease_ends.push_back(static_cast<int>(mesh.creases[i].a));
        made.crease_ends.push_back(static_cast<int>(mesh.creases[i].b));
        made.crease_weights.push_back(static_cast<float>(mesh.creases[i].sharpness));
    }
    for (size_t i = 0; i < mesh.corner_count; i++)
    {
        made.corner_vertices.push_back(static_cast<int>(mesh.corners[i].vertex));
        made.corner_weights.push_back(static_cast<float>(mesh.corners[i].sharpness));
    }
    Far::TopologyDescriptor &to = made.descriptor;
    to.numVertices = static_cast<int>(mesh.vertex_count);
    to.numFaces = static_cast<int>(mesh.face_count);
    to.numVertsPerFace = made.face_sizes.data();
    to.vertIndicesPerFace = made.corners.data();
    to.numCreases = static_cast<int>(mesh.crease_count);
    to.creaseVertexIndexPairs = made.crease_ends.data();
    to.creaseWeights = made.crease_weights.data();
    to.numCorners = static_cast<int>(mesh.corner_count);
    to.cornerVertexIndices = made.corner_vertices.data();
    to.cornerWeights = made.corner_weights.data();
    if (mesh.texture_faces == nullptr)
        return;
    made.texture.assign(mesh.texture_faces, mesh.texture_faces + corners);
    made.channel.numValues = static_cast<int>(mesh.texture_count);
    made.channel.valueIndices = made.texture.data();
    to.numFVarChannels = 1;
    to.fvarChannels = &made.channel;
}

inline Sdc::Options options_of(const bat_mesh_rules &rules)
{
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(rules.boundary == BAT_MESH_BOUNDARY_NONE ? Sdc::Options::VTX_BOUNDARY_NONE
                                        : rules.boundary == BAT_MESH_BOUNDARY_CORNERS
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    options.SetCreasingMethod(rules.creasing == BAT_MESH_CREASING_CHAIKIN ? Sdc::Options::CREASE_CHAIKIN
                                                                          : Sdc::Options::CREASE_UNIFORM);
    switch (rules.linear)
    {
    case BAT_MESH_LINEAR_NONE:
        options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_NONE);
        break;
    case BAT_MESH_LINEAR_CORNERS:
        options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_ONLY);
        break;
    case BAT_MESH_LINEAR_CORNERS_PLUS1:
        options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1);
        break;
    case BAT_MESH_LINEAR_CORNERS_PLUS2:
        options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2);
        break;
    case BAT_MESH_LINEAR_BOUNDARIES:
        options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_BOUNDARIES);
        break;
    default:
        options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_ALL);
        break;
    }
    return options;
}

/// The levels of a refinement, the given one first.
struct Refined
{
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::vector<std::vector<Point>> points;
    std::vector<std::vector<Place>> places; ///< texture coordinates, where the mesh has them
};

/// Refine a mesh: tables of the topology, then values. Only `levels` levels of both are made.
inline Refined refine(const bat_mesh &mesh, bool loop, const bat_mesh_rules &rules, int levels)
{
    Description description;
    describe(mesh, description);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Refined made;
    made.refiner.reset(Factory::Create(description.descriptor,
                                       Factory::Options(loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK, options_of(rules))));
    Far::TopologyRefiner::UniformOptions how(levels);
    how.fullTopologyInLastLevel = false;
    made.refiner->RefineUniform(how);
    Far::PrimvarRefinerReal<double> interpolator(*made.refiner);
    made.points.resize(static_cast<size_t>(levels) + 1);
    made.points[0].resize(mesh.vertex_count);
    for (size_t v = 0; v < mesh.vertex_count; v++)
        made.points[0][v] = {{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]}};
    if (mesh.texture_faces != nullptr)
    {
        made.places.resize(made.points.size());
        for (size_t i = 0; i < mesh.texture_count; i++)
            made.places[0].push_back({{mesh.texture[2 * i], mesh.texture[2 * i + 1]}});
    }
    for (int level = 1; level <= levels; level++)
    {
        size_t at = static_cast<size_t>(level);
        const Far::TopologyLevel &topology = made.refiner->GetLevel(level);
        made.points[at].resize(static_cast<size_t>(topology.GetNumVertices()));
        interpolator.Interpolate(level, made.points[at - 1], made.points[at]);
        if (mesh.texture_faces == nullptr)
            continue;
        made.places[at].resize(static_cast<size_t>(topology.GetNumFVarValues(0)));
        interpolator.InterpolateFaceVarying(level, made.places[at - 1], made.places[at], 0);
    }
    return made;
}

} // namespace peer

#endif
