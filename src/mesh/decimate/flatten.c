#include "mesh/decimate/map.h"

#include <string.h>

/// @file
/// Conformal flattening of one-rings by small dense Hermitian systems.
///
/// For a triangle with edges w_0, w_1, w_2 as complex numbers, opposite to its corners, twice the conformal energy of a map
/// z is |sum_k w_k z_k|^2 / (2 area). Boundary positions are eigenvectors (Mullen et al., 2008) or prescribed (Lévy et al.,
/// "Least squares conformal maps", 2002).

/// The energy is computed for triangles whose height over the longest edge, relative to that edge, is larger than this.
static const double MIN_HEIGHT = 1e-3;
/// Rings with a flatter face are mollified: all edges grow by a constant, until the triangle inequality holds with this
/// margin relative to the longest edge. All edges of a ring without extent get the same length.
static const double MOLLIFICATION = 1e-2;
/// Twice the smallest area of a flattened face, relative to its longest squared edge.
static const double MIN_AREA = 1e-7;
/// Relative to the mean diagonal entry, added to the diagonal. The matrix of a planar ring is singular.
static const double SHIFT = 1e-8;

/// Steps of inverse iteration. Eigenvalues of nearly developable rings are well separated; two steps leave an error
/// below one percent.
#define ITERATIONS 3

/// 4 sqrt(3). The quality of a triangle is 4 sqrt(3) times its area over its squared edge lengths.
static const double QUALITY_FACTOR = 6.92820323027550917411;

/// A triangle in its own plane: its edges as complex numbers, opposite to its corners, and twice its area.
typedef struct flat_triangle
{
    double edge[3][2];
    double area;
} flat_triangle;

/// Lay out face k of a ring from its edge lengths, all increased by `added`, with ab on the real axis; the area follows by
/// Kahan's formula. False for a triangle that is too flat.
static bool unfold_face(const collapse_ring *ring, const double (*points)[3], uint32_t k, bool after, double added,
                        uint32_t *corners, flat_triangle *made)
{
    flat_corners(ring, k, after, corners);
    const double *a = points[corners[0]], *b = points[corners[1]], *c = points[corners[2]];
    double ab = vector3_distance(a, b) + added, bc = vector3_distance(b, c) + added, ca = vector3_distance(c, a) + added;
    double longest = fmax(ab, fmax(bc, ca)), shortest = fmin(ab, fmin(bc, ca));
    double middle = fmax(fmin(ab, bc), fmin(fmax(ab, bc), ca));
    double product = (longest + (middle + shortest)) * (shortest - (longest - middle)) * (shortest + (longest - middle)) *
                     (longest + (middle - shortest));
    if (!(product > 0))
        return false;
    double area = 0.5 * sqrt(product), height = area / ab;
    if (!(area > MIN_HEIGHT * longest * longest))
        return false;
    double x = 0.5 * (ab + (ca - bc) * (ca + bc) / ab);
    *made = (flat_triangle){{{x - ab, height}, {-x, -height}, {ab, 0}}, area};
    return true;
}

/// The length to add to all edges of a ring so that every face has a positive height (Sharp and Crane, "A Laplacian for
/// nonmanifold triangle meshes", 2020).
static double mollifier(const collapse_ring *ring, const double (*points)[3], bool after)
{
    double longest = 0, min_gap = INFINITY;
    for (uint32_t k = 0; k < ring->count + (after ? 0 : ring->vanishing); k++)
    {
        uint32_t corners[3];
        flat_corners(ring, k, after, corners);
        const double *a = points[corners[0]], *b = points[corners[1]], *c = points[corners[2]];
        double ab = vector3_distance(a, b), bc = vector3_distance(b, c), ca = vector3_distance(c, a),
               largest = fmax(ab, fmax(bc, ca));
        longest = fmax(longest, largest);
        min_gap = fmin(min_gap, ab + bc + ca - 2 * largest);
    }
    return longest > 0 ? fmax(MOLLIFICATION * longest - min_gap, 0) : 1;
}

/// The matrix row of each point, or FLAT_UNKNOWNS for a fixed point.
typedef struct flat_rows
{
    uint32_t row[FLAT_POINTS];
    uint32_t count;
} flat_rows;

static void choose_rows(const collapse_ring *ring, bool on_line, flat_workspace *workspace, flat_rows *rows)
{
    uint32_t last = FLAT_RING + collapse_ring_vertices(ring) - 1;
    rows->count = 0;
    rows->row[FLAT_NEW] = FLAT_UNKNOWNS;
    for (uint32_t p = 0; p <= last; p++)
    {
        bool held = p == FLAT_NEW || (on_line && (p <= FLAT_RING || p == last));
        rows->row[p] = held ? FLAT_UNKNOWNS : rows->count;
        if (!held)
            workspace->unknown[rows->count++] = p;
    }
}

