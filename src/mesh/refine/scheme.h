#ifndef MESH_REFINE_SCHEME_H
#define MESH_REFINE_SCHEME_H

#include "base/choice.h"
#include "batten/mesh_refine.h"
#include "mesh/refine/sharpness.h"

/// @file
/// The table of mesh schemes. A new scheme that splits every face in four is a row here, a bat_mesh_scheme, and a file with
/// its rule.

typedef struct mesh_scheme
{
    bat_choice choice;
    mesh_rule *rule;     ///< makes the rows of the next level; a learned scheme's is for channels alone
    mesh_rule *limit;    ///< moves the rows of a level to the limit; null where vertices lie there already
    bool learned;        ///< positions come from bat_mesh_refine_options::rule
    bool turns;          ///< edges are turned (square-root-three): `rule` is null, a level makes three faces of one
    bool continues;      ///< may follow the levels of a learned scheme
    bool creases;        ///< knows creases, corners, and the rules of bat_mesh_rules
    bool polygons;       ///< takes any polygons and makes quads
    smooth_mask *smooth; ///< the mask of a smooth vertex, where `creases`
} mesh_scheme;

/// The row of a scheme that exists.
const mesh_scheme *mesh_scheme_of(bat_mesh_scheme scheme);

#endif
