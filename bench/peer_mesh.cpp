// Mesh refinement against OpenMesh and OpenSubdiv: first that the results are the same, then how long each takes, in one
// run.
//
//   peer_mesh [MESH.obj ...]     also checks these meshes
//
// OpenMesh is the peer on closed meshes. OpenSubdiv's boundary option that means the same as here is EDGE_ONLY; its
// sharpness is in single precision, so that sharpness here is made of quarters.

#include "../tests/support/mesh_makers.h"
#include "batten/mesh_refine.h"
#include "timing.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Sqrt3T.hh>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace
{

using Point = std::array<double, 3>;
using Face = std::array<uint32_t, 3>;

struct Result
{
    std::vector<Point> points;
    std::vector<Face> faces;
};

// --- The peers ---

struct Traits : OpenMesh::DefaultTraits
{
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using PeerMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

PeerMesh to_openmesh(const bat_mesh &mesh)
{
    PeerMesh peer;
    peer.reserve(mesh.vertex_count, 3 * mesh.face_count / 2, mesh.face_count);
    std::vector<PeerMesh::VertexHandle> handles;
    for (size_t v = 0; v < mesh.vertex_count; v++)
        handles.push_back(peer.add_vertex({mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]}));
    for (size_t f = 0; f < mesh.face_count; f++)
        peer.add_face(handles[mesh.faces[3 * f]], handles[mesh.faces[3 * f + 1]], handles[mesh.faces[3 * f + 2]]);
    return peer;
}

/// Build the mesh and refine it: what is timed.
template <typename Subdivider> PeerMesh refine_openmesh(const bat_mesh &mesh, size_t levels)
{
    PeerMesh peer = to_openmesh(mesh);
    Subdivider subdivider;
    subdivider.attach(peer);
    subdivider(levels);
    subdivider.detach();
    return peer;
}

Result result_of(const PeerMesh &peer)
{
    Result result;
    for (auto v : peer.vertices())
        result.points.push_back({peer.point(v)[0], peer.point(v)[1], peer.point(v)[2]});
    for (auto f : peer.faces())
    {
        Face face{};
        size_t c = 0;
        for (auto v : peer.fv_range(f))
            face[c++] = static_cast<uint32_t>(v.idx());
        result.faces.push_back(face);
    }
    return result;
}

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Row
{
    double p[3];
    void Clear()
    {
        p[0] = p[1] = p[2] = 0;
    }
    void AddWithWeight(const Row &other, double weight)
    {
        for (int i = 0; i < 3; i++)
            p[i] += weight * other.p[i];
    }
};

/// What OpenSubdiv reads, in its own types.
struct Description
{
    std::vector<int> face_sizes, corners, crease_ends, corner_vertices;
    std::vector<float> crease_weights, corner_weights;
    Far::TopologyDescriptor descriptor;
};

void describe(const bat_mesh &mesh, Description &made)
{
    made.face_sizes.assign(mesh.face_count, 3);
    made.corners.assign(mesh.faces, mesh.faces + 3 * mesh.face_count);
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
    made.descriptor.numVertices = static_cast<int>(mesh.vertex_count);
    made.descriptor.numFaces = static_cast<int>(mesh.face_count);
    made.descriptor.numVertsPerFace = made.face_sizes.data();
    made.descriptor.vertIndicesPerFace = made.corners.data();
    made.descriptor.numCreases = static_cast<int>(mesh.crease_count);
    made.descriptor.creaseVertexIndexPairs = made.crease_ends.data();
    made.descriptor.creaseWeights = made.crease_weights.data();
    made.descriptor.numCorners = static_cast<int>(mesh.corner_count);
    made.descriptor.cornerVertexIndices = made.corner_vertices.data();
    made.descriptor.cornerWeights = made.corner_weights.data();
}

/// Set up, refine and interpolate: what is timed.
std::unique_ptr<Far::TopologyRefiner> refine_opensubdiv(const bat_mesh &mesh, size_t levels, std::vector<Row> &rows)
{
    Description description;
    describe(mesh, description);
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(description.descriptor, Factory::Options(Sdc::SCHEME_LOOP, options)));
    refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(static_cast<int>(levels)));
    rows.resize(mesh.vertex_count);
    memcpy(rows.data(), mesh.positions, 3 * mesh.vertex_count * sizeof *mesh.positions);
    Far::PrimvarRefinerReal<double> interpolator(*refiner);
    for (int level = 1; level <= static_cast<int>(levels); level++)
    {
        std::vector<Row> next(static_cast<size_t>(refiner->GetLevel(level).GetNumVertices()));
        interpolator.Interpolate(level, rows, next);
        rows.swap(next);
    }
    return refiner;
}

