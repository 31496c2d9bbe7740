#include "fuzz_round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_FORMAT_GEOJSON, NULL, false);
    round_trip(data, size, BAT_FORMAT_GEOJSON, "plane", false);
    round_trip(data, size, BAT_FORMAT_GEOJSON, "sphere", true);
    round_trip(data, size, BAT_FORMAT_GEOJSON, "disk", true);
    return 0;
}