/// Add |sum_k w_k z_k|^2 / (2 area) of a face: unknown points enter the matrix, fixed points the right-hand side.
static void add_face(const flat_triangle *face, const uint32_t *corners, const flat_rows *rows, const double (*flat)[2],
                     flat_workspace *workspace)
{
    double scale = 1 / face->area;
    for (int p = 0; p < 3; p++)
    {
        uint32_t row = rows->row[corners[p]];
        if (row == FLAT_UNKNOWNS)
            continue;
        for (int q = 0; q < 3; q++)
        {
            const double *w = face->edge[p], *v = face->edge[q];
            double real = scale * (w[0] * v[0] + w[1] * v[1]), imaginary = scale * (w[0] * v[1] - w[1] * v[0]);
            uint32_t column = rows->row[corners[q]];
            if (column == FLAT_UNKNOWNS)
            {
                const double *z = flat[corners[q]];
                workspace->right[row][0] -= real * z[0] - imaginary * z[1];
                workspace->right[row][1] -= real * z[1] + imaginary * z[0];
            }
            else if (column <= row)
            {
                workspace->real[row][column] += real;
                workspace->imaginary[row][column] += imaginary;
            }
        }
    }
}

/// Assemble the matrix and the right-hand side, with all edge lengths increased by `added`. False for a ring with a face
/// that is too flat.
static bool assemble_longer(const collapse_ring *ring, const double (*points)[3], double added, const flat_rows *rows,
                            const double (*flat)[2], flat_workspace *workspace)
{
    for (uint32_t r = 0; r < rows->count; r++)
    {
        memset(workspace->real[r], 0, (r + 1) * sizeof workspace->real[r][0]);
        memset(workspace->imaginary[r], 0, (r + 1) * sizeof workspace->imaginary[r][0]);
        workspace->right[r][0] = workspace->right[r][1] = 0;
    }
    for (uint32_t k = 0; k < ring->count + ring->vanishing; k++)
    {
        uint32_t corners[3];
        flat_triangle face;
        if (!unfold_face(ring, points, k, false, added, corners, &face))
            return false;
        add_face(&face, corners, rows, flat, workspace);
    }
    return true;
}

static bool assemble(const collapse_ring *ring, const double (*points)[3], const flat_rows *rows, const double (*flat)[2],
                     flat_workspace *workspace)
{
    return assemble_longer(ring, points, 0, rows, flat, workspace) ||
           assemble_longer(ring, points, mollifier(ring, points, false), rows, flat, workspace);
}

/// Factorize the matrix as L L^H (Cholesky) in place. False when it is not positive definite.
static bool factorize(flat_workspace *workspace, uint32_t count, double shift)
{
    for (uint32_t r = 0; r < count; r++)
    {
        double *real = workspace->real[r], *imaginary = workspace->imaginary[r];
        double pivot = real[r] + shift;
        for (uint32_t c = 0; c < r; c++)
        {
            const double *other_real = workspace->real[c], *other_imaginary = workspace->imaginary[c];
            double x = real[c], y = imaginary[c];
            for (uint32_t k = 0; k < c; k++)
            {
                x -= real[k] * other_real[k] + imaginary[k] * other_imaginary[k];
                y -= imaginary[k] * other_real[k] - real[k] * other_imaginary[k];
            }
            real[c] = x *= workspace->inverse_pivot[c];
            imaginary[c] = y *= workspace->inverse_pivot[c];
            pivot -= x * x + y * y;
        }
        if (!(pivot > 0))
            return false;
        workspace->inverse_pivot[r] = 1 / sqrt(pivot);
    }
    return true;
}

/// Solve L L^H z = right in place.
static void solve(flat_workspace *workspace, uint32_t count)
{
    double(*z)[2] = workspace->right;
    for (uint32_t r = 0; r < count; r++)
    {
        double x = z[r][0], y = z[r][1];
        for (uint32_t c = 0; c < r; c++)
        {
            x -= workspace->real[r][c] * z[c][0] - workspace->imaginary[r][c] * z[c][1];
            y -= workspace->real[r][c] * z[c][1] + workspace->imaginary[r][c] * z[c][0];
        }
        z[r][0] = x * workspace->inverse_pivot[r];
        z[r][1] = y * workspace->inverse_pivot[r];
    }
    for (uint32_t r = count; r-- > 0;)
    {
        double x = z[r][0] *= workspace->inverse_pivot[r], y = z[r][1] *= workspace->inverse_pivot[r];
        for (uint32_t c = 0; c < r; c++)
        {
            z[c][0] -= workspace->real[r][c] * x + workspace->imaginary[r][c] * y;
            z[c][1] -= workspace->real[r][c] * y - workspace->imaginary[r][c] * x;
        }
    }
}

