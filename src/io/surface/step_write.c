#include "io/surface/formats.h"
#include "io/surface/step.h"

#include "linalg/vector.h"

#include <stdarg.h>

/// @file
/// A spline surface as an open shell of B-spline faces, in the schema AP242 of ISO 10303: the clear-text encoding of ISO
/// 10303-21 with numbered entities.

enum
{
    LONG_LINE = 100,
    FULL_TEXT = 1 << 16
};

/// A STEP file during writing. All zero except for `sink` and `error`: no entities yet.
typedef struct step_text
{
    text_sink *sink;
    bat_error *error;
    bat_status status; ///< of the sink
    text_buffer text;  ///< text that is not in the sink yet
    size_t line;       ///< the start of its last line
    uint32_t count;    ///< the number of entities, which is the number of the last one
    bool separate;     ///< the next item of a list needs a comma before it
} step_text;

static void write_out(step_text *step)
{
    if (step->status == BAT_OK)
        step->status = sink_write(step->sink, &step->text, step->error);
    step->text.size = 0;
}

/// Begin an entity: `#number=text`. Returns its number.
static uint32_t begin_entity(step_text *step, const char *text)
{
    step->line = step->text.size;
    text_append_format(&step->text, "#%u=%s", (unsigned)++step->count, text);
    return step->count;
}

/// End an entity: `text;`. Passes the text to the sink when there is enough.
static void end_entity(step_text *step, const char *text)
{
    text_append_format(&step->text, "%s;\n", text);
    if (step->text.failed || step->text.size >= FULL_TEXT)
        write_out(step);
}

/// Write an entity without lists of unknown length. Returns its number.
__attribute__((format(printf, 2, 3))) static uint32_t write_entity(step_text *step, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    uint32_t entity = begin_entity(step, text);
    end_entity(step, "");
    return entity;
}

/// Append a real number; STEP requires a decimal point.
static void append_real(step_text *step, double value)
{
    char *out = text_reserve(&step->text, NUMBER_TEXT_SIZE + 1);
    if (out != NULL)
        text_advance(&step->text, model_real(out, value, 'E'));
}

// Lists: `(`, items separated by commas, `)`. Long lines are broken.

static void begin_list(step_text *step)
{
    text_append_string(&step->text, "(");
    step->separate = false;
}

static void begin_item(step_text *step)
{
    if (step->separate)
        text_append_string(&step->text, ",");
    step->separate = true;
    if (step->text.size - step->line < LONG_LINE)
        return;
    text_append_string(&step->text, "\n");
    step->line = step->text.size;
}

static void end_list(step_text *step)
{
    text_append_string(&step->text, ")");
    step->separate = true;
}

static void append_reference(step_text *step, uint32_t entity)
{
    begin_item(step);
    text_append_format(&step->text, "#%u", (unsigned)entity);
}

static void append_references(step_text *step, const uint32_t *entities, size_t count)
{
    begin_list(step);
    for (size_t i = 0; i < count; i++)
        append_reference(step, entities[i]);
    end_list(step);
}

/// Write an entity of a list of others. Returns its number.
static uint32_t write_list(step_text *step, const char *text, const uint32_t *entities, size_t count)
{
    uint32_t entity = begin_entity(step, text);
    append_references(step, entities, count);
    end_entity(step, ")");
    return entity;
}

/// Append a list of entities whose numbers are `stride` apart.
static void append_range(step_text *step, uint32_t first, size_t count, size_t stride)
{
    begin_list(step);
    for (size_t i = 0; i < count; i++)
        append_reference(step, first + (uint32_t)(i * stride));
    end_list(step);
}

// Entities

/// Numbers of entities to which others refer.
typedef struct step_entities
{
    memory_pool pool;
    uint32_t definition_shape, context, placement;
    uint32_t *vertices, *edges, *faces;
    size_t face_count;
} step_entities;

/// Write an entity of 2 or 3 numbers. Returns its number.
static uint32_t write_numbers(step_text *step, const char *text, const double *numbers, size_t count)
{
    uint32_t entity = begin_entity(step, text);
    begin_list(step);
    for (size_t c = 0; c < count; c++)
    {
        begin_item(step);
        append_real(step, numbers[c]);
    }
    end_list(step);
    end_entity(step, ")");
    return entity;
}

static uint32_t write_point(step_text *step, const double *point, size_t dimension)
{
    return write_numbers(step, "CARTESIAN_POINT('',", point, dimension);
}