Result result_of(const Far::TopologyRefiner &refiner, const std::vector<Row> &rows)
{
    Result result;
    const Far::TopologyLevel &level = refiner.GetLevel(refiner.GetMaxLevel());
    for (const Row &row : rows)
        result.points.push_back({row.p[0], row.p[1], row.p[2]});
    for (int f = 0; f < level.GetNumFaces(); f++)
    {
        Far::ConstIndexArray corners = level.GetFaceVertices(f);
        result.faces.push_back(
            {static_cast<uint32_t>(corners[0]), static_cast<uint32_t>(corners[1]), static_cast<uint32_t>(corners[2])});
    }
    return result;
}

// --- Ours ---

bat_mesh refine_batten(const bat_mesh &mesh, bat_mesh_scheme scheme, size_t levels, int threads = 0)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = scheme;
    options.levels = levels;
    options.threads = threads;
    bat_mesh fine;
    bat_error error;
    if (bat_mesh_refine(&mesh, &options, &fine, nullptr, &error) != BAT_OK)
    {
        std::fprintf(stderr, "peer_mesh: %s\n", error.text);
        std::exit(1);
    }
    return fine;
}

Result result_of(const bat_mesh &mesh)
{
    Result result;
    for (size_t v = 0; v < mesh.vertex_count; v++)
        result.points.push_back({mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]});
    for (size_t f = 0; f < mesh.face_count; f++)
        result.faces.push_back({mesh.faces[3 * f], mesh.faces[3 * f + 1], mesh.faces[3 * f + 2]});
    return result;
}

// --- Are two results the same? ---

double extent(const Result &result)
{
    double size = 0;
    for (const Point &p : result.points)
        for (double x : p)
            size = std::max(size, std::fabs(x));
    return size;
}

double distance(const Point &p, const Point &q)
{
    return std::max({std::fabs(p[0] - q[0]), std::fabs(p[1] - q[1]), std::fabs(p[2] - q[2])});
}

/// For every point of `a` the nearest of `b`, searched among those of about the same x; returns the largest distance.
double match(const Result &a, const Result &b, std::vector<uint32_t> &partner)
{
    const double window = 1e-9 * extent(a);
    std::vector<uint32_t> order(b.points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](uint32_t i, uint32_t j) { return b.points[i][0] < b.points[j][0]; });
    double worst = 0;
    partner.assign(a.points.size(), 0);
    for (size_t i = 0; i < a.points.size(); i++)
    {
        double nearest = HUGE_VAL;
        auto at = std::lower_bound(order.begin(), order.end(), a.points[i][0] - window,
                                   [&](uint32_t j, double x) { return b.points[j][0] < x; });
        for (; at != order.end() && b.points[*at][0] <= a.points[i][0] + window; ++at)
            if (distance(a.points[i], b.points[*at]) < nearest)
            {
                nearest = distance(a.points[i], b.points[*at]);
                partner[i] = *at;
            }
        worst = std::max(worst, nearest);
    }
    return worst;
}

/// Faces with their least corner first, sorted.
std::vector<Face> canonical(std::vector<Face> faces)
{
    for (Face &face : faces)
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    std::sort(faces.begin(), faces.end());
    return faces;
}

int failures = 0;

void check(const std::string &what, const Result &ours, const Result &peer)
{
    constexpr double FLOOR = 1e-12;
    if (ours.points.size() != peer.points.size() || ours.faces.size() != peer.faces.size())
    {
        std::printf("%-58s FAILS: %zu vertices and %zu faces, the peer's has %zu and %zu\n", what.c_str(),
                    ours.points.size(), ours.faces.size(), peer.points.size(), peer.faces.size());
        failures++;
        return;
    }
    std::vector<uint32_t> partner;
    double worst = match(ours, peer, partner) / extent(ours);
    std::vector<Face> faces = ours.faces;
    for (Face &face : faces)
        for (uint32_t &corner : face)
            corner = partner[corner];
    bool same_faces = canonical(faces) == canonical(peer.faces), good = worst <= FLOOR && same_faces;
    failures += good ? 0 : 1;
    std::printf("%-58s %8zu vertices, off by %.1e of the size at most, faces %s%s\n", what.c_str(), ours.points.size(),
                worst, same_faces ? "the same" : "DIFFER", good ? "" : "  FAILS");
}

