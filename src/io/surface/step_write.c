#include "io/surface/formats.h"
#include "io/surface/step.h"
#include "io/surface/trimmed_model.h"
#include "surface/spline/knot_vector.h"
#include "surface/spline/tensor_surface.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

/// @file
/// A spline surface as an open shell of B-spline faces, in the schema AP242 of ISO 10303.

/// Numbers of entities to which others refer.
typedef struct step_entities
{
    uint32_t definition_shape, context, placement;
    uint32_t *vertices, *edges, *faces;
    size_t face_count;
} step_entities;

static void write_header(step_text *step)
{
    step_plain(step,
               "ISO-10303-21;\nHEADER;\n"
               "FILE_DESCRIPTION(('spline surface as an open shell'),'2;1');\n"
               "FILE_NAME('surface','1970-01-01T00:00:00',(''),(''),'batten %d.%d.%d','batten','');\n",
               BAT_VERSION_MAJOR, BAT_VERSION_MINOR, BAT_VERSION_PATCH);
    step_plain(step, "FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }'));\nENDSEC;\n"
                     "DATA;\n");
}

/// Write the product whose shape is the surface.
static bat_status write_product(step_text *step, step_entities *entities, bat_error *error)
{
    uint32_t application = step_begin(step, "APPLICATION_CONTEXT('managed model based 3d engineering');\n");
    (void)step_begin(step, "APPLICATION_PROTOCOL_DEFINITION('international standard',");
    step_plain(step, "'ap242_managed_model_based_3d_engineering',2014,#%u);\n", application);
    uint32_t context = step_begin(step, "PRODUCT_CONTEXT('',");
    step_plain(step, "#%u,'mechanical');\n", application);
    uint32_t product = step_begin(step, "PRODUCT('surface','surface','',");
    step_plain(step, "(#%u));\n", context);
    (void)step_begin(step, "PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,");
    step_plain(step, "(#%u));\n", product);
    uint32_t formation = step_begin(step, "PRODUCT_DEFINITION_FORMATION('','',");
    step_plain(step, "#%u);\n", product);
    uint32_t design = step_begin(step, "PRODUCT_DEFINITION_CONTEXT('part definition',");
    step_plain(step, "#%u,'design');\n", application);
    uint32_t definition = step_begin(step, "PRODUCT_DEFINITION('design','',");
    step_plain(step, "#%u,#%u);\n", formation, design);
    entities->definition_shape = step_begin(step, "PRODUCT_DEFINITION_SHAPE('','',");
    step_plain(step, "#%u)", definition);
    return step_end(step, "", error);
}

/// Write the unit of length. Returns its number.
static uint32_t write_length_unit(step_text *step, bat_surface_unit unit)
{
    uint32_t metric =
        step_begin(step, unit == BAT_SURFACE_UNIT_METRE ? "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n"
                                                        : "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n");
    if (unit != BAT_SURFACE_UNIT_INCH)
        return metric;
    uint32_t measure = step_begin(step, "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),");
    step_plain(step, "#%u);\n", metric);
    uint32_t dimension = step_begin(step, "DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n");
    uint32_t inch = step_begin(step, "(CONVERSION_BASED_UNIT('INCH',");
    step_plain(step, "#%u)LENGTH_UNIT()NAMED_UNIT(#%u));\n", measure, dimension);
    return inch;
}

/// Write the units, the tolerance, and the placement at the origin.
static bat_status write_context(step_text *step, bat_surface_unit unit, double tolerance, step_entities *entities,
                                bat_error *error)
{
    static const double origin[3] = {0, 0, 0};
    uint32_t length = write_length_unit(step, unit);
    uint32_t angle = step_begin(step, "(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n");
    uint32_t solid = step_begin(step, "(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n");
    uint32_t uncertainty = step_begin(step, "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(");
    step_real(step, tolerance);
    step_plain(step, "),#%u,'distance_accuracy_value','points closer than this are one');\n", length);
    entities->context = step_begin(step, "(GEOMETRIC_REPRESENTATION_CONTEXT(3)");
    step_plain(step,
               "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#%u))GLOBAL_UNIT_ASSIGNED_CONTEXT((#%u,#%u,#%u))"
               "REPRESENTATION_CONTEXT('','3D'));\n",
               uncertainty, length, angle, solid);
    uint32_t place = step_point(step, origin, 3);
    uint32_t axis = step_begin(step, "DIRECTION('',(0.,0.,1.));\n");
    uint32_t across = step_begin(step, "DIRECTION('',(1.,0.,0.));\n");
    entities->placement = step_begin(step, "AXIS2_PLACEMENT_3D('',");
    step_plain(step, "#%u,#%u,#%u)", place, axis, across);
    return step_end(step, "", error);
}

