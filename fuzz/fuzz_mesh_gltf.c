#include "fuzz_mesh_round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mesh_round_trip(data, size, BAT_MESH_FORMAT_GLB);
    return 0;
}
