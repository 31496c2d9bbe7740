#include "search/nearest.h"

#include <stdbool.h>
#include <stdint.h>

static bool precedes(keyed a, keyed b)
{
    return a.key < b.key || (a.key == b.key && a.item < b.item);
}

/// A place for the pivot that no arrangement of keys foresees (splitmix64's mixing).
static size_t pivot_place(size_t begin, size_t end)
{
    uint64_t z = (uint64_t)begin * 0x9e3779b97f4a7c15u + (uint64_t)end;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return begin + (size_t)((z ^ (z >> 31)) % (end - begin));
}

/// Split entries begin … end - 1, at least two, in two parts that are not empty; those in the first are not greater than a
/// pivot, those in the second not smaller (Hoare's partition). Returns where the second begins.
static size_t partition(keyed *entries, size_t begin, size_t end)
{
    keyed pivot = entries[pivot_place(begin, end)];
    size_t low = begin, high = end - 1;
    for (;;)
    {
        while (precedes(entries[low], pivot))
            low++;
        while (precedes(pivot, entries[high]))
            high--;
        if (low >= high)
            return low == begin ? begin + 1 : low;
        keyed kept = entries[low];
        entries[low++] = entries[high];
        entries[high--] = kept;
    }
}

void select_nth(keyed *entries, size_t count, size_t nth)
{
    size_t begin = 0, end = count;
    while (end - begin > 1)
    {
        size_t middle = partition(entries, begin, end);
        if (nth < middle)
            end = middle;
        else
            begin = middle;
    }
}