/// The initial guess: outer vertices on a circle, i and j at its centre.
static void lay_on_circle(const collapse_ring *ring, double (*flat)[2])
{
    uint32_t count = collapse_ring_vertices(ring);
    double angle = ANGLE_TURN / count, cosine = cos(angle), sine = sin(angle), at[2] = {1, 0};
    for (uint32_t k = 0; k < count; k++)
    {
        memcpy(flat[FLAT_RING + k], at, sizeof at);
        double x = cosine * at[0] - sine * at[1];
        at[1] = sine * at[0] + cosine * at[1];
        at[0] = x;
    }
    memset(flat[FLAT_I], 0, sizeof flat[0]);
    memset(flat[FLAT_J], 0, sizeof flat[0]);
}

/// Shift the mean of the boundary points to the origin and scale their mean square to 1. Copy them to the right-hand side,
/// with zeros for interior points. False when all points coincide.
static bool normalize(const collapse_ring *ring, uint32_t unknowns, double (*flat)[2], flat_workspace *workspace)
{
    uint32_t boundary = 0;
    double mean[2] = {0}, square = 0;
    for (uint32_t r = 0; r < unknowns; r++)
    {
        const double *z = flat[workspace->unknown[r]];
        bool inside = workspace->unknown[r] == FLAT_J || (workspace->unknown[r] == FLAT_I && ring->closed);
        boundary += !inside;
        for (int c = 0; c < 2 && !inside; c++)
            mean[c] += z[c];
    }
    mean[0] /= boundary;
    mean[1] /= boundary;
    for (uint32_t r = 0; r < unknowns; r++)
    {
        double *z = flat[workspace->unknown[r]];
        bool inside = workspace->unknown[r] == FLAT_J || (workspace->unknown[r] == FLAT_I && ring->closed);
        for (int c = 0; c < 2; c++)
            workspace->right[r][c] = inside ? 0 : z[c] - mean[c];
        square += workspace->right[r][0] * workspace->right[r][0] + workspace->right[r][1] * workspace->right[r][1];
    }
    double scale = sqrt(boundary / square);
    if (!isfinite(scale))
        return false;
    for (uint32_t r = 0; r < unknowns; r++)
        for (int c = 0; c < 2; c++)
        {
            workspace->right[r][c] *= scale;
            flat[workspace->unknown[r]][c] = (flat[workspace->unknown[r]][c] - mean[c]) * scale;
        }
    return true;
}

/// The eigenvector with the smallest ratio of conformal energy to boundary moment, by inverse iteration.
static bool flatten_free(const collapse_ring *ring, const double (*points)[3], flat_workspace *workspace, double (*flat)[2])
{
    flat_rows rows;
    choose_rows(ring, false, workspace, &rows);
    if (!assemble(ring, points, &rows, (const double(*)[2])flat, workspace))
        return false;
    double trace = 0;
    for (uint32_t r = 0; r < rows.count; r++)
        trace += workspace->real[r][r];
    if (!factorize(workspace, rows.count, SHIFT * trace / rows.count))
        return false;
    lay_on_circle(ring, flat);
    for (int i = 0; i < ITERATIONS; i++)
    {
        if (!normalize(ring, rows.count, flat, workspace))
            return false;
        solve(workspace, rows.count);
        for (uint32_t r = 0; r < rows.count; r++)
            memcpy(flat[workspace->unknown[r]], workspace->right[r], sizeof flat[0]);
    }
    return normalize(ring, rows.count, flat, workspace);
}

/// The least-squares conformal map with the boundary on the real axis.
static bool flatten_on_line(const collapse_ring *ring, const double (*points)[3], flat_workspace *workspace,
                            double (*flat)[2])
{
    const uint32_t line[4] = {FLAT_RING + ring->count, FLAT_I, FLAT_J, FLAT_RING};
    flat_rows rows;
    choose_rows(ring, true, workspace, &rows);
    double length = 0;
    for (int k = 0; k < 4; k++)
    {
        length += k > 0 ? vector3_distance(points[line[k]], points[line[k - 1]]) : 0;
        flat[line[k]][0] = length;
        flat[line[k]][1] = 0;
    }
    if (!assemble(ring, points, &rows, (const double(*)[2])flat, workspace) || !factorize(workspace, rows.count, 0))
        return false;
    solve(workspace, rows.count);
    for (uint32_t r = 0; r < rows.count; r++)
        memcpy(flat[workspace->unknown[r]], workspace->right[r], sizeof flat[0]);
    return true;
}

