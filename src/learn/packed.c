#include "learn/packed.h"

#include "learn/klein.h"

learn_packed learn_pack(size_t inputs, size_t outputs, const real *weight, size_t stride, const real *bias, real *memory)
{
    size_t columns = learn_whole_panels(outputs);
    real *own_bias = memory + inputs * columns;
    memset(memory, 0, learn_packed_size(inputs, outputs) * sizeof *memory);
    for (size_t o = 0; o < outputs; o++)
    {
        real *panel = memory + o / LEARN_PANEL * LEARN_PANEL * inputs + o % LEARN_PANEL;
        for (size_t k = 0; k < inputs; k++)
            panel[k * LEARN_PANEL] = weight[o * stride + k];
        own_bias[o] = bias[o];
    }
    return (learn_packed){inputs, columns, columns, memory, LEARN_PANEL, inputs * LEARN_PANEL, own_bias, false};
}

#define PRODUCT_PASTE(a, b) a##b
#define PRODUCT_NAME(a, b) PRODUCT_PASTE(a, b)

// Where arithmetic is done in a wider type (x87, s390x), compilers do not multiply a vector by a number.
#if __FLT_EVAL_METHOD__ == 0
#define PRODUCT_SCALED(number, vector) ((number) * (vector))
#else
#define PRODUCT_SCALED(number, vector) (PRODUCT_NAME(PRODUCT, _splat)(number) * (vector))
#endif

#define PRODUCT product_128
#define PRODUCT_BYTES 16
#define PRODUCT_VECTORS 2
#define PRODUCT_TARGET
#include "learn/packed_product.h"

#if defined(__x86_64__)
#define PRODUCT product_256
#define PRODUCT_BYTES 32
#define PRODUCT_VECTORS 2
#define PRODUCT_TARGET __attribute__((target("avx2,fma")))
#include "learn/packed_product.h"

#define PRODUCT product_512
#define PRODUCT_BYTES 64
#define PRODUCT_VECTORS 2
#define PRODUCT_TARGET __attribute__((target("avx512f,avx2,fma")))
#include "learn/packed_product.h"
#endif

void learn_packed_linear(const learn_packed *layer, size_t rows, const real *x, size_t stride, real *y)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f"))
    {
        product_512(layer, rows, x, stride, y);
        return;
    }
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    {
        product_256(layer, rows, x, stride, y);
        return;
    }
#endif
    product_128(layer, rows, x, stride, y);
}

// A function with clones must be static: compilers export the clones of a hidden function.

LANES_CLONES
static void klein_gelu(size_t count, const real *restrict x, real *restrict y)
{
    klein_gelu_forward(count, x, y);
}

void learn_packed_klein_gelu(size_t count, const real *restrict x, real *restrict y)
{
    klein_gelu(count, x, y);
}
