/// @file
/// Evaluation of Boolean expressions of implicit surfaces, and Newton steps to intersections of surfaces:
///     dx = -G^T (G G^T)^-1 f,   G the gradients of the surfaces, f their values.

#include "research/shapes/solid.h"
#include "linalg/vector.h"

#include <assert.h>
#include <math.h>

static void push_step(solid *s, solid_operation operation, size_t surface)
{
    assert(s->step_count < SOLID_MAX_STEPS);
    s->steps[s->step_count++] = (solid_step){operation, surface};
}

static void push_surface(solid *s, solid_function *value, const void *context, bool open)
{
    assert(s->surface_count < SOLID_MAX_SURFACES);
    push_step(s, SOLID_SURFACE, s->surface_count);
    s->surfaces[s->surface_count++] = (solid_surface){value, context, open};
}

void solid_push(solid *s, solid_function *value, const void *context)
{
    push_surface(s, value, context, false);
}

void solid_push_open(solid *s, solid_function *value, const void *context)
{
    push_surface(s, value, context, true);
}

void solid_and(solid *s)
{
    push_step(s, SOLID_AND, 0);
}

void solid_or(solid *s)
{
    push_step(s, SOLID_OR, 0);
}

void solid_not(solid *s)
{
    push_step(s, SOLID_NOT, 0);
}

void solid_subtract(solid *s)
{
    solid_not(s);
    solid_and(s);
}

double solid_value(const solid *s, const double point[3])
{
    double stack[SOLID_MAX_STEPS] = {0};
    size_t top = 0;
    for (size_t i = 0; i < s->step_count; i++)
    {
        const solid_surface *surface = &s->surfaces[s->steps[i].surface];
        switch (s->steps[i].operation)
        {
        case SOLID_SURFACE:
            stack[top++] = surface->value(surface->context, point);
            break;
        case SOLID_AND:
            top--;
            stack[top - 1] = fmax(stack[top - 1], stack[top]);
            break;
        case SOLID_OR:
            top--;
            stack[top - 1] = fmin(stack[top - 1], stack[top]);
            break;
        case SOLID_NOT:
            stack[top - 1] = -stack[top - 1];
            break;
        }
    }
    return stack[0];
}

bool solid_is_inside(const solid *s, uint64_t surfaces)
{
    bool stack[SOLID_MAX_STEPS] = {0};
    size_t top = 0;
    for (size_t i = 0; i < s->step_count; i++)
    {
        switch (s->steps[i].operation)
        {
        case SOLID_SURFACE:
            stack[top++] = (surfaces >> s->steps[i].surface & 1) != 0;
            break;
        case SOLID_AND:
            top--;
            stack[top - 1] = stack[top - 1] && stack[top];
            break;
        case SOLID_OR:
            top--;
            stack[top - 1] = stack[top - 1] || stack[top];
            break;
        case SOLID_NOT:
            stack[top - 1] = !stack[top - 1];
            break;
        }
    }
    return stack[0];
}

/// Value and gradient by differences along four diagonals of a cube, with four evaluations.
static double slope(const solid_surface *surface, const double point[3], double difference, double gradient[3])
{
    static const double DIAGONALS[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double mean = 0;
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int i = 0; i < 4; i++)
    {
        double near[3];
        for (int c = 0; c < 3; c++)
            near[c] = point[c] + difference * DIAGONALS[i][c];
        double value = surface->value(surface->context, near);
        mean += value / 4;
        for (int c = 0; c < 3; c++)
            gradient[c] += value * DIAGONALS[i][c] / (4 * difference);
    }
    return mean;
}

/// Solve a symmetric system a x = b with up to 3 unknowns by Cholesky's method; x overwrites b. The diagonal is increased
/// slightly to regularize nearly parallel surfaces.
static void solve_small(double a[SOLID_MAX_MEETING][SOLID_MAX_MEETING], size_t count, double *b)
{
    for (size_t i = 0; i < count; i++)
    {
        a[i][i] = a[i][i] * (1 + 1e-6) + 1e-12;
        for (size_t k = 0; k < i; k++)
            a[i][i] -= a[i][k] * a[i][k];
        a[i][i] = sqrt(fmax(a[i][i], 1e-12));
        for (size_t j = i + 1; j < count; j++)
        {
            for (size_t k = 0; k < i; k++)
                a[j][i] -= a[j][k] * a[i][k];
            a[j][i] /= a[i][i];
        }
    }
    for (size_t i = 0; i < count; i++)
    {
        for (size_t k = 0; k < i; k++)
            b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (size_t i = count; i-- > 0;)
    {
        for (size_t k = i + 1; k < count; k++)
            b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
}

void solid_step_towards(const solid *s, const size_t *surfaces, size_t count, double longest, double difference,
                        double point[3])
{
    double gradients[SOLID_MAX_MEETING][3] = {{0}}, products[SOLID_MAX_MEETING][SOLID_MAX_MEETING];
    double weights[SOLID_MAX_MEETING] = {0};
    for (size_t i = 0; i < count; i++)
        weights[i] = slope(&s->surfaces[surfaces[i]], point, difference, gradients[i]);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            products[i][j] = vector3_dot(gradients[i], gradients[j]);
    solve_small(products, count, weights);
    double step[3] = {0, 0, 0};
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            step[c] -= weights[i] * gradients[i][c];
    double length = sqrt(vector3_dot(step, step));
    double share = length > longest ? longest / length : 1;
    for (int c = 0; c < 3; c++)
        point[c] += share * step[c];
}
