#include "batten/curve_scheme.h"

bat_curve_scheme bat_curve_scheme_linear(bat_mask mask)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_LINEAR, .mask = mask};
}

bat_curve_scheme bat_curve_scheme_angle(double mu)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_ANGLE, .tension = mu};
}

bat_curve_scheme bat_curve_scheme_angle_rule(const bat_curve_angle_rule *rule)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_ANGLE, .rule = rule};
}

bat_curve_scheme bat_curve_scheme_log_exp(bat_mask mask)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_LOG_EXP, .mask = mask};
}

bat_curve_scheme bat_curve_scheme_geodesic(size_t order)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_GEODESIC, .mask = bat_mask_lane_riesenfeld(order)};
}
