#include "mesh_files.h"

#include "report.h"

#include <stdio.h>

const option_spec MESH_FILE_OPTIONS[] = {
    {"triangulate", NULL, INPUT, COMMON, "cut polygons of IN into triangles", FLAG(mesh_files, read.triangulate)},
    {"repair", NULL, INPUT, COMMON, "split edges of more than two faces and vertices of several fans first",
     FLAG(mesh_files, read.repair)},
    {"from", "FORMAT", INPUT, 0, "the format of IN, see `batten list formats`; default: by content and ending",
     CHOICE(mesh_files, read.format, bat_mesh_format_family)},
    {"normals", NULL, RESULT, 0,
     "write vertex normals (OBJ, PLY, glTF), with `batten mesh --limit` those of the limit surface",
     FLAG(mesh_files, normals)},
    {"to", "FORMAT", RESULT, 0, "the format of OUT; default: by its ending",
     CHOICE(mesh_files, write.format, bat_mesh_format_family)},
    END_OF_OPTIONS,
};

void mesh_files_begin(mesh_files *files)
{
    files->read = bat_mesh_read_defaults();
    files->write = bat_mesh_write_defaults();
    files->read.repairs = &files->repairs;
    files->read.notes = files->write.notes = &files->notes;
}

bool mesh_files_check(mesh_files *files, const verb_call *call)
{
    files->write.threads = call->threads;
    files->write.normals = files->normals ? BAT_MESH_NORMALS_ANGLE : BAT_MESH_NORMALS_NONE;
    return argument_ending(call->given, &bat_mesh_format_family, (int)files->write.format);
}

void mesh_files_report(const mesh_files *files, const verb_call *call)
{
    if (!call->silent)
        report_notes(&files->notes, is_standard_output(call->output) ? stderr : stdout);
    if (!call->quiet && files->read.repair)
        (void)printf("%zu places repaired\n", bat_mesh_repair_places(&files->repairs));
}