/// Write the points of a spline. Returns the number of the first.
static uint32_t write_points(step_text *step, const double *points, size_t count, size_t dimension)
{
    for (size_t i = 0; i < count; i++)
        (void)step_point(step, points + dimension * i, dimension);
    return step->count - (uint32_t)count + 1;
}

/// The multiplicity of the knot at index `at`.
static size_t multiplicity(const bat_knot_vector *knots, size_t at)
{
    size_t count = 1;
    while (at + count < knots->count && knots->knots[at + count] == knots->knots[at])
        count++;
    return count;
}

static void write_multiplicities(step_text *step, const bat_knot_vector *knots)
{
    step_list_begin(step);
    for (size_t i = 0; i < knots->count; i += multiplicity(knots, i))
        step_list_whole(step, multiplicity(knots, i));
    step_list_end(step);
    step_plain(step, ",");
}

static void write_knots(step_text *step, const bat_knot_vector *knots)
{
    step_list_begin(step);
    for (size_t i = 0; i < knots->count; i += multiplicity(knots, i))
        step_list_real(step, knots->knots[i]);
    step_list_end(step);
    step_plain(step, ",");
}

static uint32_t write_curve(step_text *step, const bat_knot_vector *knots, const double *control, size_t dimension)
{
    size_t count = knot_vector_functions(knots);
    uint32_t first = write_points(step, control, count, dimension);
    uint32_t curve = step_begin(step, "B_SPLINE_CURVE_WITH_KNOTS('',");
    step_plain(step, "%d,", knots->degree);
    step_list_begin(step);
    for (size_t i = 0; i < count; i++)
        step_list_reference(step, first + (uint32_t)i);
    step_list_end(step);
    step_plain(step, ",.UNSPECIFIED.,.F.,.F.,");
    write_multiplicities(step, knots);
    write_knots(step, knots);
    step_plain(step, ".UNSPECIFIED.);\n");
    return curve;
}

static bat_status write_vertices(step_text *step, const step_model *model, step_entities *entities, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t v = 0; v < model->shell.vertex_count && status == BAT_OK; v++)
    {
        if (model->same[v] != v)
            continue;
        uint32_t point = step_point(step, model->points + 3 * v, 3);
        entities->vertices[v] = step_begin(step, "VERTEX_POINT('',");
        step_plain(step, "#%u)", point);
        status = step_end(step, "", error);
    }
    return status;
}

static bat_status write_edges(step_text *step, const step_model *model, step_entities *entities, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t e = 0; e < model->shell.edge_count && status == BAT_OK; e++)
    {
        if (model->collapsed[e])
            continue;
        const shell_edge *edge = &model->shell.edges[e];
        uint32_t curve = write_curve(step, &model->knots[e], model->control[e], 3);
        entities->edges[e] = step_begin(step, "EDGE_CURVE('',");
        step_plain(step, "#%u,#%u,#%u,.T.)", entities->vertices[model->same[edge->from]],
                   entities->vertices[model->same[edge->to]], curve);
        status = step_end(step, "", error);
    }
    return status;
}

/// Write the surface of a face. STEP lists points with v varying fastest.
static uint32_t write_surface(step_text *step, const tensor_surface *patch)
{
    size_t columns = knot_vector_functions(&patch->knots[0]), rows = knot_vector_functions(&patch->knots[1]);
    uint32_t first = write_points(step, patch->control, columns * rows, 3);
    uint32_t surface = step_begin(step, "B_SPLINE_SURFACE_WITH_KNOTS('',");
    step_plain(step, "%d,%d,(", patch->knots[0].degree, patch->knots[1].degree);
    for (size_t i = 0; i < columns; i++)
    {
        step_plain(step, i > 0 ? "," : "");
        step_list_begin(step);
        for (size_t j = 0; j < rows; j++)
            step_list_reference(step, first + (uint32_t)(j * columns + i));
        step_list_end(step);
    }
    step_plain(step, "),.UNSPECIFIED.,.F.,.F.,.F.,");
    write_multiplicities(step, &patch->knots[0]);
    write_multiplicities(step, &patch->knots[1]);
    write_knots(step, &patch->knots[0]);
    write_knots(step, &patch->knots[1]);
    step_plain(step, ".UNSPECIFIED.);\n");
    return surface;
}

