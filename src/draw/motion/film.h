#pragma once

#include "base/memory.h"
#include "batten/curve_picture.h"
#include "draw/common/legend.h"

/// @file
/// What a picture of motions shows: samples of their splines, and the ways to draw them.

/// The way the motions themselves are drawn.
typedef enum film_kind
{
    FILM_PATH,       ///< R^2, R^3 and rigid motions
    FILM_STRIP,      ///< rotations
    FILM_SHAPE,      ///< the sphere, the hyperbolic plane, tensors: as curves
    FILM_COORDINATES ///< other spaces
} film_kind;

typedef struct film_track
{
    bat_motion_spline *spline;
    bool owned; ///< whether the film frees the spline
    size_t key_count;
    const double *given; ///< the points of the keyframes, key_count x point_dim
    double *key_times;
    const double *deviations; ///< the spline's
    size_t count;             ///< of samples
    double *times, *points, *velocities;
    double *speeds, *turns;         ///< lengths of velocities; angular speeds in degrees; null where there are none
    double *key_speeds, *key_turns; ///< the same at the keyframes
    draw_colour colour;
    memory_pool pool; ///< of the arrays that are not others'
} film_track;

typedef struct film
{
    const bat_space *space;
    const bat_curve_set *keyframes;
    film_kind kind;
    bool body;                           ///< rigid motions
    double length_factor;                ///< from the space's unit of length to that of the picture
    const char *length_unit, *time_unit; ///< "" for none
    film_track tracks[BAT_MOTION_PICTURE_MOTIONS];
    size_t count;
    double begin, end; ///< times
    double origin;     ///< the time that is subtracted
    int64_t since;     ///< the origin of the keyframes' own times
    const char *date;  ///< the first time where times are dates; else null
    size_t poses;      ///< of the options
    double outlying;   ///< deviations above it are marked; 0: none are
    bool any_outlier;
} film;

/// Sample the splines of keyframes, and make them where `splines` is null. Release the film with film_free().
bat_status film_make(const bat_curve_set *keyframes, bat_motion_spline *const *splines,
                     const bat_motion_curves_options *motion, const bat_motion_picture_options *options, film *made,
                     bat_error *error);
void film_free(film *made);

/// Evaluate a motion within its range, at a time relative to the film's origin.
bat_status film_at(const film *shown, const film_track *track, double time, double *point, bat_error *error);

/// The ranges of a path on the page, in units of length.
typedef struct path_view
{
    double rows[3][3];                ///< directions to the right, upwards and to the eye
    bool flat;                        ///< in the plane
    int up;                           ///< the axis across the floor
    int floor[2];                     ///< the other two, in a right-handed order
    double centre[3];                 ///< subtracted before the rotation
    double low[3], high[3];           ///< the box of the coordinates, less the centre
    double page_low[2], page_high[2]; ///< the box on the page: its left and lower, its right and upper ends
} path_view;

void path_view_make(const film *shown, path_view *view);
/// Height over width.
double path_aspect(const path_view *view);
/// Draw the paths with their axes, keyframes and frames in the box (x, y, width, height).
bat_status path_draw(const film *shown, const path_view *view, cairo_t *cairo, const double box[4], bat_error *error);

double strip_height(const film *shown, double width);
bat_status strip_draw(const film *shown, cairo_t *cairo, const double box[4], bat_error *error);

/// The colours of the axes x, y and z of a body.
draw_colour film_axis_colour(size_t axis);