/// Write a placement with its last and its first axis. Returns its number.
static uint32_t write_placement(step_text *step, const double place[3], const double axis[3], const double across[3])
{
    uint32_t point = write_point(step, place, 3), last = write_numbers(step, "DIRECTION('',", axis, 3);
    uint32_t first = write_numbers(step, "DIRECTION('',", across, 3);
    return write_entity(step, "AXIS2_PLACEMENT_3D('',#%u,#%u,#%u)", point, last, first);
}

static void write_header(step_text *step)
{
    text_append_format(&step->text,
                       "ISO-10303-21;\nHEADER;\n"
                       "FILE_DESCRIPTION(('spline surface as an open shell'),'2;1');\n"
                       "FILE_NAME('surface','1970-01-01T00:00:00',(''),(''),'batten %d.%d.%d','batten','');\n",
                       BAT_VERSION_MAJOR, BAT_VERSION_MINOR, BAT_VERSION_PATCH);
    text_append_format(&step->text,
                       "FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }'));\nENDSEC;\n"
                       "DATA;\n");
}

static void write_product(step_text *step, step_entities *entities)
{
    uint32_t application = write_entity(step, "APPLICATION_CONTEXT('managed model based 3d engineering')");
    (void)write_entity(step,
                       "APPLICATION_PROTOCOL_DEFINITION('international standard',"
                       "'ap242_managed_model_based_3d_engineering',2014,#%u)",
                       application);
    uint32_t context = write_entity(step, "PRODUCT_CONTEXT('',#%u,'mechanical')", application);
    uint32_t product = write_entity(step, "PRODUCT('surface','surface','',(#%u))", context);
    (void)write_entity(step, "PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#%u))", product);
    uint32_t formation = write_entity(step, "PRODUCT_DEFINITION_FORMATION('','',#%u)", product);
    uint32_t design = write_entity(step, "PRODUCT_DEFINITION_CONTEXT('part definition',#%u,'design')", application);
    uint32_t definition = write_entity(step, "PRODUCT_DEFINITION('design','',#%u,#%u)", formation, design);
    entities->definition_shape = write_entity(step, "PRODUCT_DEFINITION_SHAPE('','',#%u)", definition);
}

static uint32_t write_length_unit(step_text *step, bat_surface_unit unit)
{
    uint32_t metric = write_entity(step, "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(%s,.METRE.))",
                                   unit == BAT_SURFACE_UNIT_METRE ? "$" : ".MILLI.");
    if (unit != BAT_SURFACE_UNIT_INCH)
        return metric;
    uint32_t measure = write_entity(step, "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#%u)", metric);
    uint32_t dimension = write_entity(step, "DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)");
    return write_entity(step, "(CONVERSION_BASED_UNIT('INCH',#%u)LENGTH_UNIT()NAMED_UNIT(#%u))", measure, dimension);
}

