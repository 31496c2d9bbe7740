// Loop's and Catmull and Clark's schemes against OpenSubdiv 3.5, on shapes of every kind: positions, texture coordinates,
// faces, limits. Sharpness is made of quarters, because OpenSubdiv keeps it in single precision. For the same reason at most
// two semi-sharp edges meet at a vertex: the mean of three is rounded there.

#include "../support/opensubdiv.hpp"
#include "../support/polygon_makers.h"

extern "C"
{
#include "mesh/sides.h"
}

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>

namespace
{

constexpr double FLOOR = 1e-12;
constexpr int LEVELS = 4;
int failures = 0, comparisons = 0;
double worst_of_all = 0;

[[noreturn]] void fail(const char *what)
{
    std::fprintf(stderr, "%s\n", what);
    std::exit(1);
}

/// The links of a mesh of polygons.
struct Links
{
    std::vector<uint32_t> face_of;
    mesh_sides sides{};
    bat_mesh_connectivity links{};
    explicit Links(const bat_mesh &mesh)
    {
        for (uint32_t f = 0; f < mesh.face_count; f++)
            face_of.insert(face_of.end(), peer::first_corner(mesh, f + 1) - peer::first_corner(mesh, f), f);
        sides.offsets = mesh.offsets;
        sides.face = face_of.data();
        bat_error error;
        if (sides_connect(&sides, mesh.faces, mesh.face_count, mesh.vertex_count, &links, &error) != BAT_OK)
            fail(error.text);
    }
    Links(const Links &) = delete;
    Links &operator=(const Links &) = delete;
    ~Links()
    {
        bat_mesh_connectivity_free(&links);
    }
};

bat_mesh refine(const bat_mesh &mesh, bool loop, const bat_mesh_rules &rules, size_t levels, bool limit)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = loop ? BAT_MESH_SCHEME_LOOP : BAT_MESH_SCHEME_CATMULL_CLARK;
    options.levels = levels;
    options.rules = rules;
    options.limit = limit;
    bat_mesh fine;
    bat_error error;
    if (bat_mesh_refine(&mesh, &options, &fine, nullptr, &error) != BAT_OK)
        fail(error.text);
    return fine;
}

/// OpenSubdiv's numbers of our vertices and faces on a level.
struct Numbers
{
    std::vector<int> vertex, face;
};

/// The place of a vertex among a face's corners.
int place_of(const peer::Far::ConstIndexArray &corners, int vertex)
{
    for (int i = 0; i < corners.size(); i++)
        if (corners[i] == vertex)
            return i;
    fail("a face has another corner than the peer's");
}

/// The numbers of the next level. `mesh` is our mesh of this one.
Numbers next_numbers(const bat_mesh &mesh, const Numbers &now, const peer::Far::TopologyLevel &level, bool loop)
{
    Links made(mesh);
    Numbers next;
    size_t vertices = mesh.vertex_count, edges = made.links.edge_count;
    next.vertex.resize(vertices + edges + (loop ? 0 : mesh.face_count));
    for (size_t v = 0; v < vertices; v++)
        next.vertex[v] = level.GetVertexChildVertex(now.vertex[v]);
    for (uint32_t f = 0; f < mesh.face_count; f++)
    {
        peer::Far::ConstIndexArray corners = level.GetFaceVertices(now.face[f]);
        peer::Far::ConstIndexArray children = level.GetFaceChildFaces(now.face[f]);
        for (uint32_t h = peer::first_corner(mesh, f); h < peer::first_corner(mesh, f + 1); h++)
        {
            int a = now.vertex[mesh.faces[h]], b = now.vertex[mesh.faces[sides_next(&made.sides, h)]];
            next.vertex[vertices + made.links.edge[h]] = level.GetEdgeChildVertex(level.FindEdge(a, b));
            next.face.push_back(children[place_of(corners, a)]);
        }
        if (loop)
            next.face.push_back(children[3]);
        else
            next.vertex[vertices + edges + f] = level.GetFaceChildVertex(now.face[f]);
    }
    return next;
}

template <typename Row> double difference(const double *ours, const Row &peers)
{
    double largest = 0;
    for (size_t i = 0; i < sizeof peers.p / sizeof *peers.p; i++)
        largest = std::max(largest, std::fabs(ours[i] - peers.p[i]));
    return largest;
}

void report(const std::string &what, double worst)
{
    comparisons++;
    worst_of_all = std::max(worst_of_all, worst);
    if (worst <= FLOOR)
        return;
    failures++;
    std::printf("%-90s off by %.1e\n", what.c_str(), worst);
}