template <typename Subdivider>
void check_openmesh(const std::string &name, const bat_mesh &mesh, bat_mesh_scheme scheme, size_t levels)
{
    bat_mesh ours = refine_batten(mesh, scheme, levels);
    check("OpenMesh " + name, result_of(ours), result_of(refine_openmesh<Subdivider>(mesh, levels)));
    bat_mesh_free(&ours);
}

void check_opensubdiv(const std::string &name, const bat_mesh &mesh, size_t levels)
{
    bat_mesh ours = refine_batten(mesh, BAT_MESH_SCHEME_LOOP, levels);
    std::vector<Row> rows;
    auto refiner = refine_opensubdiv(mesh, levels, rows);
    check("OpenSubdiv Loop " + name, result_of(ours), result_of(*refiner, rows));
    bat_mesh_free(&ours);
}

using Loop = OpenMesh::Subdivider::Uniform::LoopT<PeerMesh, double>;
using Butterfly = OpenMesh::Subdivider::Uniform::ModifiedButterflyT<PeerMesh, double>;
using Sqrt3 = OpenMesh::Subdivider::Uniform::Sqrt3T<PeerMesh, double>;

void check_closed(const std::string &name, const bat_mesh &mesh)
{
    check_openmesh<Loop>("Loop, " + name, mesh, BAT_MESH_SCHEME_LOOP, 3);
    check_openmesh<Butterfly>("butterfly, " + name, mesh, BAT_MESH_SCHEME_BUTTERFLY, 3);
    check_openmesh<Sqrt3>("sqrt(3), " + name, mesh, BAT_MESH_SCHEME_SQRT3, 4);
}

/// Give some edges and vertices sharpness. Of those around a vertex, a power of two fade at a time, as OpenSubdiv takes
/// their mean in single precision: all semi-sharp edges have the same sharpness.
void sharpen(bat_mesh &mesh, double sharpness, double share, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_mesh_connectivity links;
    if (bat_mesh_connect(&mesh, &links, nullptr) != BAT_OK)
        std::abort();
    mesh.creases = static_cast<bat_mesh_crease *>(mesh_room(links.edge_count, sizeof *mesh.creases));
    mesh.corners = static_cast<bat_mesh_corner *>(mesh_room(mesh.vertex_count, sizeof *mesh.corners));
    for (uint32_t h = 0; h < 3 * mesh.face_count; h++)
        if (links.twin[h] != BAT_MESH_NONE && links.twin[h] > h && bat_random_uniform(&random) < share)
            mesh.creases[mesh.crease_count++] = {mesh.faces[h], mesh.faces[bat_mesh_next(h)],
                                                 bat_random_uniform(&random) < 0.5 ? sharpness : BAT_MESH_SHARP};
    for (uint32_t v = 0; v < mesh.vertex_count; v++)
        if (bat_random_uniform(&random) < share / 4)
            mesh.corners[mesh.corner_count++] = {v, bat_random_uniform(&random) < 0.5 ? sharpness : BAT_MESH_SHARP};
    bat_mesh_connectivity_free(&links);
}

void unsharpen(bat_mesh &mesh)
{
    std::free(mesh.creases);
    std::free(mesh.corners);
    mesh.creases = nullptr;
    mesh.corners = nullptr;
    mesh.crease_count = mesh.corner_count = 0;
}

void check_sharp(const std::string &name, bat_mesh &mesh)
{
    check_opensubdiv(name, mesh, 3);
    for (double sharpness : {BAT_MESH_SHARP, 0.25, 1.0, 1.75, 2.5})
        for (double share : {0.1, 0.35})
        {
            sharpen(mesh, sharpness, share, 7);
            char text[80];
            std::snprintf(text, sizeof text, ", %.0f %% of edges %g sharp", 100 * share, sharpness);
            check_opensubdiv(name + text, mesh, 4);
            unsharpen(mesh);
        }
}

// --- Times ---

constexpr int ROUNDS = 5;

template <typename Work> double seconds_of(Work work)
{
    double start = seconds_now();
    work();
    return seconds_now() - start;
}

struct Times
{
    std::vector<double> ours, one_thread, openmesh, opensubdiv;
};

void print_ratio(const char *name, std::vector<double> &peer, std::vector<double> &ours, double floor)
{
    double ratio = median_of(peer.data(), peer.size()) / median_of(ours.data(), ours.size());
    std::printf("  %-44s %6.1f times as fast", name, ratio);
    if (floor > 0)
        std::printf(" (floor %.0f)%s", floor, ratio < floor ? "  BELOW" : "");
    std::printf("\n");
}

