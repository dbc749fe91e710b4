/* The search with bounds of 32 bits, and the choice between both searches. */
#include "whole.h"

answer search_narrow(const int32_t *plan, const double *costs, const caller *from)
{
    return search_here(plan, costs, from);
}

answer search(const int32_t *plan, const double *costs, const caller *from)
{
    answer found = search_narrow(plan, costs, from);
    if (found.state == SEARCH_TOO_LARGE) {
        release_answer(&found);
        found = search_wide(plan, costs, from);
    }
    return found;
}

void release_answer(answer *found)
{
    while (found->memory != NULL) {
        held *next = found->memory->next;
        free(found->memory);
        found->memory = next;
    }
}