/// Compare limits on the last level: positions but at darts and vertices of two faces, where the peer has other formulas.
void check_limit(const std::string &what, const bat_mesh &mesh, bool loop, const bat_mesh_rules &rules)
{
    peer::Description description;
    peer::describe(mesh, description);
    using Factory = peer::Far::TopologyRefinerFactory<peer::Far::TopologyDescriptor>;
    std::unique_ptr<peer::Far::TopologyRefiner> refiner(
        Factory::Create(description.descriptor, Factory::Options(loop ? peer::Sdc::SCHEME_LOOP : peer::Sdc::SCHEME_CATMARK,
                                                                 peer::options_of(rules))));
    peer::Far::TopologyRefiner::UniformOptions how(1);
    how.fullTopologyInLastLevel = true;
    refiner->RefineUniform(how);
    peer::Far::PrimvarRefinerReal<double> interpolator(*refiner);
    std::vector<peer::Point> coarse(mesh.vertex_count), fine(static_cast<size_t>(refiner->GetLevel(1).GetNumVertices()));
    for (size_t v = 0; v < mesh.vertex_count; v++)
        coarse[v] = {{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]}};
    interpolator.Interpolate(1, coarse, fine);
    std::vector<peer::Point> limits(fine.size()), along(fine.size()), across(fine.size());
    interpolator.Limit(fine, limits, along, across);

    bat_mesh control = refine(mesh, loop, rules, 1, false), ours = refine(mesh, loop, rules, 1, true);
    std::vector<double> normals(3 * ours.vertex_count);
    bat_mesh triangles{};
    bat_error error;
    bat_status status = loop ? bat_mesh_triangulate(&control, &triangles, &error) : BAT_OK;
    if (status == BAT_OK)
        status = loop ? bat_mesh_limit_normals(&triangles, 1, normals.data(), &error)
                      : bat_mesh_limit_normals(&control, 1, normals.data(), &error);
    if (status != BAT_OK)
        fail(error.text);
    Numbers numbers{std::vector<int>(mesh.vertex_count), std::vector<int>(mesh.face_count)};
    std::iota(numbers.vertex.begin(), numbers.vertex.end(), 0);
    std::iota(numbers.face.begin(), numbers.face.end(), 0);
    numbers = next_numbers(mesh, numbers, refiner->GetLevel(0), loop);
    const peer::Far::TopologyLevel &level = refiner->GetLevel(1);
    double worst = 0, worst_normal = 0;
    for (size_t v = 0; v < ours.vertex_count; v++)
    {
        int number = numbers.vertex[v];
        size_t at = static_cast<size_t>(number);
        peer::Far::ConstIndexArray edges = level.GetVertexEdges(number);
        int sharp = 0, boundary = 0;
        for (int i = 0; i < edges.size(); i++)
        {
            sharp += level.GetEdgeSharpness(edges[i]) > 0;
            boundary += level.IsEdgeBoundary(edges[i]);
        }
        bool corner = level.GetVertexSharpness(number) > 0 || sharp > 2;
        if ((sharp == 1 && !corner) || edges.size() == 2)
            continue;
        worst = std::max(worst, difference(ours.positions + 3 * v, limits[at]));
        if (corner || (sharp > 0 && boundary != 2))
            continue;
        const double *a = along[at].p, *b = across[at].p;
        peer::Point normal{{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
        double length = std::hypot(normal.p[0], normal.p[1], normal.p[2]);
        for (double &x : normal.p)
            x /= length;
        worst_normal = std::max(worst_normal, difference(normals.data() + 3 * v, normal));
    }
    report(what + ", limit", worst);
    report(what + ", limit normals / 100", worst_normal / 100);
    bat_mesh_free(&triangles);
    bat_mesh_free(&control);
    bat_mesh_free(&ours);
}

/// Under the boundary rule "none" the faces that are left have the positions that they have with the boundary.
void check_holes(const std::string &what, const bat_mesh &mesh, bool loop, bat_mesh_rules rules)
{
    rules.boundary = BAT_MESH_BOUNDARY_NONE;
    peer::Refined refined = peer::refine(mesh, loop, rules, 2);
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = loop ? BAT_MESH_SCHEME_LOOP : BAT_MESH_SCHEME_CATMULL_CLARK;
    options.rules = rules;
    bat_mesh ours{}, whole;
    bat_error error;
    bat_status status = bat_mesh_refine(&mesh, &options, &ours, nullptr, &error);
    if (status != BAT_OK && status != BAT_UNSUPPORTED)
        fail(error.text);
    rules.boundary = BAT_MESH_BOUNDARY_EDGES;
    whole = refine(mesh, loop, rules, 2, false);
    double worst = 0;
    size_t at = 0;
    uint32_t sides = loop ? 3 : 4, first = 0;
    for (uint32_t f = 0; f < mesh.face_count; f++)
    {
        uint32_t children = loop ? 16 : 4 * (peer::first_corner(mesh, f + 1) - peer::first_corner(mesh, f));
        if (!refined.refiner->GetLevel(0).IsFaceHole(static_cast<int>(f)))
            for (uint32_t i = sides * first; i < sides * (first + children); i++, at++)
                for (size_t k = 0; k < 3; k++)
                    worst = at < sides * ours.face_count
                                ? std::max(worst, std::fabs(ours.positions[3 * (size_t)ours.faces[at] + k] -
                                                            whole.positions[3 * (size_t)whole.faces[i] + k]))
                                : 1;
        first += children;
    }
    report(what + ", no boundary", at == sides * ours.face_count ? worst : 2);
    bat_mesh_free(&ours);
    bat_mesh_free(&whole);
}

/// Compare positions, faces and texture on all levels.
void check(const std::string &what, const bat_mesh &mesh, bool loop, const bat_mesh_rules &rules)
{
    peer::Refined refined = peer::refine(mesh, loop, rules, LEVELS);
    Numbers numbers{std::vector<int>(mesh.vertex_count), std::vector<int>(mesh.face_count)};
    std::iota(numbers.vertex.begin(), numbers.vertex.end(), 0);
    std::iota(numbers.face.begin(), numbers.face.end(), 0);
    bat_mesh before;
    if (bat_mesh_copy(&mesh, &before, nullptr) != BAT_OK)
        fail("out of memory");
    for (size_t level = 1; level <= LEVELS; level++)
    {
        numbers = next_numbers(before, numbers, refined.refiner->GetLevel(static_cast<int>(level) - 1), loop);
        bat_mesh_free(&before);
        before = refine(mesh, loop, rules, level, false);
        const peer::Far::TopologyLevel &topology = refined.refiner->GetLevel(static_cast<int>(level));
        double worst = 0, worst_texture = 0;
        if (before.vertex_count != refined.points[level].size() ||
            before.face_count != static_cast<size_t>(topology.GetNumFaces()))
            fail("the numbers of vertices or faces differ");
        for (size_t v = 0; v < before.vertex_count; v++)
            worst = std::max(
                worst, difference(before.positions + 3 * v, refined.points[level][static_cast<size_t>(numbers.vertex[v])]));
        for (size_t f = 0; f < before.face_count; f++)
        {
            peer::Far::ConstIndexArray corners = topology.GetFaceVertices(numbers.face[f]);
            for (uint32_t h = peer::first_corner(before, f); h < peer::first_corner(before, f + 1); h++)
            {
                int place = place_of(corners, numbers.vertex[before.faces[h]]);
                if (before.texture_faces == nullptr)
                    continue;
                int value = topology.GetFaceFVarValues(numbers.face[f], 0)[place];
                worst_texture = std::max(worst_texture, difference(before.texture + 2 * (size_t)before.texture_faces[h],
                                                                   refined.places[level][static_cast<size_t>(value)]));
            }
        }
        report(what + ", level " + std::to_string(level), worst);
        if (before.texture_faces != nullptr)
            report(what + ", texture of level " + std::to_string(level), worst_texture);
    }
    bat_mesh_free(&before);
}

/// Sharpen edges and vertices by chance.
void sharpen(bat_mesh &mesh, const std::vector<double> &values, double share, uint64_t seed)
{
    Links made(mesh);
    bat_random random = bat_random_seed(seed);
    std::vector<int> semi_sharp(mesh.vertex_count);
    mesh.creases = static_cast<bat_mesh_crease *>(mesh_room(made.links.edge_count, sizeof *mesh.creases));
    mesh.corners = static_cast<bat_mesh_corner *>(mesh_room(mesh.vertex_count, sizeof *mesh.corners));
    for (uint32_t h = 0; h < peer::first_corner(mesh, mesh.face_count); h++)
    {
        uint32_t a = mesh.faces[h], b = mesh.faces[sides_next(&made.sides, h)];
        double sharpness = values[static_cast<size_t>(bat_random_uniform(&random) * static_cast<double>(values.size()))];
        if (made.links.twin[h] < h || bat_random_uniform(&random) >= share)
            continue;
        bool semi = sharpness < BAT_MESH_SHARP;
        if (semi && (semi_sharp[a] > 1 || semi_sharp[b] > 1))
            continue;
        semi_sharp[a] += semi;
        semi_sharp[b] += semi;
        mesh.creases[mesh.crease_count++] = {a, b, sharpness};
    }
    for (uint32_t v = 0; v < mesh.vertex_count; v++)
        if (semi_sharp[v] < 2 && bat_random_uniform(&random) < share / 4)
        {
            double sharpness = values[static_cast<size_t>(bat_random_uniform(&random) * static_cast<double>(values.size()))];
            mesh.corners[mesh.corner_count++] = {v, sharpness};
        }
}

void unsharpen(bat_mesh &mesh)
{
    std::free(mesh.creases);
    std::free(mesh.corners);
    mesh.creases = nullptr;
    mesh.corners = nullptr;
    mesh.crease_count = mesh.corner_count = 0;
}

/// Give a mesh texture coordinates that part at some edges, by chance: corners of faces at a vertex share one where the edge
/// between them is whole.
void texture(bat_mesh &mesh, double cut, uint64_t seed)
{
    Links made(mesh);
    bat_random random = bat_random_seed(seed);
    uint32_t corners = peer::first_corner(mesh, mesh.face_count);
    std::vector<uint32_t> root(corners);
    std::iota(root.begin(), root.end(), 0U);
    auto find = [&](uint32_t i)
    {
        while (root[i] != i)
            i = root[i] = root[root[i]];
        return i;
    };
    for (uint32_t h = 0; h < corners; h++)
    {
        uint32_t twin = made.links.twin[h];
        if (twin == BAT_MESH_NONE || twin < h || bat_random_uniform(&random) < cut)
            continue;
        root[find(sides_next(&made.sides, twin))] = find(h);
        root[find(sides_next(&made.sides, h))] = find(twin);
    }
    std::vector<uint32_t> number(corners, BAT_MESH_NONE);
    mesh.texture_faces = static_cast<uint32_t *>(mesh_room(corners, sizeof *mesh.texture_faces));
    for (uint32_t h = 0; h < corners; h++)
    {
        uint32_t &value = number[find(h)];
        if (value == BAT_MESH_NONE)
            value = static_cast<uint32_t>(mesh.texture_count++);
        mesh.texture_faces[h] = value;
    }
    mesh.texture = static_cast<double *>(mesh_room(mesh.texture_count, 2 * sizeof *mesh.texture));
    for (size_t i = 0; i < 2 * mesh.texture_count; i++)
        mesh.texture[i] = bat_random_uniform(&random);
}

void untexture(bat_mesh &mesh)
{
    std::free(mesh.texture);
    std::free(mesh.texture_faces);
    mesh.texture = nullptr;
    mesh.texture_faces = nullptr;
    mesh.texture_count = 0;
}

/// All rules for a mesh as it is.
void check_rules(const std::string &what, const bat_mesh &mesh, bool loop)
{
    for (bat_mesh_boundary boundary : {BAT_MESH_BOUNDARY_EDGES, BAT_MESH_BOUNDARY_CORNERS})
        for (bat_mesh_creasing creasing : {BAT_MESH_CREASING_UNIFORM, BAT_MESH_CREASING_CHAIKIN})
        {
            bat_mesh_rules rules{boundary, creasing, BAT_MESH_LINEAR_AUTO};
            std::string name = what + ", " + bat_choice_name(&bat_mesh_boundary_family, boundary) + ", " +
                               bat_choice_name(&bat_mesh_creasing_family, creasing);
            check(name, mesh, loop, rules);
            check_limit(name, mesh, loop, rules);
        }
    check_holes(what, mesh, loop, {});
}

void check_texture(const std::string &what, const bat_mesh &mesh, bool loop)
{
    for (int linear = BAT_MESH_LINEAR_ALL; linear <= BAT_MESH_LINEAR_BOUNDARIES; linear++)
        for (bat_mesh_boundary boundary : {BAT_MESH_BOUNDARY_EDGES, BAT_MESH_BOUNDARY_CORNERS})
        {
            bat_mesh_rules rules{boundary, BAT_MESH_CREASING_AUTO, static_cast<bat_mesh_linear>(linear)};
            check(what + ", " + bat_choice_name(&bat_mesh_boundary_family, boundary) + ", " +
                      bat_choice_name(&bat_mesh_linear_family, rules.linear),
                  mesh, loop, rules);
        }
}

/// Everything on one shape, which is released.
void check_shape(const std::string &name, bat_mesh mesh, bool loop)
{
    std::string what = (loop ? "Loop, " : "Catmull-Clark, ") + name;
    check_rules(what, mesh, loop);
    for (double cut : {0.05, 0.3, 1.0})
    {
        texture(mesh, cut, 5);
        check_texture(what + ", seams " + std::to_string(cut), mesh, loop);
        untexture(mesh);
    }
    uint64_t seed = 1;
    const std::vector<std::vector<double>> kinds = {{BAT_MESH_SHARP}, {0.5}, {2.25}, {0.75, 1.5, 3.25, BAT_MESH_SHARP}};
    for (const std::vector<double> &values : kinds)
        for (double share : {0.15, 0.4})
        {
            std::string sharp = what + ", sharpness " + std::to_string(values[0]) + " " + std::to_string(share);
            sharpen(mesh, values, share, seed++);
            check_rules(sharp, mesh, loop);
            texture(mesh, 0.2, seed);
            check_texture(sharp, mesh, loop);
            untexture(mesh);
            unsharpen(mesh);
        }
    bat_mesh_free(&mesh);
}

bat_mesh shaken(bat_mesh mesh, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.positions[i] += 0.3 * bat_random_uniform(&random);
    return mesh;
}

/// Triangles as polygons, or joined to polygons in part.
bat_mesh polygons_of(bat_mesh mesh, double share)
{
    bat_mesh made = polygon_mixed(&mesh, share, 3);
    bat_mesh_free(&mesh);
    return made;
}

bat_mesh shaken_grid(uint32_t columns, uint32_t rows)
{
    bat_mesh mesh = mesh_grid(columns, rows);
    mesh_shake(&mesh, 0.2, 4);
    return mesh;
}

/// A prism over a polygon, with an open top.
bat_mesh cup(uint32_t sides)
{
    bat_mesh mesh = polygon_with_room(2 * (size_t)sides, sides + 1, 5 * (size_t)sides, 4);
    for (uint32_t i = 0; i < sides; i++)
    {
        uint32_t next = (i + 1) % sides;
        const uint32_t quad[4] = {i, next, sides + next, sides + i};
        std::copy(quad, quad + 4, mesh.faces + 4 * i);
        mesh.faces[5 * sides - 1 - i] = i;
        for (uint32_t k = 0; k < 2; k++)
        {
            double *p = mesh.positions + 3 * (size_t)(k * sides + i);
            p[0] = std::cos(6.283185307179586 * i / sides);
            p[1] = std::sin(6.283185307179586 * i / sides);
            p[2] = k;
        }
    }
    mesh.offsets[sides + 1] = 5 * sides;
    return mesh;
}

/// Edges of three faces and vertices of two fans are refused.
void check_refused()
{
    bat_mesh fin = polygon_with_room(8, 3, 12, 4), pinch = polygon_with_room(7, 2, 8, 4);
    const uint32_t fins[12] = {0, 1, 2, 3, 1, 0, 4, 5, 0, 1, 6, 7}, fans[8] = {0, 1, 2, 3, 0, 4, 5, 6};
    std::copy(fins, fins + 12, fin.faces);
    std::copy(fans, fans + 8, pinch.faces);
    for (bat_mesh *mesh : {&fin, &pinch})
    {
        bat_mesh fine;
        bat_error error;
        comparisons++;
        failures += bat_mesh_refine(mesh, nullptr, &fine, nullptr, &error) != BAT_NOT_MANIFOLD;
        bat_mesh_free(mesh);
    }
}

} // namespace

