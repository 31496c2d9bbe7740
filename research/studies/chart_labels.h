#ifndef RESEARCH_STUDIES_CHART_LABELS_H
#define RESEARCH_STUDIES_CHART_LABELS_H

#include "draw/curve/scene.h"

/// Draw texts beside the points of a series, where they cover least.
/// @param texts one for each point; null for none
/// @return BAT_OK or BAT_NO_MEMORY
bat_status chart_labels_draw(cairo_t *cairo, const bat_chart_series *series, const char *const *texts, const plot_axis *x,
                             const plot_axis *y, bat_error *error);

#endif
