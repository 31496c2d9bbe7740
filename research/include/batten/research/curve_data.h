#ifndef BATTEN_RESEARCH_CURVE_DATA_H
#define BATTEN_RESEARCH_CURVE_DATA_H

#include "batten/curve.h"

BAT_C_BEGIN

/// @file
/// The curves on which Ugail and Howard (2026) train and evaluate their learned subdivision rule, regenerated from their
/// random streams. There are 1,200 closed curves with control polygons (section 6.1), and the ground track of section 8.
/// Further sets of curves for evaluation, which share no curve with any training.

/// Number of curves of the data set in each space.
#define BAT_TENSION_CURVES 400
/// Number of points of a curve ("truth").
#define BAT_TENSION_TRUTH_POINTS 1000
/// Number of points of a control polygon.
#define BAT_TENSION_CONTROL_POINTS 12

/// The spaces of the data set.
typedef enum bat_tension_space
{
    BAT_TENSION_SPACE_PLANE,
    BAT_TENSION_SPACE_SPHERE,
    BAT_TENSION_SPACE_DISK,
    BAT_TENSION_SPACE_COUNT
} bat_tension_space;

/// Curves of one space with their control polygons: one part of the published split in shuffled order, or a set drawn by
/// bat_tension_set_make().
///
/// The family of a curve follows from its `number` i. Published (section 6.1):
///
///     plane   i mod 4: ellipse; Fourier curve with 3 terms; Fourier curve with 4 terms; superellipse
///     sphere  i mod 3: Lissajous; polar Fourier with 2 or 3 terms; perturbed great circle
///     disk    i mod 3: Fourier curve with 2 to 4 terms; circle about the origin; offset ellipse
///
/// All are closed. Coordinates are those of the published arrays, in single precision; points on the sphere are normalized
/// in double precision. Control polygons are 12 of the curve's points, evenly spaced by chord length. Some Lissajous curves
/// pass through every point twice.
typedef struct bat_tension_set
{
    size_t count;
    size_t dim;    ///< coordinates of a point: 2, 3 on the sphere
    size_t *index; ///< count positions in the shuffled part, ascending; the three spaces share one numbering. Drawn sets: 0,
                   ///< 1, …
    size_t *number;  ///< count numbers of the curve among those of its space; published: below BAT_TENSION_CURVES
    double *truth;   ///< count x BAT_TENSION_TRUTH_POINTS x dim
    double *control; ///< count x BAT_TENSION_CONTROL_POINTS x dim
} bat_tension_set;

/// The data set, split as published: 960 training curves and 240 validation curves. 24 of the spherical validation curves
/// are copies of training curves.
typedef struct bat_tension_data
{
    bat_tension_set train[BAT_TENSION_SPACE_COUNT];
    bat_tension_set validation[BAT_TENSION_SPACE_COUNT];
} bat_tension_data;

/// Generate the data set. It takes about 23 MB, and some tenths of a second.
/// @param data receives the sets; release them with bat_tension_data_free()
/// @return BAT_OK or BAT_NO_MEMORY; `data` is untouched on failure
BAT_API bat_status bat_tension_data_make(bat_tension_data *data, bat_error *error);
/// Release the data set and make it empty.
BAT_API void bat_tension_data_free(bat_tension_data *data);

/// Sets of curves for the evaluation of a method.
typedef enum bat_tension_set_kind
{
    BAT_TENSION_SET_KIND_PUBLISHED, ///< the published validation curves
    BAT_TENSION_SET_KIND_RESAMPLED, ///< from the training families, by other random streams
    BAT_TENSION_SET_KIND_UNSEEN     ///< from families without a member in common with the training families
} bat_tension_set_kind;

/// Number of curves of a test set in each space, for the tables.
#define BAT_TENSION_TEST_CURVES 300
/// The seed of the tables' test sets.
#define BAT_TENSION_TEST_SEED 2026

/// Draw a set of closed curves with control polygons. Families alternate; all their parameters are random and, but for
/// frequencies and numbers of terms, continuous (docs/algorithms/tension-network.md describes them). The family of `number`
/// i is
///     resampled
/// ///             plane   i mod 5: ellipse; Fourier curve with 2 or 3 terms; with 4 or 5; superellipse; star-shaped blob
///             sphere  i mod 4: Lissajous; polar Fourier; perturbed great circle; circle or spherical ellipse
///             disk    i mod 4: Fourier curve; circle; offset ellipse; star-shaped blob
///     unseen  plane   i mod 3: Cassini oval; inverted trochoid; polygon with circular fillets
///             sphere  i mod 3: ground track of one orbit; spherical trochoid; geodesic polygon with circular fillets
///             disk    i mod 2: trochoid; geodesic polygon with circular fillets
///
/// Coordinates have double precision. A control polygon is BAT_TENSION_CONTROL_POINTS of the curve's points, evenly spaced
/// by chord length from a random start. Curves are drawn again if a step between neighbouring points is longer than 20 times
/// the mean. So are those with an edge of the control polygon below 1/50 of the mean edge, or with neighbouring control
/// points on the sphere more than 171 degrees apart.
///
/// The same arguments give the same curves, up to rounding in the C library; a smaller count gives the first of them. No
/// training of the library draws from the same random streams, whatever its seed.
///
/// @param kind  BAT_TENSION_SET_KIND_RESAMPLED or BAT_TENSION_SET_KIND_UNSEEN; bat_tension_data_make() gives the published
/// curves
/// @param count curves, at least 1; 300 take 5 to 7 MB
/// @param seed  BAT_TENSION_TEST_SEED for the tables' sets
/// @param set   receives the set; release it with bat_tension_set_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; `set` is untouched on failure
BAT_API bat_status bat_tension_set_make(bat_tension_space space, bat_tension_set_kind kind, size_t count, uint64_t seed,
                                        bat_tension_set *set, bat_error *error);
/// Release the set and make it empty.
BAT_API void bat_tension_set_free(bat_tension_set *set);

/// A true curve of a set. The set keeps the points: do not free the curve.
/// @param space the set's space, whose point_dim is set->dim
BAT_API bat_curve bat_tension_truth(const bat_tension_set *set, size_t i, const bat_space *space);
/// A control polygon of a set. The set keeps the points: do not free the curve.
BAT_API bat_curve bat_tension_control(const bat_tension_set *set, size_t i, const bat_space *space);

/// Number of points of the ground track: 480 of one orbit and 40 of the closing arc.
#define BAT_ISS_TRACK_POINTS 520
/// Number of points of its control polygon.
#define BAT_ISS_CONTROL_POINTS 16

/// The ground track of the International Space Station over one orbit, closed by a great-circle arc (section 8, eq. 24 and
/// 25), and its control polygon. Control points are evenly spaced by chord length along the track, without the segment from
/// its last point to its first. As published, the arc begins with a copy of the orbit's last point, so that points 479 and
/// 480 coincide.
///
/// @param sphere  S^2, as bat_sphere(2) gives it; must outlive the curves
/// @param truth   receives BAT_ISS_TRACK_POINTS points; release it with bat_curve_free()
/// @param control receives BAT_ISS_CONTROL_POINTS points; release it with bat_curve_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT (not S^2) or BAT_NO_MEMORY; nothing is written on failure
BAT_API bat_status bat_tension_iss_track(const bat_space *sphere, bat_curve *truth, bat_curve *control, bat_error *error);

BAT_C_END

#endif
