#include "io/curve/geojson_shape.h"

/// @file
/// Crossings of the antimeridian by geodesic edges, in exact units of the file's decimals.

degree_grid degree_grid_of(int decimals)
{
    int64_t degree = degree_units_per_degree(decimals);
    return (degree_grid){180 * degree, 90 * degree, degree_units_per_radian(decimals)};
}

void globe_lines_add(globe_lines *lines, globe_position position)
{
    lines->failed = lines->failed || !ARRAY_ADD(lines->positions, lines->position_capacity, lines->position_count, position);
}

void globe_lines_end(globe_lines *lines)
{
    lines->failed = lines->failed || !ARRAY_ADD(lines->ends, lines->capacity, lines->count, lines->position_count);
}

void globe_lines_free(globe_lines *lines)
{
    free(lines->positions);
    free(lines->ends);
    *lines = (globe_lines){0};
}

globe_position globe_curve_position(const globe_curve *curve, size_t index)
{
    return (globe_position){.shown = curve->shown[index],
                            .values = curve->values != NULL ? curve->values + index * curve->value_stride : NULL};
}

double globe_position_value(const globe_position *position, size_t index)
{
    double value = position->values[index];
    return position->share > 0 ? value + position->share * (position->after[index] - value) : value;
}

static bool on_pole(const degree_grid *grid, degree_units shown)
{
    return shown.latitude == grid->quarter_turn || shown.latitude == -grid->quarter_turn;
}

static bool on_meridian(const degree_grid *grid, degree_units shown)
{
    return shown.longitude == grid->half_turn || shown.longitude == -grid->half_turn;
}

/// Assign the longitude of a vertex at a pole, or the sign of the longitude of a vertex on the antimeridian, from its
/// neighbour.
static void assign_longitude(const degree_grid *grid, degree_units *shown, degree_units neighbour)
{
    if (on_pole(grid, *shown))
        shown->longitude = neighbour.longitude;
    else if (on_meridian(grid, *shown))
        shown->longitude = neighbour.longitude < 0 ? -grid->half_turn : grid->half_turn;
}

/// The first vertex that is neither on the antimeridian nor at a pole; `count` when there is none.
static size_t first_ordinary(const degree_grid *grid, const globe_curve *curve)
{
    size_t first = 0;
    while (first < curve->count && (on_pole(grid, curve->shown[first]) || on_meridian(grid, curve->shown[first])))
        first++;
    return first;
}

static void assign_longitudes(const degree_grid *grid, const globe_curve *curve)
{
    degree_units *shown = curve->shown;
    size_t count = curve->count;
    size_t first = first_ordinary(grid, curve);
    if (first == count)
    {
        for (size_t i = 0; i < count; i++)
            assign_longitude(grid, &shown[i], (degree_units){0});
        return;
    }
    for (size_t i = first + 1; i < count; i++)
        assign_longitude(grid, &shown[i], shown[i - 1]);
    if (curve->closed)
        for (size_t i = 0; i < first; i++)
            assign_longitude(grid, &shown[i], shown[i == 0 ? count - 1 : i - 1]);
    else
        for (size_t i = first; i > 0; i--)
            assign_longitude(grid, &shown[i - 1], shown[i]);
}

/// How far a ring goes around the axis, and the integral of sin(latitude) over the longitude, in radians.
///
/// Let t_1, t_2 be the tangents of half the latitudes at the ends of an arc, and d its longitude difference. Then the
/// integral is 2 atan(tan(d / 2) (t_1 + t_2) / (1 + t_1 t_2)).
static void ring_integral(const degree_grid *grid, const globe_curve *ring, double *turn, double *integral)
{
    *turn = *integral = 0.0;
    for (size_t i = 0; i < ring->count; i++)
    {
        const degree_units a = ring->shown[i], b = ring->shown[i + 1 < ring->count ? i + 1 : 0];
        int64_t step = b.longitude - a.longitude;
        if (llabs(step) > grid->half_turn)
            step += step > 0 ? -2 * grid->half_turn : 2 * grid->half_turn;
        double angle = (double)step / grid->units_per_radian;
        double t1 = tan(0.5 * (double)a.latitude / grid->units_per_radian);
        double t2 = tan(0.5 * (double)b.latitude / grid->units_per_radian);
        *turn += angle;
        *integral += 2.0 * atan2(tan(0.5 * angle) * (t1 + t2), 1.0 + t1 * t2);
    }
}

/// The integral over a ring around the axis is positive when the area north of it is less than 2 pi.
bool globe_ring_encloses_south(const degree_grid *grid, const globe_curve *ring)
{
    if (ring->pole != 0)
        return ring->pole < 0;
    double turn, integral;
    ring_integral(grid, ring, &turn, &integral);
    double north = turn < 0.0 ? -integral : integral;
    return north < 0.0 || (north == 0.0 && turn < 0.0);
}

static bool interior_is_left(const degree_grid *grid, const globe_curve *ring)
{
    double turn, integral;
    ring_integral(grid, ring, &turn, &integral);
    bool hole = ring->role == GLOBE_HOLE;
    if (fabs(turn) < 1.0)
        return (integral < 0.0) != hole;
    return ((turn > 0.0) != globe_ring_encloses_south(grid, ring)) != hole;
}

/// Give vertices after edges along the antimeridian the sign of the interior: going north, 180 degrees when it is on the
/// left.
static void assign_border_sides(const degree_grid *grid, const globe_curve *ring)
{
    bool known = false, left = false;
    for (size_t i = 0; i < ring->count; i++)
    {
        const degree_units before = ring->shown[i > 0 ? i - 1 : ring->count - 1];
        degree_units *shown = &ring->shown[i];
        if (on_pole(grid, *shown) || !on_meridian(grid, *shown) || before.latitude == shown->latitude ||
            !(on_pole(grid, before) || on_meridian(grid, before)))
            continue;
        if (!known)
            left = interior_is_left(grid, ring);
        known = true;
        shown->longitude = (shown->latitude > before.latitude) == left ? grid->half_turn : -grid->half_turn;
    }
}

