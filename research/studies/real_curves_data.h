#ifndef STUDIES_REAL_CURVES_DATA_H
#define STUDIES_REAL_CURVES_DATA_H

#include "batten/curve_set.h"
#include "batten/research/curve_study.h"

/// A file of control points.
typedef struct real_sampling
{
    char name[BAT_REAL_CURVES_NAME];
    bat_curve_set control;
} real_sampling;

/// True curves, and files of control points for them, by name.
typedef struct real_family
{
    char name[BAT_REAL_CURVES_NAME];
    bat_curve_set truth;
    real_sampling *samplings;
    size_t count;
} real_family;

/// The families of a folder, by name.
typedef struct real_folder
{
    real_family *families;
    size_t count;
} real_folder;

/// Read FAMILY-truth.csv and FAMILY-SAMPLING.csv, curves of the plane.
/// @param folder receives the families, at least one; release it with real_folder_free()
/// @return as bat_real_curves()
bat_status real_folder_read(const char *path, real_folder *folder, bat_error *error);
void real_folder_free(real_folder *folder);

/// Lay points of the plane on the sphere: the azimuthal equidistant map around the pole takes the circle around the bounding
/// box of `frame` to a cap of radius BAT_REAL_CURVES_CAP.
/// @param points receives curve->count rows of 3 numbers
void real_curve_on_sphere(const bat_curve *curve, const bat_curve *frame, double *points);

#endif
