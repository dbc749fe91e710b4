/* The search with bounds of 64 bits, for numbers too large for 32. */
#define WIDE
#include "whole.h"

answer search_wide(const int32_t *plan, const double *costs, const caller *from)
{
    return search_here(plan, costs, from);
}
