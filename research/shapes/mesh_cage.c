/// @file
/// A coarse control mesh of an elephant, by repeated extrusion of the faces of a box: the left half is modelled and mirrored
/// at the plane y = 0. x points ahead, y to the left, z upwards.

#include "research/shapes/mesh_shape.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    FIRST_FACES = 5,
    DRAWN_FACES = 4,
    DRAW_COUNT = 22,
    FACE_COUNT = FIRST_FACES + DRAWN_FACES * DRAW_COUNT,
    POINT_COUNT = 8 + 4 * DRAW_COUNT
};

/// The faces of the box.
enum
{
    FRONT,
    BACK,
    SIDE,
    BELOW,
    ABOVE
};

/// The index of the side face at an edge of extrusion number `draw`. Edges of a face that looks ahead: below, left, above,
/// at the mirror plane; of one that looks back: below, at the mirror plane, above, left.
#define BESIDE(draw, edge) (FIRST_FACES + DRAWN_FACES * (draw) + (edge))

/// An extrusion: translate a face, scale it about its centre, and rotate it about y, the front upwards.
typedef struct drawing_out
{
    int face;
    double move[3], scale[3], tilt;
    bool from_seam; ///< the part is away from the mirror plane, so that it occurs twice
} drawing_out;

static const drawing_out DRAWINGS[DRAW_COUNT] = {
    {FRONT, {0.42, 0, 0}, {1, 0.88, 0.9}, 0, false},              //  0 chest
    {BACK, {-0.42, 0, -0.02}, {1, 0.86, 0.86}, 0, false},         //  1 hips
    {FRONT, {0.15, 0, 0.26}, {1, 0.72, 0.66}, 0.2, false},        //  2 neck
    {FRONT, {0.33, 0, 0.08}, {1, 1.12, 1.3}, -0.25, false},       //  3 head
    {FRONT, {0.2, 0, -0.08}, {1, 0.48, 0.52}, -0.45, false},      //  4 trunk …
    {FRONT, {0.12, 0, -0.2}, {0.85, 0.85, 0.85}, -0.4, false},    //  5
    {FRONT, {0.03, 0, -0.27}, {0.85, 0.85, 0.85}, -0.35, false},  //  6
    {FRONT, {0.03, 0, -0.25}, {0.85, 0.85, 0.85}, 0.25, false},   //  7
    {FRONT, {0.13, 0, -0.15}, {0.9, 0.9, 0.9}, 0.7, false},       //  8 … to its tip
    {BESIDE(0, 0), {0, 0.035, -0.26}, {0.72, 0.7, 1}, 0, true},   //  9 front leg
    {BESIDE(0, 0), {0.02, 0, -0.3}, {0.92, 0.92, 1}, 0, true},    // 10
    {BESIDE(0, 0), {0.03, 0, -0.14}, {1.18, 1.18, 1}, 0, true},   // 11 foot
    {BESIDE(1, 0), {0, 0.03, -0.26}, {0.72, 0.7, 1}, 0, true},    // 12 hind leg
    {BESIDE(1, 0), {-0.03, 0, -0.28}, {0.92, 0.92, 1}, 0, true},  // 13
    {BESIDE(1, 0), {0.03, 0, -0.14}, {1.18, 1.18, 1}, 0, true},   // 14 foot
    {BACK, {-0.13, 0, 0.1}, {1, 0.5, 0.45}, 0.3, false},          // 15 rump
    {BACK, {-0.1, 0, -0.04}, {1, 0.3, 0.35}, 0.7, false},         // 16 tail
    {BACK, {-0.08, 0, -0.3}, {0.8, 0.8, 0.8}, 0.4, false},        // 17
    {BACK, {-0.02, 0, -0.14}, {1.7, 1.7, 1.7}, 0, false},         // 18 its tuft
    {BESIDE(3, 1), {-0.1, 0.09, 0.02}, {0.3, 1, 0.8}, 0, true},   // 19 ear
    {BESIDE(3, 1), {-0.13, 0.2, 0}, {1, 1, 1.75}, 0, true},       // 20
    {BESIDE(3, 1), {-0.1, 0.17, -0.05}, {0.8, 1, 0.72}, 0, true}, // 21
};

typedef struct half_cage
{
    double points[POINT_COUNT][3];
    int faces[FACE_COUNT][4]; ///< the first corner is -1 for unused faces
    int point_count;
} half_cage;

