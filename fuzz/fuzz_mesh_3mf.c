#include "fuzz_mesh_round_trip.h"

#include "io/common/zip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Bytes as a package, and as the model of a package, since few packages that a fuzzer makes have the right checksums.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char relations[] =
        "<Relationships xmlns='http://schemas.openxmlformats.org/package/2006/relationships'><Relationship Id='a' "
        "Target='a' Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel'/></Relationships>";
    text_buffer package = {0}, part = {0}, model = {0};
    text_sink sink = {.buffer = &package};
    zip_writer writer = {.sink = &sink};
    mesh_round_trip(data, size, BAT_MESH_FORMAT_3MF);
    text_append_string(&part, relations);
    text_append(&model, (const char *)data, size);
    PROMISE(zip_add(&writer, "_rels/.rels", &part, NULL) == BAT_OK && zip_add(&writer, "a", &model, NULL) == BAT_OK);
    PROMISE(zip_end(&writer, BAT_OK, NULL) == BAT_OK);
    mesh_round_trip((const uint8_t *)package.data, package.size, BAT_MESH_FORMAT_3MF);
    text_free(&part);
    text_free(&model);
    text_free(&package);
    return 0;
}