/// Write the loop of a face. Returns 0 when all of its edges are collapsed.
static uint32_t write_loop(step_text *step, const step_model *model, const step_entities *entities, size_t face)
{
    const surface_shell *shell = &model->shell;
    uint32_t first = step->count + 1;
    for (size_t i = shell->loops[face]; i < shell->loops[face + 1]; i++)
    {
        const shell_use *use = &shell->uses[i];
        if (model->collapsed[use->edge])
            continue;
        (void)step_begin(step, "ORIENTED_EDGE('',*,*,");
        step_plain(step, "#%u,%s);\n", entities->edges[use->edge], use->backward ? ".F." : ".T.");
    }
    uint32_t last = step->count;
    if (last < first)
        return 0;
    uint32_t loop = step_begin(step, "EDGE_LOOP('',");
    step_list_begin(step);
    for (uint32_t edge = first; edge <= last; edge++)
        step_list_reference(step, edge);
    step_list_end(step);
    step_plain(step, ");\n");
    return loop;
}

static bat_status write_faces(step_text *step, const step_model *model, step_entities *entities, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t f = 0; f < model->shell.face_count && status == BAT_OK; f++)
    {
        uint32_t loop = write_loop(step, model, entities, f);
        if (loop == 0)
            continue;
        uint32_t bound = step_begin(step, "FACE_OUTER_BOUND('',");
        step_plain(step, "#%u,.T.);\n", loop);
        uint32_t surface = write_surface(step, &model->patches[f]);
        entities->faces[entities->face_count++] = step_begin(step, "ADVANCED_FACE('',");
        step_plain(step, "(#%u),#%u,.T.)", bound, surface);
        status = step_end(step, "", error);
    }
    return status;
}

static void write_shell(step_text *step, const step_entities *entities)
{
    uint32_t shell = step_begin(step, "OPEN_SHELL('',");
    step_list_begin(step);
    for (size_t f = 0; f < entities->face_count; f++)
        step_list_reference(step, entities->faces[f]);
    step_list_end(step);
    step_plain(step, ");\n");
    uint32_t model = step_begin(step, "SHELL_BASED_SURFACE_MODEL('',");
    step_plain(step, "(#%u));\n", shell);
    uint32_t shape = step_begin(step, "MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',");
    step_plain(step, "(#%u,#%u),#%u);\n", entities->placement, model, entities->context);
    (void)step_begin(step, "SHAPE_DEFINITION_REPRESENTATION(");
    step_plain(step, "#%u,#%u);\nENDSEC;\nEND-ISO-10303-21;\n", entities->definition_shape, shape);
}

static bat_status make_entities(const step_model *model, step_entities *entities, bat_error *error)
{
    const surface_shell *shell = &model->shell;
    *entities = (step_entities){.vertices = memory_array(shell->vertex_count, sizeof(uint32_t)),
                                .edges = memory_array(shell->edge_count, sizeof(uint32_t)),
                                .faces = memory_array(shell->face_count, sizeof(uint32_t))};
    if (entities->vertices == NULL || entities->edges == NULL || entities->faces == NULL)
        return error_memory(error, (shell->vertex_count + shell->edge_count + shell->face_count) * sizeof(uint32_t));
    return BAT_OK;
}

/// Check that 32 bits can number the entities.
static bat_status check_count(const step_model *model, bat_error *error)
{
    double count = 0;
    for (size_t f = 0; f < model->shell.face_count; f++)
    {
        const tensor_surface *patch = &model->patches[f];
        count += 4 + (double)knot_vector_functions(&patch->knots[0]) * (double)knot_vector_functions(&patch->knots[1]);
    }
    for (size_t e = 0; e < model->shell.edge_count; e++)
        count += 6 + (double)knot_vector_functions(&model->knots[e]);
    count += 2 * (double)model->shell.vertex_count;
    if (count < (double)(UINT32_MAX / 2))
        return BAT_OK;
    return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "a STEP file of %.0f entities is too large", count);
}

// Trimmed surfaces

/// Write a trimming curve in the parameters of a surface. Returns the number of the PCURVE.
static uint32_t write_parameter_curve(step_text *step, const bat_spline_curve *piece, uint32_t surface, uint32_t planar)
{
    uint32_t curve = write_curve(step, &piece->knots, piece->control, 2);
    uint32_t definition = step_begin(step, "DEFINITIONAL_REPRESENTATION('',");
    step_plain(step, "(#%u),#%u);\n", curve, planar);
    uint32_t parameter_curve = step_begin(step, "PCURVE('',");
    step_plain(step, "#%u,#%u);\n", surface, definition);
    return parameter_curve;
}