static size_t next_vertex(const globe_curve *curve, size_t index)
{
    return index + 1 < curve->count ? index + 1 : 0;
}

/// Whether the edge from a vertex to the next crosses the antimeridian. A shortest arc spans at most 180 degrees.
static bool crosses(const degree_grid *grid, const globe_curve *curve, size_t index)
{
    return llabs(curve->shown[index].longitude - curve->shown[next_vertex(curve, index)].longitude) > grid->half_turn;
}

static size_t edge_count(const globe_curve *curve)
{
    return curve->closed ? curve->count : curve->count - 1;
}

bool globe_curve_show(const degree_grid *grid, globe_curve *curve)
{
    bool special = false;
    for (size_t i = 0; i < curve->count; i++)
    {
        const double *point = curve->points + 3 * i;
        if (!isfinite(point[0] + point[1] + point[2]))
            return false;
        curve->shown[i] = degrees_of_point(point, grid->units_per_radian);
        special = special || on_pole(grid, curve->shown[i]) || on_meridian(grid, curve->shown[i]);
    }
    if (special)
        assign_longitudes(grid, curve);
    if (special && curve->closed && curve->role != GLOBE_LINE)
        assign_border_sides(grid, curve);
    curve->cut_count = 0;
    for (size_t i = 0; i < edge_count(curve); i++)
        curve->cut_count += crosses(grid, curve, i);
    return true;
}

static double chord_angle(const double *p, const double *q)
{
    double difference = 0.0, sum = 0.0;
    for (int k = 0; k < 3; k++)
    {
        difference += (p[k] - q[k]) * (p[k] - q[k]);
        sum += (p[k] + q[k]) * (p[k] + q[k]);
    }
    return 2.0 * atan2(sqrt(difference), sqrt(sum));
}

/// The intersection of the arc from a vertex to the next with the antimeridian, on the vertex's side. On the arc from p to q
/// the point with y = 0 is parallel to |q_y| p + |p_y| q.
static globe_position crossing(const degree_grid *grid, const globe_curve *curve, size_t index)
{
    if (on_meridian(grid, curve->shown[index]))
        return globe_curve_position(curve, index);
    size_t next = next_vertex(curve, index);
    const double *p = curve->points + 3 * index, *q = curve->points + 3 * next;
    double weight_p = fabs(q[1]), weight_q = fabs(p[1]);
    double x = weight_p * p[0] + weight_q * q[0], z = weight_p * p[2] + weight_q * q[2];
    double length = hypot(x, z);
    globe_position before = globe_curve_position(curve, index), after = globe_curve_position(curve, next);
    double share = 0.5;
    if (length > 0.0)
    {
        const double c[3] = {x / length, 0.0, z / length};
        double to_p = chord_angle(p, c), to_q = chord_angle(c, q);
        share = to_p + to_q > 0.0 ? to_p / (to_p + to_q) : 0.5;
    }
    globe_position cut = {.shown.longitude = before.shown.longitude < 0 ? -grid->half_turn : grid->half_turn,
                          .shown.latitude = llrint(atan2(z, fabs(x)) * grid->units_per_radian),
                          .values = before.values,
                          .after = after.values,
                          .share = share};
    return cut;
}

static void end_piece(const degree_grid *grid, const globe_curve *curve, size_t index, globe_lines *pieces)
{
    if (!on_meridian(grid, curve->shown[index]))
        globe_lines_add(pieces, crossing(grid, curve, index));
    globe_lines_end(pieces);
}

static void begin_piece(const degree_grid *grid, const globe_curve *curve, size_t index, globe_lines *pieces)
{
    globe_position cut = crossing(grid, curve, index);
    cut.shown.longitude = -cut.shown.longitude;
    globe_lines_add(pieces, cut);
}

static void cut_open(const degree_grid *grid, const globe_curve *curve, globe_lines *pieces)
{
    for (size_t i = 0; i + 1 < curve->count; i++)
    {
        globe_lines_add(pieces, globe_curve_position(curve, i));
        if (!crosses(grid, curve, i))
            continue;
        end_piece(grid, curve, i, pieces);
        begin_piece(grid, curve, i, pieces);
    }
    globe_lines_add(pieces, globe_curve_position(curve, curve->count - 1));
    globe_lines_end(pieces);
}

/// Cut a closed curve, starting at its first crossing.
static void cut_closed(const degree_grid *grid, const globe_curve *curve, size_t start, globe_lines *pieces)
{
    size_t first = 0;
    while (!crosses(grid, curve, first))
        first++;
    begin_piece(grid, curve, first, pieces);
    for (size_t step = 1, i = next_vertex(curve, first); step <= curve->count; step++, i = next_vertex(curve, i))
    {
        globe_position position = globe_curve_position(curve, i);
        position.start = i == 0 ? start : 0;
        globe_lines_add(pieces, position);
        if (!crosses(grid, curve, i))
            continue;
        end_piece(grid, curve, i, pieces);
        if (step < curve->count)
            begin_piece(grid, curve, i, pieces);
    }
}

void globe_curve_cut(const degree_grid *grid, const globe_curve *curve, size_t start, globe_lines *pieces)
{
    if (curve->closed)
        cut_closed(grid, curve, start, pieces);
    else
        cut_open(grid, curve, pieces);
}
