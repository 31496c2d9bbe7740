#ifndef SURFACE_CLOUD_EVEN_SAMPLE_H
#define SURFACE_CLOUD_EVEN_SAMPLE_H

#include "surface/cloud/neighbours.h"

/// @file
/// Even samples of clouds that are much denser in one direction than across it, such as scan lines. Neighbourhoods of such
/// clouds are lines; those of even samples are discs.

/// The least distance of points at which a cloud is as dense in all directions.
/// @param radius receives 0 for a cloud that already is, and infinity where none is found: the points lie along a curve
/// @return BAT_OK or BAT_NO_MEMORY
bat_status even_sample_radius(const double *points, const neighbour_tree *tree, double *radius, bat_error *error);

/// Choose points that are at least `radius` apart (dart throwing): ends of lines first, then in ascending order.
/// @param chosen count; receives which points are chosen
/// @return BAT_OK or BAT_NO_MEMORY
bat_status even_sample_choose(const double *points, const neighbour_tree *tree, double radius, bool *chosen,
                              bat_error *error);

#endif
