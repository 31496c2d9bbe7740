#include "base/choice.h"
#include "batten/mesh.h"

/// @file
/// The tables of the rules that a mesh can carry.

static const bat_choice BOUNDARIES[] = {
    {.name = "auto", .summary = "as the file says, else edges", .value = BAT_MESH_BOUNDARY_AUTO},
    {.name = "edges", .summary = "a smooth curve", .value = BAT_MESH_BOUNDARY_EDGES},
    {.name = "corners",
     .summary = "a smooth curve with sharp corners at vertices of one face",
     .value = BAT_MESH_BOUNDARY_CORNERS},
    {.name = "none", .summary = "the surface ends one face before it", .value = BAT_MESH_BOUNDARY_NONE},
};
const bat_family bat_mesh_boundary_family = FAMILY("boundary rule", BOUNDARIES);

static const bat_choice CREASINGS[] = {
    {.name = "auto", .summary = "as the file says, else uniform", .value = BAT_MESH_CREASING_AUTO},
    {.name = "uniform", .summary = "sharpness decreases by 1 a level", .value = BAT_MESH_CREASING_UNIFORM},
    {.name = "chaikin", .summary = "sharpness is also smoothed along creases", .value = BAT_MESH_CREASING_CHAIKIN},
};
const bat_family bat_mesh_creasing_family = FAMILY("creasing rule", CREASINGS);

static const bat_choice LINEARS[] = {
    {.name = "auto", .summary = "as the file says, else all", .value = BAT_MESH_LINEAR_AUTO},
    {.name = "all", .summary = "texture is linear everywhere", .value = BAT_MESH_LINEAR_ALL},
    {.name = "none", .summary = "texture and its seams are smooth", .value = BAT_MESH_LINEAR_NONE},
    {.name = "corners", .summary = "corners of one face stay", .value = BAT_MESH_LINEAR_CORNERS},
    {.name = "corners-plus1",
     .summary = "and points where more than two seams meet",
     .value = BAT_MESH_LINEAR_CORNERS_PLUS1},
    {.name = "corners-plus2",
     .summary = "and ends of seams and sides beside a corner",
     .value = BAT_MESH_LINEAR_CORNERS_PLUS2},
    {.name = "boundaries", .summary = "seams and boundaries are linear", .value = BAT_MESH_LINEAR_BOUNDARIES},
};
const bat_family bat_mesh_linear_family = FAMILY("texture rule", LINEARS);
