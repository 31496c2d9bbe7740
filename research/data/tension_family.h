#ifndef RESEARCH_DATA_TENSION_FAMILY_H
#define RESEARCH_DATA_TENSION_FAMILY_H

#include "batten/base.h"
#include "batten/research/curve_data.h"

/// @file
/// Continuous families of closed curves in each space, from which any number of curves can be drawn.
///
/// Half of the draws from a training family follow the published distribution of section 6.1 of Ugail and Howard (2026), if
/// it contains the family; the other half are from a wider distribution. Unseen families share no member with training
/// families. Curves on the sphere are rotated at random. Curves in the disk are rotated about the origin and, unless they
/// follow the published distribution, moved by a hyperbolic translation. docs/algorithms/tension-network.md describes the
/// families.

/// The number of training families or of unseen families of a space.
size_t tension_family_count(bat_tension_space space, bool unseen);

/// A family's name, for example "superellipse".
/// @param family below tension_family_count()
const char *tension_family_name(bat_tension_space space, bool unseen, size_t family);

/// Draw a closed curve; its first point is not repeated. Curves in the plane have maximum norm 1, curves in the disk stay
/// within radius 0.95, and points on the sphere have unit length up to 1e-15.
///
/// @param family below tension_family_count()
/// @param count  number of points, at least 3, equally spaced in the parameter
/// @param points receives count x 2, on the sphere count x 3
void tension_family_draw(bat_tension_space space, bool unseen, size_t family, bat_random *random, size_t count,
                         double *points);

/// A family. `draw` writes `count` points of a random member.
typedef struct tension_family
{
    const char *name;
    void (*draw)(bat_random *random, size_t count, double *points);
} tension_family;

/// The families of a space.
typedef struct tension_family_list
{
    const tension_family *families;
    size_t count;
} tension_family_list;

/// Curves with any centre and size.
tension_family_list plane_families(bool unseen);
/// Points with unit length up to 1e-12, before the random rotation.
tension_family_list sphere_families(bool unseen);
tension_family_list disk_families(bool unseen);

#endif
