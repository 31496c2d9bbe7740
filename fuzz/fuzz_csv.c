#include "fuzz_round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, NULL, false);
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, "plane", false);
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, "sphere", true);
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, "disk", true);
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, "rotation", true);
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, "rigid", false);
    round_trip(data, size, BAT_CURVE_FORMAT_CSV, "spd", false);
    round_trip(data, size, BAT_CURVE_FORMAT_TUM, NULL, true);
    return 0;
}