/// Place the new vertex by least squares with all other points fixed and all edges increased by `added`; on the real axis if
/// `on_line`. False for a ring with a face that is too flat.
static bool place_new(const collapse_ring *ring, const double (*points)[3], double added, bool on_line, double (*flat)[2])
{
    double weight = 0, sum[2] = {0};
    for (uint32_t k = 0; k < ring->count; k++)
    {
        uint32_t corners[3];
        flat_triangle face;
        if (!unfold_face(ring, points, k, true, added, corners, &face))
            return false;
        const double *w = face.edge[0];
        weight += (w[0] * w[0] + w[1] * w[1]) / face.area;
        for (int q = 1; q < 3; q++)
        {
            const double *v = face.edge[q], *z = flat[corners[q]];
            double real = (w[0] * v[0] + w[1] * v[1]) / face.area, imaginary = (w[0] * v[1] - w[1] * v[0]) / face.area;
            sum[0] -= real * z[0] - imaginary * z[1];
            sum[1] -= real * z[1] + imaginary * z[0];
        }
    }
    flat[FLAT_NEW][0] = sum[0] / weight;
    flat[FLAT_NEW][1] = on_line ? 0 : sum[1] / weight;
    return true;
}

bool flatten_ring(const collapse_ring *ring, const double (*points)[3], flat_workspace *workspace, double (*flat)[2])
{
    bool on_line = ring->vanishing == 1;
    if (on_line ? !flatten_on_line(ring, points, workspace, flat) : !flatten_free(ring, points, workspace, flat))
        return false;
    if (ring->closed || on_line)
        return place_new(ring, points, 0, on_line, flat) ||
               place_new(ring, points, mollifier(ring, points, true), on_line, flat);
    memcpy(flat[FLAT_NEW], flat[FLAT_I], sizeof flat[0]);
    return true;
}

/// Twice the signed area of a triangle in the plane, and the sum of its squared edge lengths.
static double flat_area(const double *a, const double *b, const double *c, double *squares)
{
    double ab[2] = {b[0] - a[0], b[1] - a[1]}, ac[2] = {c[0] - a[0], c[1] - a[1]}, bc[2] = {c[0] - b[0], c[1] - b[1]};
    *squares = ab[0] * ab[0] + ab[1] * ab[1] + ac[0] * ac[0] + ac[1] * ac[1] + bc[0] * bc[0] + bc[1] * bc[1];
    return ab[0] * ac[1] - ab[1] * ac[0];
}

/// The lowest quality of the faces; negative where one is inverted or has no area.
static double worst_quality(const collapse_ring *ring, const double (*flat)[2], bool after)
{
    double worst = 1;
    for (uint32_t k = 0; k < ring->count + (after ? 0 : ring->vanishing); k++)
    {
        uint32_t corners[3];
        flat_corners(ring, k, after, corners);
        double squares, area = flat_area(flat[corners[0]], flat[corners[1]], flat[corners[2]], &squares);
        if (!(area > MIN_AREA * squares))
            return -1;
        worst = fmin(worst, QUALITY_FACTOR / 2 * area / squares);
    }
    return worst;
}

/// Whether the faces around the new vertex cover a full turn exactly once, or less on the boundary. All of them have
/// positive areas. Each turn passes the direction of vertex[0] once, from right to left.
static bool winds_once(const collapse_ring *ring, const double (*flat)[2])
{
    uint32_t turns = 0;
    bool was_right = false;
    for (uint32_t k = 1; k <= ring->count; k++)
    {
        uint32_t vertex = ring->closed && k == ring->count ? 0 : k;
        bool right = vertex != 0 && vector2_turn(flat[FLAT_NEW], flat[FLAT_RING], flat[FLAT_RING + vertex]) < 0;
        turns += was_right && !right;
        was_right = right;
    }
    return turns == (ring->closed ? 1 : 0);
}

bool flat_is_valid(const collapse_ring *ring, const double (*flat)[2], double min_quality)
{
    double before = worst_quality(ring, flat, false), after = worst_quality(ring, flat, true);
    return before > 0 && after > 0 && after >= fmin(min_quality, before) && winds_once(ring, flat);
}
