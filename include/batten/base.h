#ifndef BATTEN_BASE_H
#define BATTEN_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define BAT_API
#else
#define BAT_API __attribute__((visibility("default")))
#endif

#if defined(__cplusplus)
#define BAT_C_BEGIN                                                                                                         \
    extern "C"                                                                                                              \
    {
#define BAT_C_END }
#else
#define BAT_C_BEGIN
#define BAT_C_END
#endif

BAT_C_BEGIN

/// @file
/// What every other header rests on: status codes, error text, progress, random streams, the version.

#define BAT_VERSION_MAJOR 0
#define BAT_VERSION_MINOR 1
#define BAT_VERSION_PATCH 0

/// The version of the library that is linked, as "major.minor.patch".
BAT_API const char *bat_version(void);

/// How a call ended. Every call that can fail returns one.
typedef enum bat_status
{
    BAT_OK = 0,
    BAT_INVALID_ARGUMENT, ///< an option is out of its range, or two options contradict each other
    BAT_INVALID_POINT,    ///< a point is not in its space, is not finite, or repeats its neighbour
    BAT_CUT_LOCUS,        ///< two neighbours have no unique shortest geodesic (antipodal points of a sphere)
    BAT_UNSUPPORTED,      ///< the combination asked for has no meaning, for example a plane scheme on the sphere
    BAT_NO_CONVERGENCE,   ///< an iteration did not settle, or a scheme that does not converge was asked for its limit
    BAT_TOO_LARGE,        ///< a count overflows size_t or the limit that the caller set
    BAT_NO_MEMORY,        ///< an allocation failed
    BAT_BAD_FILE,         ///< the content of a file is wrong; bat_error::line says where
    BAT_FILE_ACCESS,      ///< a file cannot be opened, read, written or renamed
    BAT_CANCELLED,        ///< the caller's progress function asked to stop
    BAT_NOT_MANIFOLD ///< a mesh has an edge of three faces, faces that run against each other, or a vertex of several fans
} bat_status;

/// A short name of a status, for example "invalid point". Never null.
BAT_API const char *bat_status_name(bat_status status);

#define BAT_NO_INDEX ((size_t)-1)
#define BAT_ERROR_TEXT_SIZE 240

/// What went wrong and where. Calls fill it only when they fail; it may be null everywhere.
typedef struct bat_error
{
    bat_status status;
    size_t index;                   ///< the point, curve or coefficient at fault, counted from 0; or BAT_NO_INDEX
    size_t line;                    ///< the line of the file at fault, counted from 1; 0 when there is none
    char text[BAT_ERROR_TEXT_SIZE]; ///< one line without a full stop; it names the index itself where there is one
} bat_error;

/// How a long call reports and is stopped. All zero: silent and not to be stopped.
typedef struct bat_progress
{
    /// Called now and then from the calling thread with the share done, 0 to 1; false asks the call to stop with
    /// BAT_CANCELLED. May be null.
    bool (*report)(void *context, double fraction);
    void *context; ///< handed to `report`
} bat_progress;

/// A stream of pseudo-random numbers (xoshiro256++ of Blackman and Vigna, seeded through splitmix64). The same seed gives
/// the same bits and uniform numbers on every machine; normal ones may differ in the last digit.
typedef struct bat_random
{
    uint64_t state[4];
} bat_random;

/// A stream for a seed. Different seeds give unrelated streams.
BAT_API bat_random bat_random_seed(uint64_t seed);
/// The next 64 random bits.
BAT_API uint64_t bat_random_bits(bat_random *random);
/// A number from the uniform distribution on [0, 1), a multiple of 2^-53.
BAT_API double bat_random_uniform(bat_random *random);
/// A number from the standard normal distribution.
BAT_API double bat_random_normal(bat_random *random);

BAT_C_END

#endif
