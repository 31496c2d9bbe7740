// The product of packed.c for one width of vector registers. Included once for each, with
//   PRODUCT         the function's name
//   PRODUCT_BYTES   bytes of a register
//   PRODUCT_VECTORS registers side by side: LEARN_TILE times as many sums, and a few more, must fit the registers there are
//   PRODUCT_TARGET  the attribute that lets the compiler use them

#define WIDE PRODUCT_NAME(PRODUCT, _vector)
#define LANES (PRODUCT_BYTES / sizeof(real))

/// Numbers at any address of theirs.
typedef real WIDE __attribute__((vector_size(PRODUCT_BYTES), aligned(sizeof(real)), may_alias));

#if __FLT_EVAL_METHOD__ != 0
static inline WIDE PRODUCT_NAME(PRODUCT, _splat)(real number)
{
    WIDE vector;
    for (size_t l = 0; l < LANES; l++)
        vector[l] = number;
    return vector;
}
#endif

/// A tile of rows by `vectors` registers of columns. Sums stay in registers while all inputs go by.
PRODUCT_TARGET
__attribute__((always_inline)) static inline void PRODUCT_NAME(PRODUCT, _tile)(const learn_packed *layer, size_t column,
                                                                               size_t vectors, const real *restrict x,
                                                                               size_t stride, real *restrict y)
{
    size_t inputs = layer->inputs, columns = layer->columns, input_stride = layer->input_stride;
    const real *weight = layer->weight + column / LEARN_PANEL * layer->panel_stride + column % LEARN_PANEL;
    WIDE sums[LEARN_TILE][PRODUCT_VECTORS], weights[PRODUCT_VECTORS];
    for (size_t i = 0; i < LEARN_TILE; i++)
        for (size_t v = 0; v < vectors; v++)
            sums[i][v] = *(const WIDE *)(layer->bias + column + v * LANES);
    for (size_t k = 0; k < inputs; k++, weight += input_stride)
    {
        for (size_t v = 0; v < vectors; v++)
            weights[v] = *(const WIDE *)(weight + v * LANES);
        for (size_t i = 0; i < LEARN_TILE; i++)
            for (size_t v = 0; v < vectors; v++)
                sums[i][v] += PRODUCT_SCALED(x[i * stride + k], weights[v]);
    }
    for (size_t i = 0; i < LEARN_TILE; i++)
        for (size_t v = 0; v < vectors; v++)
        {
            WIDE *to = (WIDE *)(y + i * columns + column + v * LANES);
            if (layer->adds)
                sums[i][v] += *to;
            *to = sums[i][v];
        }
}

PRODUCT_TARGET
static void PRODUCT(const learn_packed *layer, size_t rows, const real *restrict x, size_t stride, real *restrict y)
{
    size_t columns = layer->columns;
    for (size_t r = 0; r < rows; r += LEARN_TILE)
        for (size_t c = 0; c < columns; c += PRODUCT_VECTORS * LANES)
            if (c + LANES < layer->wanted)
                PRODUCT_NAME(PRODUCT, _tile)(layer, c, PRODUCT_VECTORS, x + r * stride, stride, y + r * columns);
            else if (c < layer->wanted)
                PRODUCT_NAME(PRODUCT, _tile)(layer, c, 1, x + r * stride, stride, y + r * columns);
}

#undef WIDE
#undef LANES
#undef PRODUCT
#undef PRODUCT_BYTES
#undef PRODUCT_VECTORS
#undef PRODUCT_TARGET
