#include "fuzz_round_trip.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_CURVE_FORMAT_TOPOJSON, NULL, false);
    round_trip(data, size, BAT_CURVE_FORMAT_TOPOJSON, "plane", false);
    return 0;
}
