#include "curve/topology/draw_back.h"

#include "base/error.h"
#include "batten/curve_measure.h"
#include "curve/polygon.h"

static bool stop_at_first(void *apart, edge_place first BAT_UNUSED, edge_place second BAT_UNUSED)
{
    return *(bool *)apart = false;
}

bat_status curve_edges_are_apart(const bat_curve *curve, bool *apart, bat_error *error)
{
    *apart = true;
    return edge_pairs_find(curve, 1, 0, EDGE_PAIRS_SAME_CURVE, 1, stop_at_first, apart, error);
}

/// The number of pairs of edges that meet, and the first of them.
typedef struct pair_count
{
    size_t pairs, first;
} pair_count;

static bool count_pair(void *context, edge_place first, edge_place second BAT_UNUSED)
{
    pair_count *count = context;
    count->first = count->pairs == 0 || first.edge < count->first ? first.edge : count->first;
    count->pairs++;
    return true;
}

/// A curve that does not contain the given points has no edges to be drawn back to.
static bat_status only_count(const bat_curve *fine, bool must, bat_curve_refine_report *report, bat_error *error)
{
    pair_count count = {0, 0};
    bat_status status = edge_pairs_find(fine, 1, 0, EDGE_PAIRS_SAME_CURVE, 1, count_pair, &count, error);
    if (status != BAT_OK)
        return status;
    if (must && count.pairs > 0)
        return ERROR_UNSUPPORTED(
            error, 0,
            "the refined curve crosses itself after its point %zu, and the scheme does not keep the given "
            "points, to which it could be drawn back",
            count.first);
    report->crossings = count.pairs;
    report->crossing = report->left_crossing = count.pairs > 0;
    return BAT_OK;
}

/// A curve that crosses itself stays as it is, or is refused.
static bat_status leave_crossing(const bat_curve_refine_options *options, bat_error *error)
{
    return !options->strict ? BAT_OK
                            : error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "the curve crosses or overlaps itself");
}

bool wants_simple(const bat_curve *coarse, const bat_curve_refine_options *options)
{
    surface_kind kind;
    bool wanted =
        options->simple == BAT_CURVE_SIMPLE_ALWAYS || (options->simple <= BAT_CURVE_SIMPLE_RINGS && coarse->closed);
    return wanted && options->levels > 0 && surface_of_space(coarse->space, &kind);
}

bat_status keep_simple(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine,
                       const size_t *starts, bat_progress progress, bat_curve_refine_report *report, bat_error *error)
{
    *report = (bat_curve_refine_report){0};
    if (!wants_simple(coarse, options))
        return BAT_OK;
    bool apart;
    bat_status status = curve_edges_are_apart(coarse, &apart, error);
    if (status != BAT_OK)
        return status;
    report->checked = 1;
    report->given_crossing = !apart;
    if (!apart)
        return leave_crossing(options, error);
    if (!contains_points(coarse, fine, starts))
        return only_count(fine, options->strict || options->simple == BAT_CURVE_SIMPLE_ALWAYS, report, error);
    draw_back_counts counts;
    drawn_curve drawn = {.coarse = coarse, .starts = starts};
    draw_rules rules = {.pairs = EDGE_PAIRS_SAME_CURVE, .straight_may_meet = options->simple <= BAT_CURVE_SIMPLE_RINGS};
    status = draw_back(&drawn, fine, 1, &rules, progress, &counts, error);
    if (status != BAT_OK)
        return status;
    report->crossing = counts.crossings > 0;
    report->crossings = counts.crossings;
    report->drawn_back = counts.edges;
    report->straight = counts.straight;
    report->left_crossing = counts.stuck.curve != BAT_NO_INDEX;
    return report->left_crossing ? leave_crossing(options, error) : BAT_OK;
}

/// Edges need a unique geodesic.
static bat_status check_edges(const bat_curve *curve, bat_error *error)
{
    const bat_space *space = curve->space;
    size_t edges = polygon_edges(curve->count, curve->closed);
    for (size_t i = 0; i < edges; i++)
    {
        size_t next = i + 1 == curve->count ? 0 : i + 1;
        double tangent[3];
        if (space->log(space, curve->points + i * space->point_dim, curve->points + next * space->point_dim, tangent) !=
            BAT_OK)
            return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    }
    return BAT_OK;
}

bat_status bat_curve_is_simple(const bat_curve *curve, bool *simple, bat_error *error)
{
    surface_kind kind;
    if (!surface_of_space(curve->space, &kind))
        return ERROR_UNSUPPORTED(
            error, 0, "curves cross only in surfaces (plane, sphere in R^3, disk), not in the %s of dimension %zu",
            curve->space->name, curve->space->dimension);
    if (curve->count == 0)
        return ERROR_ARGUMENT(error, "a curve without points");
    bat_status status = bat_space_check(curve->space, curve->points, curve->count, error);
    if (status == BAT_OK && kind == SURFACE_SPHERE)
        status = check_edges(curve, error);
    return status == BAT_OK ? curve_edges_are_apart(curve, simple, error) : status;
}
