/* What becomes of attempts by what a network knows; each is a position of it. */
#include "networks/network.h"

/* What becomes of an attempt by what is known; false if it is decided. None is once memory was short:
 * what then became known may be wrong. */
bool weigh(judging *g, int32_t at, int64_t t)
{
    attempt *x = attempt_of(g, at);
    const bool parted = g->net->parted;
    const operator_state *worse = &g->net->readings[0].nodes[g->root];
    const operator_state *better = &g->net->readings[parted ? 1 : 0].nodes[g->root];
    if (is_spoilt(g)) {
        return true;
    }
    if (knows(worse, 1U, position_of(x))) {
        decide(g->r, g->index, at, true, t);
        return false;
    }
    if (knows(better, 0U, position_of(x))) {
        decide(g->r, g->index, at, false, t);
        return false;
    }
    if (parted && knows(worse, 0U, position_of(x))) {
        x->location = FAILED;
    }
    if (parted && knows(better, 1U, position_of(x))) {
        x->better = PASSED;
        x->parted = true;
    }
    return true;
}

/* The oldest attempt whose position is not before one; -1: there is none. */
static int32_t attempt_from(const judging *g, int64_t position)
{
    int32_t at = g->j->first;
    if ((at < 0) || (position_of(attempt_of(g, g->j->last)) < position)) {
        return -1;
    }
    while (position_of(attempt_of(g, at)) < position) {
        at = attempt_of(g, at)->next;
    }
    return at;
}

/* The position of an attempt that what became known of a formula decides; NEVER: of none. */
int64_t decided_one(const judging *g)
{
    uint8_t value;
    int32_t i;
    for (value = 0; value < 2U; value++) {
        const int32_t reading = (g->net->parted && (value == 0U)) ? 1 : 0;
        const ranges *news = &g->net->readings[reading].nodes[g->root].news[value];
        for (i = news->first; i < news->end; i++) {
            const int32_t at = attempt_from(g, news->at[i].first);
            if ((at >= 0) && (position_of(attempt_of(g, at)) <= news->at[i].last)) {
                return position_of(attempt_of(g, at));
            }
        }
    }
    return NEVER;
}

/* The first position from one on at which something became known of a formula; NEVER: there is none. */
static int64_t next_new(const judging *g, int64_t position)
{
    int64_t found = NEVER;
    int32_t i;
    int32_t j;
    for (i = 0; i < 2 * readings(g); i++) {
        const ranges *news = &g->net->readings[i / 2].nodes[g->root].news[i % 2];
        for (j = news->first; j < news->end; j++) {
            if (news->at[j].last >= position) {
                const int64_t first = news->at[j].first;
                found = least(found, (first > position) ? first : position);
            }
        }
    }
    return found;
}

/* Judge the attempts of which something became known, at `t`. */
void hear_news(judging *g, int64_t t)
{
    int64_t asked = -NEVER;
    int32_t before = -1;
    int32_t at = g->j->first;
    if (!g->net->parted && (decided_one(g) == NEVER)) {
        return;
    }
    while (at >= 0) {
        const int32_t next = attempt_of(g, at)->next;
        const int64_t position = position_of(attempt_of(g, at));
        if (position > asked) {
            asked = next_new(g, position);
            if (asked == NEVER) {
                break;
            }
        }
        if ((position >= asked) && !weigh(g, at, t)) {
            leave(g->r, g->index, before, at);
        } else if (is_undecidable(attempt_of(g, at))) {
            lay_aside(g->r, g->index, before, at);
        } else {
            before = at;
        }
        at = next;
    }
}
