#include "draw/mesh/shade.h"
#include "linalg/vector.h"

/// @file
/// Automatic views from second moments of the surface.

/// The automatic view is rotated by BESIDE from the broadest side, and elevated above the horizon, more for flat meshes.
#define BESIDE (35 * ANGLE_DEGREE)
#define ABOVE (18 * ANGLE_DEGREE)
#define FAR_ABOVE (42 * ANGLE_DEGREE)
/// Meshes are flat when their upward extent, relative to the horizontal one, is smaller.
#define FLAT_SHARE 0.25

/// The second moments of the surface about its centroid, with faces as points at their centroids, in the order of `axes`.
static void moments_of(const bat_mesh *mesh, const int axes[3], double moments[3][3])
{
    double sum[3] = {0}, products[3][3] = {{0}}, total = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        double normal[3], middle[3] = {0};
        vector3_face(mesh->positions, corner, normal);
        for (int i = 0; i < 9; i++)
            middle[i / 3] += mesh->positions[3 * (size_t)corner[i % 3] + (size_t)axes[i / 3]] / 3;
        double area = vector3_length(normal);
        total += area;
        for (int i = 0; i < 3; i++)
        {
            sum[i] += area * middle[i];
            for (int k = 0; k < 3; k++)
                products[i][k] += area * middle[i] * middle[k];
        }
    }
    total = total > 0 ? total : 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            moments[i][k] = products[i][k] / total - sum[i] * sum[k] / (total * total);
}

/// The viewer's longitude: 35 degrees beside the broad side of the mesh, on the side near longitude 35 degrees.
static double automatic_longitude(double moments[3][3])
{
    double spread = moments[0][0] + moments[1][1], lean = hypot(moments[0][0] - moments[1][1], 2 * moments[0][1]);
    if (lean < 0.1 * spread)
        return BESIDE;
    double longest = 0.5 * atan2(2 * moments[0][1], moments[0][0] - moments[1][1]), best = BESIDE, nearest = HUGE_VAL;
    for (int quarter = -1; quarter <= 1; quarter += 2)
        for (int side = -1; side <= 1; side += 2)
        {
            double longitude = longest + quarter * 90 * ANGLE_DEGREE + side * BESIDE;
            double away = fabs(remainder(longitude - BESIDE, 360 * ANGLE_DEGREE));
            if (away < nearest - 1e-9)
            {
                nearest = away;
                best = longitude;
            }
        }
    return best;
}

mesh_view mesh_view_of(const bat_mesh *mesh, const bat_mesh_picture_options *options)
{
    // The axes of space as (towards longitude 0, towards longitude pi/2, upwards), right-handed.
    static const int AXES[4][3] = {[BAT_MESH_UP_AUTO] = {2, 0, 1},
                                   [BAT_MESH_UP_X] = {1, 2, 0},
                                   [BAT_MESH_UP_Y] = {2, 0, 1},
                                   [BAT_MESH_UP_Z] = {0, 1, 2}};
    const int *axes = AXES[options->up];
    double longitude = options->longitude, latitude = options->latitude;
    if (isnan(longitude) || isnan(latitude))
    {
        double moments[3][3];
        moments_of(mesh, axes, moments);
        double across = fmax(moments[0][0], moments[1][1]);
        bool flat = moments[2][2] < FLAT_SHARE * FLAT_SHARE * across;
        longitude = isnan(longitude) ? automatic_longitude(moments) : longitude;
        latitude = isnan(latitude) ? (flat ? FAR_ABOVE : ABOVE) : latitude;
    }
    double c = cos(longitude), s = sin(longitude), cl = cos(latitude), sl = sin(latitude);
    const double rows[3][3] = {{-s, c, 0}, {-c * sl, -s * sl, cl}, {c * cl, s * cl, sl}};
    mesh_view view;
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 3; i++)
            view.rotation[row][axes[i]] = rows[row][i];
    return view;
}

mesh_frame mesh_frame_of(const double *points, const uint32_t *indices, size_t count, const mesh_view *view)
{
    mesh_frame frame;
    box_clear(2, frame.low, frame.high);
    for (size_t i = 0; i < count; i++)
    {
        double turned[3];
        mesh_view_turn(view, points + 3 * (indices != NULL ? indices[i] : i), turned);
        box_include(2, turned, frame.low, frame.high);
    }
    return frame;
}

mesh_frame mesh_frame_join(const mesh_frame *a, const mesh_frame *b)
{
    mesh_frame joined;
    for (int c = 0; c < 2; c++)
    {
        joined.low[c] = fmin(a->low[c], b->low[c]);
        joined.high[c] = fmax(a->high[c], b->high[c]);
    }
    return joined;
}

mesh_placing mesh_frame_place(const mesh_frame *frame, const mesh_view *view, size_t columns, size_t rows)
{
    double wide = (double)columns, high = (double)rows, across = frame->high[0] - frame->low[0];
    double up = frame->high[1] - frame->low[1];
    double scale =
        fmin((1 - 2 * FRAME_PADDING) * wide / fmax(across, 1e-300), (high - 2 * FRAME_PADDING * wide) / fmax(up, 1e-300));
    return (mesh_placing){.view = view,
                          .scale = scale,
                          .origin = {wide / 2 - scale * (frame->low[0] + frame->high[0]) / 2,
                                     high / 2 + scale * (frame->low[1] + frame->high[1]) / 2}};
}