/// Write the units, the tolerance, and the placement at the origin.
static void write_context(step_text *step, bat_surface_unit unit, double tolerance, step_entities *entities)
{
    static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1}, across[3] = {1, 0, 0};
    uint32_t length = write_length_unit(step, unit);
    uint32_t angle = write_entity(step, "(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    uint32_t solid = write_entity(step, "(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    uint32_t uncertainty = begin_entity(step, "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(");
    append_real(step, tolerance);
    text_append_format(&step->text, "),#%u,'distance_accuracy_value','points closer than this are one'", length);
    end_entity(step, ")");
    entities->context = write_entity(step,
                                     "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#%u))"
                                     "GLOBAL_UNIT_ASSIGNED_CONTEXT((#%u,#%u,#%u))REPRESENTATION_CONTEXT('','3D'))",
                                     uncertainty, length, angle, solid);
    entities->placement = write_placement(step, origin, up, across);
}

/// Write the points of a spline. Returns the number of the first.
static uint32_t write_points(step_text *step, const double *points, size_t count, size_t dimension)
{
    for (size_t i = 0; i < count; i++)
        (void)write_point(step, points + dimension * i, dimension);
    return step->count - (uint32_t)count + 1;
}

static size_t multiplicity(const bat_knot_vector *knots, size_t at)
{
    size_t count = 1;
    while (at + count < knots->count && knots->knots[at + count] == knots->knots[at])
        count++;
    return count;
}

/// Append the list of the different knots, or of their multiplicities.
static void append_knots(step_text *step, const bat_knot_vector *knots, bool multiplicities)
{
    begin_list(step);
    for (size_t i = 0; i < knots->count; i += multiplicity(knots, i))
    {
        begin_item(step);
        if (multiplicities)
            text_append_format(&step->text, "%zu", multiplicity(knots, i));
        else
            append_real(step, knots->knots[i]);
    }
    end_list(step);
    text_append_string(&step->text, ",");
}

static uint32_t write_curve(step_text *step, const bat_knot_vector *knots, const double *control, size_t dimension)
{
    size_t count = knot_vector_functions(knots);
    uint32_t first = write_points(step, control, count, dimension);
    uint32_t curve = begin_entity(step, "B_SPLINE_CURVE_WITH_KNOTS('',");
    text_append_format(&step->text, "%d,", knots->degree);
    append_range(step, first, count, 1);
    text_append_format(&step->text, ",.UNSPECIFIED.,.F.,.F.,");
    append_knots(step, knots, true);
    append_knots(step, knots, false);
    end_entity(step, ".UNSPECIFIED.)");
    return curve;
}

/// Write the surface of a face. STEP lists points with v varying fastest.
static uint32_t write_surface(step_text *step, const tensor_surface *patch)
{
    size_t columns = knot_vector_functions(&patch->knots[0]), rows = knot_vector_functions(&patch->knots[1]);
    uint32_t first = write_points(step, patch->control, columns * rows, 3);
    uint32_t surface = begin_entity(step, "B_SPLINE_SURFACE_WITH_KNOTS('',");
    text_append_format(&step->text, "%d,%d,(", patch->knots[0].degree, patch->knots[1].degree);
    for (size_t i = 0; i < columns; i++)
    {
        text_append_string(&step->text, i > 0 ? "," : "");
        append_range(step, first + (uint32_t)i, rows, columns);
    }
    text_append_format(&step->text, "),.UNSPECIFIED.,.F.,.F.,.F.,");
    for (int k = 0; k < 4; k++)
        append_knots(step, &patch->knots[k % 2], k < 2);
    end_entity(step, ".UNSPECIFIED.)");
    return surface;
}

static void write_edges(step_text *step, const step_model *model, step_entities *entities)
{
    for (size_t e = 0; e < model->shell.edge_count; e++)
    {
        if (model->collapsed[e])
            continue;
        const shell_edge *edge = &model->shell.edges[e];
        uint32_t curve = write_curve(step, &model->knots[e], model->control[e], 3);
        entities->edges[e] =
            write_entity(step, "EDGE_CURVE('',#%u,#%u,#%u,.T.)", entities->vertices[model->same[edge->from]],
                         entities->vertices[model->same[edge->to]], curve);
    }
}

/// Write the loop of a face. Returns 0 when all of its edges are collapsed.
static uint32_t write_loop(step_text *step, const step_model *model, const step_entities *entities, size_t face)
{
    const surface_shell *shell = &model->shell;
    uint32_t first = step->count + 1;
    for (size_t i = shell->loops[face]; i < shell->loops[face + 1]; i++)
    {
        const shell_use *use = &shell->uses[i];
        if (!model->collapsed[use->edge])
            (void)write_entity(step, "ORIENTED_EDGE('',*,*,#%u,%s)", entities->edges[use->edge],
                               use->backward ? ".F." : ".T.");
    }
    uint32_t end = step->count + 1;
    if (end == first)
        return 0;
    uint32_t loop = begin_entity(step, "EDGE_LOOP('',");
    append_range(step, first, end - first, 1);
    end_entity(step, ")");
    return loop;
}

static void write_faces(step_text *step, const step_model *model, step_entities *entities)
{
    for (size_t f = 0; f < model->shell.face_count; f++)
    {
        uint32_t loop = write_loop(step, model, entities, f);
        if (loop == 0)
            continue;
        uint32_t bound = write_entity(step, "FACE_OUTER_BOUND('',#%u,.T.)", loop);
        uint32_t surface = write_surface(step, &model->patches[f]);
        entities->faces[entities->face_count++] = write_entity(step, "ADVANCED_FACE('',(#%u),#%u,.T.)", bound, surface);
    }
}

static const char OPEN_SHELL[] = "OPEN_SHELL('',", SURFACE_SHAPE[] = "MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',";

static void write_end(step_text *step, const step_entities *entities, const char *kind, const uint32_t *parts, size_t count)
{
    uint32_t shape = begin_entity(step, kind);
    begin_list(step);
    append_reference(step, entities->placement);
    for (size_t i = 0; i < count; i++)
        append_reference(step, parts[i]);
    end_list(step);
    text_append_format(&step->text, ",#%u", entities->context);
    end_entity(step, ")");
    (void)write_entity(step, "SHAPE_DEFINITION_REPRESENTATION(#%u,#%u)", entities->definition_shape, shape);
    text_append_format(&step->text, "ENDSEC;\nEND-ISO-10303-21;\n");
    write_out(step);
}

/// Write the parts of a model with several. Shells of voids, whose normals lead into them, belong to the solids around them.
static bat_status write_parts(step_text *step, const step_model *model, const step_entities *entities, bat_error *error)
{
    memory_pool pool = {0};
    uint32_t *faces = memory_pool_array(&pool, entities->face_count, sizeof *faces);
    uint32_t *shells = memory_pool_array(&pool, model->piece_count, 3 * sizeof *shells);
    uint32_t *voids = shells + model->piece_count, *parts = voids + model->piece_count;
    size_t closed = 0, made = 0;
    bat_status status = memory_pool_check(&pool, error);
    for (size_t p = 0; p < model->piece_count && status == BAT_OK; p++)
    {
        size_t count = 0;
        for (size_t f = 0; f < entities->face_count; f++)
            if (model->pieces[f] == p)
                faces[count++] = entities->faces[f];
        shells[p] = write_list(step, model->closed[p] ? "CLOSED_SHELL(''," : OPEN_SHELL, faces, count);
    }
    for (size_t p = 0; p < model->piece_count && status == BAT_OK; p++)
    {
        size_t count = 0;
        for (size_t q = 0; q < model->piece_count; q++)
            if (q != p && model->around[q] == p)
                voids[count++] = write_entity(step, "ORIENTED_CLOSED_SHELL('',*,#%u,.T.)", shells[q]);
        if (model->around[p] != p)
            continue;
        closed += model->closed[p];
        parts[made++] = begin_entity(step, count > 0          ? "BREP_WITH_VOIDS('',"
                                           : model->closed[p] ? "MANIFOLD_SOLID_BREP('',"
                                                              : "SHELL_BASED_SURFACE_MODEL('',(");
        step->separate = false;
        append_reference(step, shells[p]);
        if (count > 0)
            text_append_string(&step->text, ",");
        if (count > 0)
            append_references(step, voids, count);
        end_entity(step, model->closed[p] ? ")" : "))");
    }
    if (status == BAT_OK)
        write_end(step, entities,
                  closed == made ? "ADVANCED_BREP_SHAPE_REPRESENTATION('',"
                  : closed == 0  ? SURFACE_SHAPE
                                 : "SHAPE_REPRESENTATION('',",
                  parts, made);
    memory_pool_free(&pool);
    return status;
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
    return ERROR_TOO_LARGE(error, "a STEP file of %.0f entities is too large", count);
}

// Trimmed surfaces

/// Whether an edge begins at a cubic of an image: at the first and where the trimming curve may have a corner, across which
/// other programs do not integrate. Each cubic ends at every third control point.
static bool begins_edge(const bat_spline_curve *piece, const bat_spline_curve *image, size_t cubic)
{
    double t = image->knots.knots[3 * cubic + 1];
    size_t span = knot_vector_span(&piece->knots, t);
    return piece->knots.knots[span] == t && piece->knots.knots[span + 1 - (size_t)piece->knots.degree] == t;
}

/// Write the surface of a simple shape.
static uint32_t write_shape(step_text *step, const shape_model *model)
{
    const bat_surface_primitive *shape = &model->shape;
    double place[3], height = shape->kind == BAT_SURFACE_PRIMITIVE_CONE ? model->height : 0;
    for (int c = 0; c < 3; c++)
        place[c] = shape->place[c] + height * model->axes[2][c];
    uint32_t at = write_placement(step, place, model->axes[2], model->axes[0]);
    if (shape->kind == BAT_SURFACE_PRIMITIVE_PLANE)
        return write_entity(step, "PLANE('',#%u)", at);
    if (shape->kind == BAT_SURFACE_PRIMITIVE_CONE)
        return write_entity(step, "CONICAL_SURFACE('',#%u,%#.17G,%#.17G)", at, height * tan(shape->angle), shape->angle);
    return write_entity(step, "%s_SURFACE('',#%u,%#.17G)",
                        shape->kind == BAT_SURFACE_PRIMITIVE_SPHERE ? "SPHERICAL" : "CYLINDRICAL", at, shape->radius);
}

/// Write the curve in space of an edge.
static uint32_t write_edge(step_text *step, const bat_spline_curve *image, const shape_curve *curve)
{
    double across[3];
    if (curve->kind == SHAPE_SPLINE)
        return write_curve(step, &image->knots, image->control, 3);
    vector3_subtract(image->control, curve->place, across);
    (void)vector3_normalize(across);
    if (curve->kind == SHAPE_CIRCLE)
        return write_entity(step, "CIRCLE('',#%u,%#.17G)", write_placement(step, curve->place, curve->axis, across),
                            curve->radius);
    uint32_t point = write_point(step, image->control, 3), along = write_numbers(step, "DIRECTION('',", across, 3);
    return write_entity(step, "LINE('',#%u,#%u)", point, write_entity(step, "VECTOR('',#%u,1.)", along));
}

/// Write the edges of a loop and the bound of the face. Edges of one image share its curves. Returns the number of the
/// bound.
static uint32_t write_trimming_loop(step_text *step, const trimmed_model *model, size_t loop, uint32_t surface,
                                    uint32_t planar, const step_entities *entities)
{
    size_t count = 0;
    uint32_t *vertices = entities->vertices, *edges = entities->edges;
    for (size_t i = model->trim->loops[loop]; i < model->trim->loops[loop + 1]; i++)
    {
        const bat_spline_curve *image = &model->images[i], *piece = &model->trim->pieces[i];
        bool whole = model->curves[i].kind != SHAPE_SPLINE;
        uint32_t both = write_edge(step, image, &model->curves[i]);
        if (model->shape.shape.kind == BAT_SURFACE_PRIMITIVE_NONE)
        {
            uint32_t curve = write_curve(step, &piece->knots, piece->control, 2);
            uint32_t definition = write_entity(step, "DEFINITIONAL_REPRESENTATION('',(#%u),#%u)", curve, planar);
            uint32_t flat = write_entity(step, "PCURVE('',#%u,#%u)", surface, definition);
            both = write_entity(step, "SURFACE_CURVE('',#%u,(#%u),.CURVE_3D.)", both, flat);
        }
        for (size_t k = 0; 3 * k + 1 < knot_vector_functions(&image->knots); k++)
            if (whole ? k == 0 : begins_edge(piece, image, k))
            {
                uint32_t point = write_point(step, image->control + 9 * k, 3);
                vertices[count] = write_entity(step, "VERTEX_POINT('',#%u)", point);
                edges[count++] = both;
            }
    }
    for (size_t i = 0; i < count; i++)
    {
        edges[i] = write_entity(step, "EDGE_CURVE('',#%u,#%u,#%u,.T.)", vertices[i], vertices[(i + 1) % count], edges[i]);
        edges[i] = write_entity(step, "ORIENTED_EDGE('',*,*,#%u,.T.)", edges[i]);
    }
    uint32_t path = write_list(step, "EDGE_LOOP('',", edges, count);
    return write_entity(step, "%s('',#%u,.T.)", loop == 0 ? "FACE_OUTER_BOUND" : "FACE_BOUND", path);
}

/// Write the face of a trimmed surface. Its bounds take the places of faces before it does.
static void write_trimmed_face(step_text *step, const trimmed_model *model, step_entities *entities)
{
    size_t loops = model->trim->loop_count;
    bool shaped = model->shape.shape.kind != BAT_SURFACE_PRIMITIVE_NONE;
    uint32_t surface = shaped ? write_shape(step, &model->shape) : write_surface(step, &model->surface);
    uint32_t planar = shaped ? 0
                             : write_entity(step, "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()"
                                                  "REPRESENTATION_CONTEXT('','2D'))");
    for (size_t l = 0; l < loops; l++)
        entities->faces[l] = write_trimming_loop(step, model, l, surface, planar, entities);
    uint32_t face = begin_entity(step, "ADVANCED_FACE('',");
    append_references(step, entities->faces, loops);
    text_append_format(&step->text, ",#%u", surface);
    end_entity(step, model->shape.area < 0 ? ",.F.)" : ",.T.)");
    entities->faces[0] = face;
    entities->face_count = 1;
}

/// Write a file of patches, or of a trimmed surface where `trimmed` is not null.
static bat_status write_file(const step_model *model, const trimmed_model *trimmed, bat_surface_unit unit, text_sink *sink,
                             bat_error *error)
{
    step_entities entities = {0};
    step_text step = {.sink = sink, .error = error};
    const surface_shell *shell = &model->shell;
    size_t edges = 0; // at most, of a trimmed surface
    for (size_t i = 0; trimmed != NULL && i < trimmed->piece_count; i++)
        edges += knot_vector_functions(&trimmed->trim->pieces[i].knots);
    size_t vertices = trimmed != NULL ? edges : shell->vertex_count;
    size_t faces = trimmed != NULL ? trimmed->trim->loop_count : shell->face_count;
    edges = trimmed != NULL ? edges : shell->edge_count;
    bat_status status = check_count(model, error);
    if (status == BAT_OK)
    {
        entities.vertices = memory_pool_array(&entities.pool, vertices, sizeof *entities.vertices);
        entities.edges = memory_pool_array(&entities.pool, edges, sizeof *entities.edges);
        entities.faces = memory_pool_array(&entities.pool, faces, sizeof *entities.faces);
        status = memory_pool_check(&entities.pool, error);
    }
    if (status == BAT_OK)
    {
        write_header(&step);
        write_product(&step, &entities);
        write_context(&step, unit, trimmed != NULL ? trimmed->tolerance : model->tolerance, &entities);
        if (trimmed != NULL)
            write_trimmed_face(&step, trimmed, &entities);
        else
        {
            for (size_t v = 0; v < shell->vertex_count; v++)
                if (model->same[v] == v)
                    entities.vertices[v] =
                        write_entity(&step, "VERTEX_POINT('',#%u)", write_point(&step, model->points + 3 * v, 3));
            write_edges(&step, model, &entities);
            write_faces(&step, model, &entities);
        }
        if (model->pieces != NULL)
            status = write_parts(&step, model, &entities, error);
        else
        {
            uint32_t whole = write_list(&step, OPEN_SHELL, entities.faces, entities.face_count);
            uint32_t part = write_entity(&step, "SHELL_BASED_SURFACE_MODEL('',(#%u))", whole);
            write_end(&step, &entities, SURFACE_SHAPE, &part, 1);
        }
    }
    text_free(&step.text);
    memory_pool_free(&entities.pool);
    return status == BAT_OK ? step.status : status;
}

bat_status surface_step_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                              bat_error *error)
{
    step_model model = {0};
    trimmed_model trimmed = {0};
    bool is_trimmed = surface->trim.loop_count > 0;
    bat_status status =
        is_trimmed ? trimmed_model_make(surface, NULL, &trimmed, error) : step_model_make(surface, &model, error);
    if (status == BAT_OK)
        status = write_file(&model, is_trimmed ? &trimmed : NULL, options->unit, sink, error);
    step_model_free(&model);
    trimmed_model_free(&trimmed);
    return status;
}