int main()
{
    check_shape("closed", polygons_of(mesh_irregular(8, 6, 1), 0), true);
    check_shape("tetrahedron", polygons_of(mesh_tetrahedron(), 0), true);
    check_shape("with boundary", polygons_of(shaken_grid(6, 5), 0), true);
    check_shape("a triangle", polygons_of(mesh_grid(2, 2), 0), true);
    check_shape("a fan of five", polygons_of(mesh_fan(5, true), 0), true);
    check_shape("cube", shaken(polygon_cube(), 1), false);
    check_shape("one quad", shaken(polygon_grid(2, 2), 2), false);
    check_shape("grid", shaken(polygon_grid(5, 4), 3), false);
    check_shape("torus", shaken(polygon_torus(6, 5), 4), false);
    check_shape("triangles", polygons_of(mesh_irregular(7, 5, 2), 0), false);
    check_shape("triangles and quads", polygons_of(mesh_irregular(8, 6, 3), 0.9), false);
    check_shape("triangles and quads with boundary", polygons_of(shaken_grid(6, 5), 0.8), false);
    check_shape("pentagon with walls", shaken(cup(5), 5), false);
    check_shape("polygon of 11 with walls", shaken(cup(11), 6), false);
    check_refused();
    std::printf("%d of %d comparisons fail; off by %.1e at most\n", failures, comparisons, worst_of_all);
    return failures > 0;
}
