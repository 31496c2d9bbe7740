#ifndef DRAW_CURVE_PROXY_H
#define DRAW_CURVE_PROXY_H

#include "batten/curve_picture.h"
#include "draw/common/style.h"

/// @file
/// Proxies of spaces that have no drawing of their own: rotations, rigid motions and the hyperboloid.
///
/// A curve of rotations becomes three curves on the sphere, the columns of the matrices; at control points a triangle joins
/// the columns. A rigid motion becomes the path of the body's origin in R^3, with the body's axes along it. The hyperboloid
/// of dimension 2 becomes the disk.

/// A panel in the proxy's space. `lines[i]` is the style of layer i; with width 0 it follows from the layer's role.
typedef struct proxy
{
    bat_space space;
    bat_curve *curves;
    bat_curve_picture_layer *layers;
    line_style *lines;
    size_t count;
    bat_curve_picture_panel panel;
} proxy;

/// Make the proxy of a checked panel; release it with proxy_free().
/// @return BAT_OK; BAT_CUT_LOCUS with the index of a point half a turn from the next; BAT_NO_MEMORY
bat_status proxy_make(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options, proxy *made,
                      bat_error *error);
/// Release everything; does nothing to a proxy that is all zero.
void proxy_free(proxy *made);

#endif
