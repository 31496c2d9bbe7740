#ifndef FUZZ_BYTE_READER_H
#define FUZZ_BYTE_READER_H

#include "promise.h"

#include "batten/batten.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Inputs of computing calls from the bytes of a fuzzer: numbers, points of a space, curves, meshes.

/// What is left of the bytes. Behind the end all are 0.
typedef struct byte_reader
{
    const uint8_t *data;
    size_t size;
} byte_reader;

static inline unsigned take_byte(byte_reader *reader)
{
    if (reader->size == 0)
        return 0;
    reader->size--;
    return *reader->data++;
}

/// A number from 0 to `count` - 1, of at most two bytes.
static inline size_t take_below(byte_reader *reader, size_t count)
{
    size_t value = take_byte(reader);
    if (count > 256)
        value = 256 * value + take_byte(reader);
    return value % count;
}

static inline bool take_flag(byte_reader *reader)
{
    return (take_byte(reader) & 1) != 0;
}

/// Any double: the bits of eight bytes.
static inline double take_bits(byte_reader *reader)
{
    uint64_t bits = 0;
    double value;
    for (int i = 0; i < 8; i++)
        bits = 256 * bits + take_byte(reader);
    memcpy(&value, &bits, sizeof value);
    return value;
}

/// A coordinate: most are quarters from -32 to 31.75, so that points repeat, lie on lines and meet.
static inline double take_coordinate(byte_reader *reader)
{
    static const double SPECIAL[] = {0, 1e-300, -1e-12, 1e-8, 1e8, -1e15, 1e154, -1e300, NAN, INFINITY};
    static const size_t SPECIAL_COUNT = sizeof SPECIAL / sizeof *SPECIAL;
    unsigned kind = take_byte(reader);
    if (kind < 240)
        return ((double)take_byte(reader) - 128) / 4 + (kind >= 200 ? 1e-9 * (double)take_byte(reader) : 0);
    return kind < 254 ? SPECIAL[(kind - 240) % SPECIAL_COUNT] : take_bits(reader);
}

/// A number for an option: of the range, a usual one, or any.
static inline double take_option(byte_reader *reader, double low, double high)
{
    unsigned kind = take_byte(reader);
    if (kind < 64)
        return 0;
    if (kind < 230)
        return low + (high - low) * (double)take_byte(reader) / 255;
    return kind < 245 ? take_coordinate(reader) : take_bits(reader);
}

/// An enumerator, seldom one that does not exist.
static inline int take_choice(byte_reader *reader, int count)
{
    unsigned kind = take_byte(reader);
    return kind < 250 ? (int)(kind % (unsigned)count) : (int)kind - 252;
}

/// Coordinates in an array of its own, so that AddressSanitizer sees what is read behind it.
static inline double *take_coordinates(byte_reader *reader, size_t count)
{
    double *values = malloc(count > 0 ? count * sizeof *values : 1);
    PROMISE(values != NULL);
    for (size_t i = 0; i < count; i++)
        values[i] = take_coordinate(reader);
    return values;
}

/// A space of the library.
static inline bat_space take_space(byte_reader *reader)
{
    static const char *const NAMES[] = {"plane",    "plane", "sphere", "disk",      "euclidean",
                                        "rotation", "rigid", "spd",    "hyperbolic"};
    bat_space space;
    PROMISE(bat_space_by_name(NAMES[take_below(reader, sizeof NAMES / sizeof *NAMES)], 0, &space, NULL) == BAT_OK);
    return space;
}

/// Points, most of them in the space: the nearest ones to coordinates, where there are such.
static inline double *take_points(byte_reader *reader, const bat_space *space, size_t count)
{
    double *points = take_coordinates(reader, count * space->point_dim);
    bool disk = strcmp(space->name, "disk") == 0, positive = strcmp(space->name, "spd") == 0;
    bool exact = take_byte(reader) >= 250;
    for (size_t i = 0; i < count && !exact; i++)
    {
        double *point = points + i * space->point_dim;
        for (size_t k = 0; k < space->point_dim && disk; k++)
            point[k] /= 46;
        for (size_t k = 0; k < 3 && positive; k++)
            point[k] = k == 0 || k == 2 ? 4 + fabs(point[k]) : point[k] / 16;
        (void)space->project(space, point, point);
    }
    return points;
}

/// A curve of up to `max` points, with corners and channels. Release it with bat_curve_free().
static inline bat_curve take_curve(byte_reader *reader, const bat_space *space, size_t max)
{
    bat_curve curve = {.space = space, .count = take_below(reader, max + 1)};
    unsigned flags = take_byte(reader);
    curve.closed = (flags & 1) != 0;
    curve.points = take_points(reader, space, curve.count);
    if ((flags & 6) == 6)
    {
        curve.channel_count = 1 + (flags >> 7);
        curve.channels = take_coordinates(reader, curve.count * curve.channel_count);
    }
    if ((flags & 24) == 24)
    {
        curve.corners = calloc(curve.count + 1, 1);
        PROMISE(curve.corners != NULL);
        for (size_t i = 0; i < curve.count; i++)
            curve.corners[i] = take_byte(reader) > 200;
    }
    return curve;
}

/// What a call gives is finite, and in its space.
static inline void promise_points(const bat_space *space, const double *points, size_t count)
{
    for (size_t i = 0; i < count; i++)
        PROMISE(space->fault(space, points + i * space->point_dim) == NULL);
}

static inline void promise_finite(const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        PROMISE(isfinite(values[i]));
}

