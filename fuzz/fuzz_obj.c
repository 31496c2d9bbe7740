#include "fuzz_round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_CURVE_FORMAT_OBJ, NULL, false);
    round_trip(data, size, BAT_CURVE_FORMAT_OBJ, "plane", false);
    round_trip(data, size, BAT_CURVE_FORMAT_OBJ, "sphere", true);
    round_trip(data, size, BAT_CURVE_FORMAT_OBJ, "disk", true);
    return 0;
}
