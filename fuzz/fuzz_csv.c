#include "fuzz_round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_FORMAT_CSV, NULL, false);
    round_trip(data, size, BAT_FORMAT_CSV, "plane", false);
    round_trip(data, size, BAT_FORMAT_CSV, "sphere", true);
    round_trip(data, size, BAT_FORMAT_CSV, "disk", true);
    return 0;
}
