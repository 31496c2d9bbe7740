#ifndef RESEARCH_DATA_TENSION_FAMILY_H
#define RESEARCH_DATA_TENSION_FAMILY_H

#include "batten/base.h"
#include "batten/research/curve_data.h"

/// @file
/// Continuous families of closed curves in each space, to draw as many fresh curves from as one likes.
///
/// Half of the draws from a trained family follow the published distribution of section 6.1 of Ugail and Howard (2026) where
/// that has such a family; the other half are wider. No unseen family has a member in common with a trained one. Curves of
/// the sphere are turned by a random rotation; curves of the disk are turned about the origin and, unless they follow the
/// published distribution, moved by a hyperbolic translation too. docs/tension.md describes the families.

/// The trained or the unseen families of a space.
size_t tension_family_count(bat_tension_space space, bool unseen);

/// A family's name, for example "superellipse".
/// @param family below tension_family_count()
const char *tension_family_name(bat_tension_space space, bool unseen, size_t family);

/// Draw a curve. It is closed; its first point is not repeated. Curves of the plane have largest radius 1, curves of the
/// disk stay within radius 0.95, points of the sphere have unit length to 1e-15.
///
/// @param family below tension_family_count()
/// @param count  points, at least 3; even in the curve's parameter
/// @param points receives count x 2, on the sphere count x 3
void tension_family_draw(bat_tension_space space, bool unseen, size_t family, bat_random *random, size_t count,
                         double *points);

/// @file
/// What tension_family.h is put together from: the families of each space.

/// A family by name. `draw` writes `count` points of a random member.
typedef struct tension_family
{
    const char *name;
    void (*draw)(bat_random *random, size_t count, double *points);
} tension_family;

typedef struct tension_family_list
{
    const tension_family *families;
    size_t count;
} tension_family_list;

/// Curves of any centre and size.
tension_family_list plane_families(bool unseen);
/// Curves of points that have unit length to 1e-12, not yet turned.
tension_family_list sphere_families(bool unseen);
tension_family_list disk_families(bool unseen);

#endif