/// Write the edges of a loop and the bound of the face. Returns the number of the bound.
static uint32_t write_trimming_loop(step_text *step, const trimmed_model *model, size_t loop, uint32_t surface,
                                    uint32_t planar, uint32_t *vertices, uint32_t *edges)
{
    size_t begin = model->trim->loops[loop], count = model->trim->loops[loop + 1] - begin;
    for (size_t i = 0; i < count; i++)
    {
        uint32_t point = step_point(step, model->images[begin + i].control, 3);
        vertices[i] = step_begin(step, "VERTEX_POINT('',");
        step_plain(step, "#%u);\n", point);
    }
    for (size_t i = 0; i < count; i++)
    {
        const bat_spline_curve *image = &model->images[begin + i];
        uint32_t space = write_curve(step, &image->knots, image->control, 3);
        uint32_t flat = write_parameter_curve(step, &model->trim->pieces[begin + i], surface, planar);
        uint32_t both = step_begin(step, "SURFACE_CURVE('',");
        step_plain(step, "#%u,(#%u),.CURVE_3D.);\n", space, flat);
        uint32_t edge = step_begin(step, "EDGE_CURVE('',");
        step_plain(step, "#%u,#%u,#%u,.T.);\n", vertices[i], vertices[(i + 1) % count], both);
        edges[i] = step_begin(step, "ORIENTED_EDGE('',*,*,");
        step_plain(step, "#%u,.T.);\n", edge);
    }
    uint32_t path = step_begin(step, "EDGE_LOOP('',");
    step_list_begin(step);
    for (size_t i = 0; i < count; i++)
        step_list_reference(step, edges[i]);
    step_list_end(step);
    step_plain(step, ");\n");
    uint32_t bound = step_begin(step, loop == 0 ? "FACE_OUTER_BOUND(''," : "FACE_BOUND('',");
    step_plain(step, "#%u,.T.);\n", path);
    return bound;
}

/// Write the face of a trimmed surface.
static bat_status write_trimmed_face(step_text *step, const trimmed_model *model, uint32_t *face, bat_error *error)
{
    size_t loops = model->trim->loop_count;
    uint32_t *vertices = memory_array(model->piece_count, sizeof *vertices);
    uint32_t *edges = memory_array(model->piece_count, sizeof *edges);
    uint32_t *bounds = memory_array(loops, sizeof *bounds);
    bat_status status = BAT_OK;
    if (vertices == NULL || edges == NULL || bounds == NULL)
        status = error_memory(error, model->piece_count * 2 * sizeof *edges);
    if (status == BAT_OK)
    {
        uint32_t surface = write_surface(step, &model->surface);
        uint32_t planar = step_begin(step, "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()"
                                           "REPRESENTATION_CONTEXT('','2D'));\n");
        for (size_t l = 0; l < loops; l++)
            bounds[l] = write_trimming_loop(step, model, l, surface, planar, vertices, edges);
        *face = step_begin(step, "ADVANCED_FACE('',");
        step_list_begin(step);
        for (size_t l = 0; l < loops; l++)
            step_list_reference(step, bounds[l]);
        step_list_end(step);
        step_plain(step, ",#%u,.T.)", surface);
        status = step_end(step, "", error);
    }
    free(vertices);
    free(edges);
    free(bounds);
    return status;
}

static bat_status write_trimmed(const bat_spline_surface *surface, bat_surface_unit unit, text_sink *sink, bat_error *error)
{
    trimmed_model model = {0};
    uint32_t face = 0;
    step_entities entities = {.faces = &face, .face_count = 1};
    step_text step = {.sink = sink};
    bat_status status = trimmed_model_make(surface, &model, error);
    write_header(&step);
    if (status == BAT_OK)
        status = write_product(&step, &entities, error);
    if (status == BAT_OK)
        status = write_context(&step, unit, model.tolerance, &entities, error);
    if (status == BAT_OK)
        status = write_trimmed_face(&step, &model, &face, error);
    if (status == BAT_OK)
        write_shell(&step, &entities);
    trimmed_model_free(&model);
    return step_finish(&step, status, error);
}

bat_status surface_step_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                              bat_error *error)
{
    if (surface->trim.loop_count > 0)
        return write_trimmed(surface, options->unit, sink, error);
    step_model model = {0};
    step_entities entities = {0};
    step_text step = {.sink = sink};
    bat_status status = step_model_make(surface, &model, error);
    if (status == BAT_OK)
        status = check_count(&model, error);
    if (status == BAT_OK)
        status = make_entities(&model, &entities, error);
    write_header(&step);
    if (status == BAT_OK)
        status = write_product(&step, &entities, error);
    if (status == BAT_OK)
        status = write_context(&step, options->unit, model.tolerance, &entities, error);
    if (status == BAT_OK)
        status = write_vertices(&step, &model, &entities, error);
    if (status == BAT_OK)
        status = write_edges(&step, &model, &entities, error);
    if (status == BAT_OK)
        status = write_faces(&step, &model, &entities, error);
    if (status == BAT_OK)
        write_shell(&step, &entities);
    free(entities.vertices);
    free(entities.edges);
    free(entities.faces);
    step_model_free(&model);
    return step_finish(&step, status, error);
}