/// Options of refinement.
static inline bat_curve_refine_options take_refine_options(byte_reader *reader, bat_curve_refine_report *report)
{
    static const char *const NAMES[] = {"learned",
                                        "learned:fairness=1",
                                        "chaikin",
                                        "corner-cutting:r=0.2,s=0.7",
                                        "four-point",
                                        "six-point",
                                        "lane-riesenfeld:order=4",
                                        "angle-4",
                                        "angle-6:adaptive=1",
                                        "angle:mu=-0.1,turns=1",
                                        "log-exp-4",
                                        "log-exp-6:base=midpoint",
                                        "geodesic:order=2",
                                        "catmull-rom",
                                        "cubic",
                                        "quintic",
                                        "log-exp-lane-riesenfeld",
                                        "mask:1,2,1",
                                        "angle-4:sign=printed",
                                        "cubic:parameters=uniform",
                                        "four-point:parameters=chordal,w=0.1"};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    size_t name = take_below(reader, 1 + sizeof NAMES / sizeof *NAMES);
    if (name > 0)
        PROMISE(bat_curve_scheme_by_name(NAMES[name - 1], &options.scheme, NULL) == BAT_OK);
    options.levels = take_below(reader, 7);
    options.max_points = 4000;
    options.threads = 1;
    options.report = report;
    unsigned flags = take_byte(reader);
    options.snap = (flags & 3) == 3;
    options.find_corners = (flags & 12) == 12;
    options.first_level = (flags & 48) == 48 ? take_below(reader, 5) : 0;
    if ((flags & 64) == 0)
        return options;
    options.ends = (bat_curve_end_rule)take_choice(reader, 4);
    options.simple = (bat_curve_simple)take_choice(reader, 4);
    options.corner_angle = take_option(reader, 0, 3.2);
    options.max_edge = take_option(reader, 0, 4);
    options.tolerance = take_option(reader, 0, 1);
    options.relative_tolerance = take_option(reader, 0, 0.2);
    options.max_levels = take_below(reader, 42);
    options.smooth = (flags & 128) == 0 ? 0 : take_byte(reader) > 128 ? NAN : take_option(reader, 0, 40);
    return options;
}

/// A mesh of up to `max_vertices` vertices and `max_faces` faces, of triangles or, with `polygons`, of faces of 3 to 6
/// corners. It may be broken. Release it with bat_mesh_free().
static inline bat_mesh take_mesh(byte_reader *reader, size_t max_vertices, size_t max_faces, bool polygons)
{
    bat_mesh mesh = {.vertex_count = 1 + take_below(reader, max_vertices), .face_count = take_below(reader, max_faces + 1)};
    unsigned flags = take_byte(reader);
    bool many = polygons && (flags & 1) != 0, far = (flags & 254) == 254;
    size_t corners = 0;
    mesh.positions = take_coordinates(reader, 3 * mesh.vertex_count);
    mesh.faces = malloc((6 * mesh.face_count + 1) * sizeof *mesh.faces);
    mesh.offsets = many ? calloc(mesh.face_count + 1, sizeof *mesh.offsets) : NULL;
    PROMISE(mesh.faces != NULL && (!many || mesh.offsets != NULL));
    for (size_t f = 0; f < mesh.face_count; f++)
    {
        size_t sides = many ? 3 + take_below(reader, 4) : 3, first = take_below(reader, mesh.vertex_count);
        for (size_t c = 0; c < sides; c++)
        {
            // Most corners are near each other, so that faces meet.
            size_t step = c == 0 ? 0 : take_byte(reader);
            mesh.faces[corners++] = (uint32_t)(far && step == 255 ? 255 : (first + step) % mesh.vertex_count);
        }
        if (many)
            mesh.offsets[f + 1] = (uint32_t)corners;
    }
    if ((flags & 6) == 6)
    {
        mesh.channel_count = 1;
        mesh.channels = take_coordinates(reader, mesh.vertex_count);
        mesh.channel_names = calloc(1, sizeof *mesh.channel_names);
        PROMISE(mesh.channel_names != NULL && (mesh.channel_names[0] = strdup("value")) != NULL);
    }
    if ((flags & 24) == 24)
    {
        mesh.texture_count = 1 + take_below(reader, 12);
        mesh.texture = take_coordinates(reader, 2 * mesh.texture_count);
        mesh.texture_faces = malloc((corners + 1) * sizeof *mesh.texture_faces);
        PROMISE(mesh.texture_faces != NULL);
        for (size_t c = 0; c < corners; c++)
            mesh.texture_faces[c] = (uint32_t)take_below(reader, mesh.texture_count);
    }
    if ((flags & 96) == 96)
    {
        mesh.crease_count = take_below(reader, 6);
        mesh.corner_count = take_below(reader, 3);
        mesh.creases = calloc(mesh.crease_count + 1, sizeof *mesh.creases);
        mesh.corners = calloc(mesh.corner_count + 1, sizeof *mesh.corners);
        PROMISE(mesh.creases != NULL && mesh.corners != NULL);
        for (size_t i = 0; i < mesh.crease_count; i++)
            mesh.creases[i] = (bat_mesh_crease){(uint32_t)take_below(reader, mesh.vertex_count),
                                                (uint32_t)take_below(reader, mesh.vertex_count), take_option(reader, 0, 12)};
        for (size_t i = 0; i < mesh.corner_count; i++)
            mesh.corners[i] = (bat_mesh_corner){(uint32_t)take_below(reader, mesh.vertex_count), take_option(reader, 0, 12)};
    }
    return mesh;
}

/// Repair a mesh in place, so that it can be connected. False where nothing is left.
static inline bool repair(bat_mesh *mesh)
{
    bat_mesh repaired;
    if (bat_mesh_repair(mesh, NULL, &repaired, NULL) != BAT_OK)
        return false;
    bat_mesh_free(mesh);
    *mesh = repaired;
    return true;
}

#endif
