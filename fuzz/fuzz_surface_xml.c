#include "fuzz_surface_round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    surface_round_trip(data, size, surface_xml_read);
    return 0;
}
