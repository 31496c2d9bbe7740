#ifndef DRAW_CURVE_PROXY_H
#define DRAW_CURVE_PROXY_H

#include "batten/curve_picture.h"
#include "draw/common/style.h"

/// @file
/// Spaces that are drawn by way of another: what stands on paper for curves of rotations, rigid motions and the hyperboloid.
///
/// A rotation becomes its moving frame: the columns of its matrix are three curves on the sphere, and at control points the
/// frame is the triangle between them. A rigid motion becomes the path of the body's origin in R^3, with the body's axes
/// along it. The hyperboloid of dimension 2 becomes the disk.

/// A panel in another space. `lines[i]` is how layer i is drawn; of width 0: as its role has it.
typedef struct proxy
{
    bat_space space;
    bat_curve *curves;
    bat_curve_picture_layer *layers;
    line_style *lines;
    size_t count;
    bat_curve_picture_panel panel;
} proxy;

/// The stand-in for a panel that was checked; release it with proxy_free().
/// @return BAT_OK; BAT_CUT_LOCUS with the index of a point half a turn from the next; BAT_NO_MEMORY
bat_status proxy_make(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options, proxy *made,
                      bat_error *error);
/// Free everything. Does nothing to a stand-in that is all zero.
void proxy_free(proxy *made);

#endif