static void begin_box(half_cage *half)
{
    static const double LOW[3] = {-0.34, 0, 0.53}, HIGH[3] = {0.3, 0.41, 1.22};
    static const int FACES[FIRST_FACES][4] = {[FRONT] = {1, 3, 7, 5},
                                              [BACK] = {2, 0, 4, 6},
                                              [SIDE] = {3, 2, 6, 7},
                                              [BELOW] = {0, 2, 3, 1},
                                              [ABOVE] = {4, 5, 7, 6}};
    for (int i = 0; i < 8; i++)
    {
        half->points[i][0] = i & 1 ? HIGH[0] : LOW[0];
        half->points[i][1] = i & 2 ? HIGH[1] : LOW[1];
        half->points[i][2] = i & 4 ? HIGH[2] : LOW[2];
    }
    memcpy(half->faces, FACES, sizeof FACES);
    half->point_count = 8;
}

static bool on_seam(const half_cage *half, const int face[4])
{
    for (int i = 0; i < 4; i++)
        if (half->points[face[i]][1] != 0)
            return false;
    return true;
}

static void draw_out(half_cage *half, int number, double vigour)
{
    const drawing_out *drawing = &DRAWINGS[number];
    int *face = half->faces[drawing->face], made[4];
    double middle[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++)
            middle[c] += half->points[face[i]][c] / 4;
    middle[1] = drawing->from_seam ? middle[1] : 0;
    double cosine = cos(drawing->tilt), sine = sin(drawing->tilt);
    for (int i = 0; i < 4; i++)
    {
        double away[3];
        for (int c = 0; c < 3; c++)
            away[c] = drawing->scale[c] * (half->points[face[i]][c] - middle[c]);
        double *point = half->points[half->point_count];
        point[0] = middle[0] + vigour * drawing->move[0] + cosine * away[0] - sine * away[2];
        point[1] = middle[1] + vigour * drawing->move[1] + away[1];
        point[2] = middle[2] + vigour * drawing->move[2] + sine * away[0] + cosine * away[2];
        made[i] = half->point_count++;
    }
    for (int i = 0; i < 4; i++)
    {
        int next = (i + 1) % 4, beside[4] = {face[i], face[next], made[next], made[i]};
        memcpy(half->faces[BESIDE(number, i)], beside, sizeof beside);
        if (on_seam(half, beside))
            half->faces[BESIDE(number, i)][0] = -1;
    }
    memcpy(face, made, sizeof made);
}

/// The two triangles of a face, split along its shorter diagonal, and their mirror images.
static void add_faces(const half_cage *half, const int face[4], const uint32_t left[], const uint32_t right[],
                      uint32_t *faces)
{
    double first = 0, second = 0;
    for (int c = 0; c < 3; c++)
    {
        first += pow(half->points[face[0]][c] - half->points[face[2]][c], 2);
        second += pow(half->points[face[1]][c] - half->points[face[3]][c], 2);
    }
    int turn = first <= second ? 0 : 1;
    int a = face[turn], b = face[turn + 1], c = face[turn + 2], d = face[(turn + 3) % 4];
    uint32_t four[12] = {left[a],  left[b],  left[c],  left[a],  left[c],  left[d],
                         right[a], right[c], right[b], right[a], right[d], right[c]};
    memcpy(faces, four, sizeof four);
}

static bat_status mirror(const half_cage *half, bat_mesh *mesh, bat_error *error)
{
    bat_mesh made = {.positions = memory_array(2 * POINT_COUNT, 3 * sizeof(double)),
                     .faces = memory_array(4 * FACE_COUNT, 3 * sizeof(uint32_t))};
    if (made.positions == NULL || made.faces == NULL)
    {
        bat_mesh_free(&made);
        return error_memory(error, 4 * FACE_COUNT * 3 * sizeof(uint32_t));
    }
    uint32_t left[POINT_COUNT], right[POINT_COUNT];
    for (int i = 0; i < half->point_count; i++)
    {
        const double *point = half->points[i];
        bool alone = point[1] == 0;
        memcpy(made.positions + 3 * made.vertex_count, point, 3 * sizeof(double));
        left[i] = right[i] = (uint32_t)made.vertex_count++;
        if (alone)
            continue;
        double image[3] = {point[0], -point[1], point[2]};
        memcpy(made.positions + 3 * made.vertex_count, image, sizeof image);
        right[i] = (uint32_t)made.vertex_count++;
    }
    for (int f = 0; f < FACE_COUNT; f++)
    {
        if (half->faces[f][0] < 0)
            continue;
        add_faces(half, half->faces[f], left, right, made.faces + 3 * made.face_count);
        made.face_count += 4;
    }
    *mesh = made;
    return BAT_OK;
}

bat_status generate_cage(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error)
{
    (void)vertices;
    half_cage *half = calloc(1, sizeof *half);
    if (half == NULL)
        return error_memory(error, sizeof *half);
    begin_box(half);
    for (int i = 0; i < DRAW_COUNT; i++)
        draw_out(half, i, draw_between(random, 0.94, 1.06));
    bat_status status = mirror(half, mesh, error);
    free(half);
    return status;
}
