#include "base/choice.h"
#include "draw/surface/scene.h"
#include "linalg/vector.h"

#include <float.h>
#include <stdio.h>

/// @file
/// Surfaces as inspectors see them: signed distances in bands of tolerances, zebra stripes and mean curvature.

static const bat_choice VIEWS[] = {
    CHOICE("shaded", "in two lights", BAT_SURFACE_VIEW_SHADED),
    CHOICE("zebra", "reflected stripes, which break where the surface is not smooth", BAT_SURFACE_VIEW_ZEBRA),
    CHOICE("curvature", "mean curvature: the mean of the principal ones", BAT_SURFACE_VIEW_CURVATURE),
};
const bat_family bat_surface_view_family = FAMILY("view", VIEWS);

#define MINUS "\xe2\x88\x92"

size_t surface_band_of(const bat_surface_inspection *inspection, double distance)
{
    size_t out = 0;
    while (out < inspection->band_count && fabs(distance) > inspection->bands[out])
        out++;
    return distance > 0 ? inspection->band_count - out : inspection->band_count + out;
}

draw_colour surface_band_colour(const bat_surface_inspection *inspection, size_t band)
{
    static const draw_colour WITHIN = {0.49, 0.73, 0.42}, NEAR[2] = {{0.99, 0.60, 0.72}, {0.48, 0.76, 0.95}},
                             BEYOND[2] = {{0.62, 0.00, 0.18}, {0.12, 0.16, 0.55}};
    size_t middle = inspection->band_count;
    double out = fabs((double)band - (double)middle), share = middle > 1 ? (out - 1) / ((double)middle - 1) : 1;
    return out == 0 ? WITHIN : style_mix(BEYOND[band > middle], NEAR[band > middle], share);
}

void surface_band_label(const bat_surface_inspection *inspection, size_t band, double share, char *label, size_t size)
{
    size_t middle = inspection->band_count, out = band < middle ? middle - band : band - middle;
    const char *sign = out == 0 ? "\xc2\xb1" : band < middle ? "+" : MINUS;
    double from = inspection->bands[out > 0 ? out - 1 : 0];
    if (out == 0 || out == middle)
        (void)snprintf(label, size, "%s %s%g: %.2f %%", out == 0 ? "within" : "beyond", sign, from, 100 * share);
    else
        (void)snprintf(label, size, "%s%g to %s%g: %.2f %%", sign, from, sign, inspection->bands[out], 100 * share);
}

/// The point and the derivatives of a row's surface at a point's parameters, or without these of its shell at a place.
static bat_status derivatives_at(const surface_row *row, const double *parameters, size_t point, shell_place place,
                                 double at[18], bat_error *error)
{
    if (parameters != NULL)
        return bat_spline_surface_evaluate(row->panel->surface, parameters + 2 * point, 1, 2, at, error);
    shell_patch_derivatives(row->shell->patches + 48 * (size_t)place.face, place.u, place.v, 6, at);
    return BAT_OK;
}

bat_status surface_row_sign(surface_row *row, bat_error *error)
{
    const bat_surface_picture_row *panel = row->panel;
    double most[2] = {0}, at[18], normal[3], from[3];
    if (array_make(&row->signed_distances, panel->cloud->count, sizeof *row->signed_distances, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < panel->cloud->count; i++)
    {
        shell_place place = row->places != NULL ? row->places[i] : (shell_place){0};
        bat_status status = derivatives_at(row, panel->parameters, i, place, at, error);
        if (status != BAT_OK)
            return status;
        vector3_cross(at + 3, at + 6, normal);
        vector3_subtract(panel->cloud->points + 3 * i, at, from);
        bool front = (vector3_dot(from, normal) < 0) == row->turned;
        row->signed_distances[i] = front ? row->distances[i] : -row->distances[i];
        most[!front] = fmax(most[!front], row->distances[i]);
    }
    (void)snprintf(row->captions[SURFACE_PANEL_ERRORS], SURFACE_CAPTION_SIZE,
                   "largest +%.3g and " MINUS "%.3g; + is towards the viewer", most[0], most[1]);
    return BAT_OK;
}

/// Of a surface's derivatives: the angle of the reflected line of sight from a plane between diagonal stripes, in degrees,
/// or the mean curvature, positive where the front bulges (do Carmo, "Differential Geometry of Curves and Surfaces", 1976,
/// section 3.3). NaN where there is no normal.
static double value_of(const surface_row *row, bool zebra, const double at[18])
{
    const double *u = at + 3, *v = at + 6;
    double normal[3], turned[3], e = vector3_dot(u, u), f = vector3_dot(u, v), g = vector3_dot(v, v);
    vector3_cross(u, v, normal);
    if (!vector3_normalize(normal))
        return NAN;
    mesh_view_turn(&row->view, normal, turned);
    if (zebra)
        return asin(fmin(fmax(turned[2] * (turned[0] + sqrt(3) * turned[1]), -1), 1)) / ANGLE_DEGREE;
    double second =
        e * vector3_dot(at + 15, normal) - 2 * f * vector3_dot(at + 12, normal) + g * vector3_dot(at + 9, normal);
    return (row->turned ? 0.5 : -0.5) * second / (e * g - f * f);
}

bat_status surface_row_inspect(surface_row *row, bool zebra, const double *parameters, double *end, bat_error *error)
{
    // Stripes in the range of angles, their least and greatest width in degrees; means of curvatures in the scale.
    static const double STRIPES = 18, WIDTHS[2] = {0.25, 8}, MEANS = 3;
    const bat_mesh *patch = &row->patch;
    double low = INFINITY, high = -INFINITY, sum = 0, at[18];
    size_t count = row->shell != NULL ? 3 * patch->face_count : patch->vertex_count;
    if (array_make(&row->values, count, sizeof *row->values, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t v = 0; v < count; v++)
    {
        const double corner[3] = {v % 3 == 0, v % 3 == 1, v % 3 == 2};
        shell_place place = {0};
        if (row->shell != NULL)
            place = surface_shell_place(row, v / 3, corner);
        bat_status status = derivatives_at(row, parameters, v, place, at, error);
        if (status != BAT_OK)
            return status;
        row->values[v] = value_of(row, zebra, at);
    }
    for (size_t f = 0; f < patch->face_count; f++)
    {
        double value = row->values[row->shell != NULL ? 3 * f : patch->faces[3 * f]];
        box_include(1, &value, &low, &high);
        sum += isfinite(value) ? fabs(value) : 0;
    }
    double width = fmin(fmax((high - low) / STRIPES, WIDTHS[0]), WIDTHS[1]);
    for (size_t v = 0; v < count && zebra; v++)
        row->values[v] /= width;
    *end = zebra ? 0 : fmax(fmax(*end, MEANS * sum / (double)patch->face_count), DBL_MIN);
    (void)snprintf(row->captions[SURFACE_PANEL_PATCH], SURFACE_CAPTION_SIZE,
                   zebra ? "zebra stripes, each %.2g degrees of reflection wide" : "mean curvature from %.3g to %.3g",
                   zebra ? width : low, high);
    return BAT_OK;
}
