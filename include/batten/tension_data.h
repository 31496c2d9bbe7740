#ifndef BATTEN_TENSION_DATA_H
#define BATTEN_TENSION_DATA_H

#include "batten/curve.h"

BAT_C_BEGIN

/// @file
/// The curves that Ugail and Howard (2026) train and judge their learned subdivision rule on, regenerated from their random
/// streams: 1,200 closed curves with control polygons (section 6.1), and the ground track of section 8.

/// Curves of the data set in each space.
#define BAT_TENSION_CURVES 400
/// Points of a curve ("truth").
#define BAT_TENSION_TRUTH_POINTS 1000
/// Points of a control polygon.
#define BAT_TENSION_CONTROL_POINTS 12

/// The spaces of the data set.
typedef enum bat_tension_space
{
    BAT_TENSION_PLANE,
    BAT_TENSION_SPHERE,
    BAT_TENSION_DISK,
    BAT_TENSION_SPACE_COUNT
} bat_tension_space;

/// The curves of one space in one part of the split, in shuffled order.
///
/// `number` i tells a curve's family (section 6.1):
///
///     plane   i mod 4: ellipse; Fourier curve with 3 terms; Fourier curve with 4 terms; superellipse
///     sphere  i mod 3: Lissajous; polar Fourier with 2 or 3 terms; perturbed great circle
///     disk    i mod 3: Fourier curve with 2 to 4 terms; circle about the origin; offset ellipse
///
/// All are closed. Coordinates are those of the published arrays, which are single precision; points of the sphere are
/// brought back to unit length in double precision. Control polygons are 12 of the curve's points, evenly spaced by chord
/// length. Some Lissajous curves run twice round and so pass through every point twice.
typedef struct bat_tension_set
{
    size_t count;
    size_t dim;      ///< coordinates of a point: 2, 3 on the sphere
    size_t *index;   ///< count positions in the shuffled part, ascending; the three spaces share one numbering
    size_t *number;  ///< count numbers, 0 … BAT_TENSION_CURVES - 1, of the curve among those of its space
    double *truth;   ///< count x BAT_TENSION_TRUTH_POINTS x dim
    double *control; ///< count x BAT_TENSION_CONTROL_POINTS x dim
} bat_tension_set;

/// The data set, split as published: 960 curves to train on and 240 to validate with. 24 of the spherical validation
/// curves are copies of training curves.
typedef struct bat_tension_data
{
    bat_tension_set train[BAT_TENSION_SPACE_COUNT];
    bat_tension_set validation[BAT_TENSION_SPACE_COUNT];
} bat_tension_data;

/// Generate the data set. Takes about 23 MB and some tenths of a second.
/// @param data receives the sets; release them with bat_tension_data_free()
/// @return BAT_OK or BAT_NO_MEMORY; `data` is untouched on failure
BAT_API bat_status bat_tension_data_make(bat_tension_data *data, bat_error *error);
/// Free what bat_tension_data_make() allocated and make the data set empty.
BAT_API void bat_tension_data_free(bat_tension_data *data);

/// One truth of a set as a closed curve. The points still belong to the set: do not free the curve.
/// @param space the set's space, whose point_dim is set->dim
BAT_API bat_curve bat_tension_truth(const bat_tension_set *set, size_t i, const bat_space *space);
/// One control polygon of a set as a closed curve. The points still belong to the set: do not free the curve.
BAT_API bat_curve bat_tension_control(const bat_tension_set *set, size_t i, const bat_space *space);

/// Points of the ground track, 480 of them of one orbit and 40 of the closing arc.
#define BAT_ISS_TRACK_POINTS 520
/// Points of its control polygon.
#define BAT_ISS_CONTROL_POINTS 16

/// The ground track of the International Space Station over one orbit, closed by a great-circle arc (section 8, eq. 24 and
/// 25), and its control polygon, whose points are evenly spaced by chord length along the track without the segment from
/// its last point to its first. As published, the arc begins with a copy of the orbit's last point, so that points 479
/// and 480 coincide.
///
/// @param sphere  S^2, as bat_sphere(2) gives it; must outlive the curves
/// @param truth   receives BAT_ISS_TRACK_POINTS points; release it with bat_curve_free()
/// @param control receives BAT_ISS_CONTROL_POINTS points; release it with bat_curve_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT (not S^2) or BAT_NO_MEMORY; nothing is written on failure
BAT_API bat_status bat_tension_iss_track(const bat_space *sphere, bat_curve *truth, bat_curve *control, bat_error *error);

BAT_C_END

#endif