bat_status surface_shape_write(const bat_spline_surface *surface, const bat_surface_primitive *shape,
                               const bat_surface_write_options *options, text_sink *sink, size_t edges[3], double *area,
                               bat_error *error)
{
    // The square's sides, for a surface without an outline.
    double knots[] = {0, 0, 1, 1}, corners[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    size_t loops[] = {0, 4};
    bat_spline_curve sides[4];
    bat_spline_surface trimmed = *surface;
    for (size_t k = 0; k < 4; k++)
        sides[k] = (bat_spline_curve){.knots = {knots, 4, 1}, .control = corners[k], .dimension = 2};
    if (trimmed.trim.loop_count == 0)
        trimmed.trim = (bat_spline_trim){sides, loops, 1};
    step_model none = {0};
    trimmed_model model = {0};
    bat_status status = trimmed_model_make(&trimmed, shape, &model, error);
    bool fits = status == BAT_OK && shape_model_end(&model);
    if (fits)
        status = write_file(&none, &model, options->unit, sink, error);
    else if (status == BAT_OK || status == BAT_TOO_LARGE)
        status = surface_step_write(surface, options, sink, error);
    *area = fits ? fabs(model.shape.area) : NAN;
    for (size_t i = 0; i < model.piece_count && fits; i++)
        edges[model.curves[i].kind]++;
    trimmed_model_free(&model);
    return status;
}

bat_status shell_step_write(const bat_shell *shell, const bat_surface_write_options *options, text_sink *sink,
                            bat_error *error)
{
    step_model model = {0};
    bat_status status = shell_model_make(shell, &model, error);
    if (status == BAT_OK)
        status = write_file(&model, NULL, options->unit, sink, error);
    step_model_free(&model);
    return status;
}
