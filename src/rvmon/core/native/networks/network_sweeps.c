/* `until` and `since` without bounds, in a delay network: a range that becomes known extends as far as
 * their left operand holds. Each rule starts from the ranges added to one operand, so the cost of a step
 * grows with the ranges that it adds. `yes` is the value that `right` alone gives to the whole, `no` the
 * other one; for the duals (release, trigger) the values are swapped. */
#include "networks/network.h"

/* `left until right` at p: yes if right is, or if left is yes at p and the whole is at p + 1; no if
 * right is no, and left is no or the whole is at p + 1. The four loops start from the ranges added to
 * right (yes), left (yes), right (no), left (no). */
void update_until(const form *f, const network *w, const operator_plan *n, operator_state *o)
{
    const uint8_t yes = (uint8_t)(n->turned ^ 1);
    const uint8_t no = (uint8_t)n->turned;
    const operator_state *left = &w->nodes[n->left];
    const operator_state *right = &w->nodes[n->right];
    const ranges *added = &right->added[yes];
    int32_t i;
    int32_t j;
    for (i = added->first; i < added->end; i++) {
        const int64_t first = added->at[i].first;
        j = range_around(&left->known[yes], first - 1);
        add_known(f, o, yes, (j < 0) ? first : left->known[yes].at[j].first, added->at[i].last);
    }
    added = &left->added[yes];
    for (i = added->first; i < added->end; i++) {
        const int64_t met = last_up_to(&o->known[yes], added->at[i].last + 1);
        j = range_around(&left->known[yes], added->at[i].first);
        if (j >= 0) {
            add_known(f, o, yes, left->known[yes].at[j].first, met - 1);
        }
    }
    added = &right->added[no];
    for (i = added->first; i < added->end; i++) {
        int64_t last = added->at[i].last;
        if (!knows(o, no, last + 1)) {
            last = last_up_to(&left->known[no], last);
        }
        j = range_around(&right->known[no], added->at[i].first);
        if ((j >= 0) && (last >= added->at[i].first)) {
            add_known(f, o, no, right->known[no].at[j].first, last);
        }
    }
    added = &left->added[no];
    for (i = added->first; i < added->end; i++) {
        const ranges *unmet = &right->known[no];
        j = range_from(unmet, added->at[i].first);
        for (; (j < unmet->end) && (unmet->at[j].first <= added->at[i].last); j++) {
            add_known(f, o, no, unmet->at[j].first, least(unmet->at[j].last, added->at[i].last));
        }
    }
    if ((w->closed < NEVER) && (n->kept != 0)) {
        /* At the end of the trace, what a release requires for ever counts as true (`kept`). */
        j = range_around(&right->known[no], w->last);
        add_known(f, o, no, (j < 0) ? w->last + 1 : right->known[no].at[j].first, w->last);
    }
}

/* `left since right`: the mirror image, towards the past. */
void update_since(const form *f, const network *w, const operator_plan *n, operator_state *o)
{
    const uint8_t yes = (uint8_t)(n->turned ^ 1);
    const uint8_t no = (uint8_t)n->turned;
    const operator_state *left = &w->nodes[n->left];
    const operator_state *right = &w->nodes[n->right];
    const ranges *added = &right->added[yes];
    int32_t i;
    int32_t j;
    for (i = added->first; i < added->end; i++) {
        const int64_t last = added->at[i].last;
        j = range_around(&left->known[yes], last + 1);
        add_known(f, o, yes, added->at[i].first, (j < 0) ? last : left->known[yes].at[j].last);
    }
    added = &left->added[yes];
    for (i = added->first; i < added->end; i++) {
        const int64_t first = added->at[i].first - 1;
        const int32_t met = range_from(&o->known[yes], first);
        j = range_around(&left->known[yes], added->at[i].first);
        if ((j >= 0) && (met < o->known[yes].end)) {
            const int64_t since = o->known[yes].at[met].first;
            add_known(f, o, yes, ((since > first) ? since : first) + 1, left->known[yes].at[j].last);
        }
    }
    added = &right->added[no];
    for (i = added->first; i < added->end; i++) {
        int64_t first = added->at[i].first;
        if (!knows(o, no, first - 1)) {
            j = range_from(&left->known[no], first);
            if (j < left->known[no].end) {
                first = (left->known[no].at[j].first > first) ? left->known[no].at[j].first : first;
            } else {
                first = NEVER;
            }
        }
        j = range_around(&right->known[no], added->at[i].last);
        if ((j >= 0) && (first <= added->at[i].last)) {
            add_known(f, o, no, first, right->known[no].at[j].last);
        }
    }
    added = &left->added[no];
    for (i = added->first; i < added->end; i++) {
        const ranges *unmet = &right->known[no];
        j = range_from(unmet, added->at[i].first);
        for (; (j < unmet->end) && (unmet->at[j].first <= added->at[i].last); j++) {
            const int64_t first = unmet->at[j].first;
            add_known(f, o, no, (first > added->at[i].first) ? first : added->at[i].first,
                 unmet->at[j].last);
        }
    }
}