template <typename Subdivider>
void time_scheme(const char *name, const bat_mesh &mesh, bat_mesh_scheme scheme, size_t levels, bool opensubdiv,
                 double floor)
{
    Times times;
    for (int round = 0; round < ROUNDS; round++)
    {
        for (int threads : {0, 1})
        {
            bat_mesh fine;
            (threads == 0 ? times.ours : times.one_thread)
                .push_back(seconds_of([&] { fine = refine_batten(mesh, scheme, levels, threads); }));
            bat_mesh_free(&fine);
        }
        times.openmesh.push_back(seconds_of([&] { refine_openmesh<Subdivider>(mesh, levels); }));
        std::vector<Row> rows;
        if (opensubdiv)
            times.opensubdiv.push_back(seconds_of([&] { refine_opensubdiv(mesh, levels, rows); }));
    }
    std::printf("%s, %zu faces by %zu levels:\n", name, mesh.face_count, levels);
    print_ratio("against OpenMesh", times.openmesh, times.ours, floor);
    print_ratio("against OpenMesh, both on one thread", times.openmesh, times.one_thread, 0);
    if (opensubdiv)
    {
        print_ratio("against OpenSubdiv", times.opensubdiv, times.ours, 4);
        print_ratio("against OpenSubdiv, both on one thread", times.opensubdiv, times.one_thread, 0);
    }
}

// --- Meshes from files ---

/// The triangles of an OBJ file; enough for meshes of triangles without surprises.
bat_mesh read_obj(const char *path)
{
    std::vector<Point> points;
    std::vector<Face> faces;
    FILE *file = std::fopen(path, "r");
    char line[512];
    while (file != nullptr && std::fgets(line, sizeof line, file) != nullptr)
    {
        Point p;
        Face f;
        if (std::sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3)
            points.push_back(p);
        else if (std::sscanf(line, "f %u%*[^ ] %u%*[^ ] %u", &f[0], &f[1], &f[2]) == 3 ||
                 std::sscanf(line, "f %u %u %u", &f[0], &f[1], &f[2]) == 3)
            faces.push_back({f[0] - 1, f[1] - 1, f[2] - 1});
    }
    if (file != nullptr)
        std::fclose(file);
    bat_mesh mesh = mesh_with_room(points.size(), faces.size());
    for (size_t v = 0; v < points.size(); v++)
        mesh_set_vertex(&mesh, v, points[v][0], points[v][1], points[v][2]);
    for (size_t f = 0; f < faces.size(); f++)
        mesh_set_face(&mesh, f, faces[f][0], faces[f][1], faces[f][2]);
    return mesh;
}

void check_file(const char *path)
{
    bat_mesh mesh = read_obj(path);
    bat_mesh_connectivity links;
    bat_error error;
    if (bat_mesh_check(&mesh, &error) != BAT_OK || bat_mesh_connect(&mesh, &links, &error) != BAT_OK)
        std::printf("%s: %s\n", path, error.text);
    else
    {
        if (links.boundary_edge_count == 0)
            check_closed(path, mesh);
        check_opensubdiv(std::string(", ") + path, mesh, 2);
        bat_mesh_connectivity_free(&links);
    }
    bat_mesh_free(&mesh);
}

} // namespace

int main(int argc, char **argv)
{
    bat_mesh irregular = mesh_irregular(40, 25, 1), grid = mesh_grid(30, 20), large = mesh_irregular(200, 100, 2);
    mesh_shake(&grid, 0.2, 9);
    for (size_t v = 0; v < grid.vertex_count; v++)
        grid.positions[3 * v + 2] += std::sin(0.5 * grid.positions[3 * v]);
    check_closed("closed, 3 to 12 faces a vertex", irregular);
    check_sharp("closed", irregular);
    check_sharp("with boundary", grid);
    for (int i = 1; i < argc; i++)
        check_file(argv[i]);
    if (failures > 0)
        std::printf("%d results differ\n", failures);
    std::printf("\nMedians of %d rounds in turn, neighbours from the list of faces included:\n", ROUNDS);
    time_scheme<Loop>("Loop", large, BAT_MESH_SCHEME_LOOP, 3, true, 8);
    time_scheme<Butterfly>("Butterfly", large, BAT_MESH_SCHEME_BUTTERFLY, 3, false, 8);
    time_scheme<Sqrt3>("sqrt(3)", large, BAT_MESH_SCHEME_SQRT3, 4, false, 0);
    bat_mesh_free(&irregular);
    bat_mesh_free(&grid);
    bat_mesh_free(&large);
    return failures > 0;
}
