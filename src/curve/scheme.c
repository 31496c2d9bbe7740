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

bat_curve_scheme bat_curve_scheme_four_point(bat_curve_parameters parameters, double w)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_FOUR_POINT, .parameters = parameters, .tension = w};
}

bat_curve_scheme bat_curve_scheme_catmull_rom(bat_curve_parameters parameters)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_CATMULL_ROM, .parameters = parameters};
}

bat_curve_scheme bat_curve_scheme_cubic(bat_curve_parameters parameters)
{
    return (bat_curve_scheme){.kind = BAT_CURVE_SCHEME_CUBIC, .parameters = parameters};
}
