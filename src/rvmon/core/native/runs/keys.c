/* Instances of `for each`: a key is a value that occurred, an instance is the run that judges the
 * requirement for it. Keys are found by a hash table with chains. An instance is created when its key
 * first occurs, by forking the root or by replay. If it later equals the root it is closed
 * (PART_FORGETS), and created again when its key recurs, so memory depends on the active keys only.
 *
 * An occurrence with an unknown key may have any key: it reopens every closed instance, and the root
 * stands for the keys that never occurred. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

/* The most closed keys remembered, the latest ones: their rank keeps the order of numbering. */
#define MOST_OVER 10000
#define FIRST_KEYS 16

static int32_t hash_of_key(const rv_number *value, int32_t room)
{
    uint64_t bits = 0;
    if ((value->kind == RV_REAL) && (value->as.real >= -0x1p63) && (value->as.real < 0x1p63)
        && ((double)(int64_t)value->as.real == value->as.real)) {
        bits = (uint64_t)(int64_t)value->as.real; /* equal numbers need equal hashes, so hash it as a
                                                   * whole number */
    } else if (value->kind == RV_REAL) {
        (void)memcpy(&bits, &value->as.real, sizeof bits);
    } else {
        bits = (uint64_t)value->as.whole;
    }
    bits *= UINT64_C(0x9e3779b97f4a7c15);
    return (int32_t)((bits >> 33) % (uint64_t)room);
}

/* Put a key into the chain of its hash. */
static void chain_key(home *h, int32_t at)
{
    const int32_t hash = hash_of_key(&h->keys[at].value, h->key_room);
    h->keys[at].next = h->heads[hash];
    h->heads[hash] = at;
}

/* Enlarge the table, and rehash; false: memory is short. Called when every key is in use. */
static bool grow_keys(home *h)
{
    rv_monitor *m = h->monitor;
    int32_t room = h->key_room;
    key *keys = enlarged(m, h->keys, &room, (int64_t)h->key_room + ((h->key_room > 0) ? 1 : FIRST_KEYS),
                      sizeof *keys);
    int32_t *heads;
    int32_t i;
    if (keys == NULL) {
        return false;
    }
    h->keys = keys;
    heads = arena_take(&m->memory, (size_t)room * sizeof *heads);
    if (heads == NULL) {
        m->spoilt = true;
        return false;
    }
    arena_give(&m->memory, h->heads, (size_t)h->key_room * sizeof *heads);
    h->heads = heads;
    h->key_room = room;
    for (i = 0; i < room; i++) {
        heads[i] = -1;
    }
    for (i = 0; i < h->key_count; i++) {
        chain_key(h, i);
    }
    return true;
}

/* Forget all keys; on the first call, allocate the table. */
bool begin_keys(home *h)
{
    int32_t i;
    h->key_count = 0;
    h->free_key = -1;
    h->oldest = -1;
    h->newest = -1;
    h->over_count = 0;
    h->last_rank = 0;
    for (i = 0; i < h->key_room; i++) {
        h->heads[i] = -1;
    }
    return (h->key_room > 0) || grow_keys(h);
}

static int32_t find_key(const home *h, const rv_number *value)
{
    int32_t at = h->heads[hash_of_key(value, h->key_room)];
    while ((at >= 0) && (compare_numbers(CMP_EQ, &h->keys[at].value, value) != IS_TRUE)) {
        at = h->keys[at].next;
    }
    return at;
}

/* Add a key that occurs for the first time at `t`; -1: memory is short. */
static int32_t add_key(home *h, const rv_number *value, int64_t t)
{
    int32_t at = h->free_key;
    if (at >= 0) {
        h->free_key = h->keys[at].next;
    } else if ((h->key_count < h->key_room) || grow_keys(h)) {
        at = h->key_count;
        h->key_count++;
    } else {
        return -1;
    }
    h->last_rank++;
    h->keys[at].value = *value;
    h->keys[at].occurred = t;
    h->keys[at].open = NULL;
    h->keys[at].rank = h->last_rank;
    chain_key(h, at);
    return at;
}

/* Restore a key from a snapshot; -1: it is there already, or memory is short. */
int32_t restore_key(home *h, const rv_number *value, int64_t occurred, uint32_t rank)
{
    const int32_t at = (find_key(h, value) < 0) ? add_key(h, value, occurred) : -1;
    if (at >= 0) {
        h->keys[at].rank = rank;
    }
    return at;
}

static void take_from_over(home *h, int32_t at)
{
    const key *k = &h->keys[at];
    if (k->older < 0) {
        h->oldest = k->newer;
    } else {
        h->keys[k->older].newer = k->newer;
    }
    if (k->newer < 0) {
        h->newest = k->older;
    } else {
        h->keys[k->newer].older = k->older;
    }
    h->over_count--;
}

/* Let attempts start in an instance from `t` on, as if its triggers had never been true. */
void open_at(run *r, int64_t t)
{
    int32_t i;
    touch_run(r);
    r->opens_at = t;
    r->opening = true;
    r->at.alarm = least(r->at.alarm, t);
    for (i = 0; i < r->part->plan->judges.count; i++) {
        const int32_t trigger = r->part->judges[i].trigger;
        if (starts_here(r, i) && (trigger >= 0)) {
            if (r->at.started) {
                r->judges[i].before = r->truth[trigger];
            }
            r->judges[i].running = false;
        }
    }
}

/* Whether an outage hides, at the tick `t`, the occurrence that opened an instance. Then its key is not
 * known to have occurred, and the instance waits for the next occurrence. */
bool is_opening_lost(run *r, int64_t t)
{
    const part_plan *p = r->part->plan;
    if ((r->rank == 0U) || (r->occurred < r->opens_at)
        || !is_lost_at(r, p->signals.count + p->each_event, t)) {
        return false;
    }
    r->opens_at = NEVER;
    r->occurred = NEVER;
    return true;
}

/* Open an instance whose first occurrence an outage hid, as if its key first occurred at `t`. */
static void reopen_instance(home *h, int32_t at, int64_t t)
{
    run *r = h->keys[at].open;
    h->last_rank++;
    h->keys[at].rank = h->last_rank;
    h->keys[at].occurred = t;
    r->rank = h->last_rank;
    r->occurred = t;
    open_at(r, t);
}

/* Create the instance of a key, known or new, at the sample at `t`. FRESH: its formulas depend on its key
 * only at the current position, so it can start from the root's state; else the past is replayed. */
static void open_instance(home *h, int32_t at, int64_t t, bool is_known)
{
    const part_plan *p = h->part->plan;
    run *made = forked(h->root);
    if (is_known) {
        take_from_over(h, at);
    }
    h->keys[at].open = made;
    if (made == NULL) {
        return;
    }
    made->captured[0] = h->keys[at].value;
    made->rank = h->keys[at].rank;
    made->occurred = h->keys[at].occurred;
    made->key = at;
    made->doubted = false;
    made->starters = p->instance_starters;
    made->judging = (p->captures.count > 0) ? 0 : p->instance_starters;
    made->opens_at = NEVER;
    if ((p->flags & PART_FRESH) != 0) {
        /* Samples since the last tick of a clock belong to the next tick. */
        made->over = h->root->over;
        made->at.gathered = h->root->at.gathered;
        if ((made->truth_log != NULL) && made->at.started) {
            made->truth_log->since = made->at.position; /* notes have no history before */
        }
        if (made->at.started && (made->at.presence == ARE_THERE)) {
            reevaluate_varying(made, made->at.position, made->at.gathered);
        }
    } else {
        replay(made);
        pass_time(made, t - 1, false);
    }
    open_at(made, t);
    enlist(made, false);
}

/* Create the instances whose keys are in the sample of the inbox, before it is judged. */
void open_instances(home *h, int64_t t)
{
    const part_plan *p = h->part->plan;
    bool unknown = false;
    int32_t i;
    for (i = 0; i < h->inbox_count; i++) {
        const incoming *in = &h->inbox[i];
        const rv_update *u = in->update;
        if (!in->event || (in->local != p->each_event) || (u->says == RV_SAYS_NO)
            || ((u->says <= RV_SAYS_YES)
                && is_lost_at(h->root, p->signals.count + in->local, t))) {
            continue;
        }
        if ((u->says == RV_SAYS_YES) && (u->fields != NULL)
            && (u->fields[p->each_field].kind != RV_UNKNOWN)) {
            const rv_number *value = &u->fields[p->each_field];
            int32_t at = find_key(h, value);
            const bool is_known = at >= 0;
            if (!is_known) {
                at = add_key(h, value, t);
            }
            if ((at >= 0) && (h->keys[at].open == NULL)) {
                open_instance(h, at, t, is_known);
            } else if ((at >= 0) && (h->keys[at].open->occurred == NEVER)) {
                reopen_instance(h, at, t);
            } else {
                /* The instance exists. */
            }
        } else {
            unknown = true;
        }
    }
    if (unknown) {
        open_unknown(h, t);
    }
}

/* An occurrence at `t` may have any key: open all closed instances. */
void open_unknown(home *h, int64_t t)
{
    while ((h->oldest >= 0) && !h->monitor->spoilt) {
        open_instance(h, h->oldest, t, true);
    }
    if (h->root->opens_at == NEVER) {
        open_at(h->root, t);
    }
}

/* What an update of the key's event says for this instance, as an RV_SAYS value; -1: it has another
 * key. */
int32_t says_for_instance(const run *r, const rv_update *u)
{
    const rv_number *value;
    if (u->says != RV_SAYS_YES) {
        return (u->says == RV_SAYS_NO) ? -1 : u->says;
    }
    value = (u->fields == NULL) ? NULL : &u->fields[r->part->plan->each_field];
    if ((value == NULL) || (value->kind == RV_UNKNOWN)) {
        return RV_SAYS_UNKNOWN;
    }
    return same_number(value, &r->captured[0]) ? RV_SAYS_YES : -1;
}

/* Whether nothing is pending in an instance: no attempt, no run of an attempt, no margin, no repeating
 * pulse. */
static bool is_quiet(const run *r)
{
    int32_t i;
    if (r->opening || (r->pending_margins > 0) || (r->first_child != NULL) || (r->repeating_count > 0)
        || ((GAP(r) > 1) && (r->at.awaited < NEVER))) {
        return false;
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        if ((next_open(r, i, -1) >= 0) || r->judges[i].running) {
            return false;
        }
    }
    return true;
}

/* Whether an instance equals the root except for what depends on its key, so that an instance created
 * later would behave the same. Nodes that depend on the key (`varying`, ascending) are evaluated at
 * creation anyway. */
bool equals_root(const run *r)
{
    const part_plan *p = r->part->plan;
    const run *root = r->home->root;
    const int32_t *varying = LIST(PLAN(r), p->varying);
    int32_t next = 0;
    int32_t i;
    if (!is_quiet(r) || (r->at.lost_count > 0) || (r->occurred == NEVER) || r->at.dense
        || (r->at.presence != ARE_THERE)) {
        return false;
    }
    for (i = 0; i < p->nodes.count; i++) {
        if ((next < p->varying.count) && (varying[next] == i)) {
            next++;
        } else if (r->truth[i] != root->truth[i]) {
            return false;
        } else {
            /* This node is equal. */
        }
    }
    for (i = 0; i < p->seen; i++) {
        if (r->seen[i] != root->seen[i]) {
            return false;
        }
    }
    for (i = 0; i < 2 * p->edges; i++) {
        if (!edges_agree(&r->edges[i], &root->edges[i])) {
            return false;
        }
    }
    for (i = 0; i < 2 * p->stretches; i++) {
        if (!stretches_agree(&r->past[i], &root->past[i])) {
            return false;
        }
    }
    for (i = 0; i < p->sums; i++) {
        if (memcmp(&r->tallies[i], &root->tallies[i], sizeof *r->tallies) != 0) {
            return false;
        }
    }
    return true;
}

static void forget_oldest(home *h)
{
    const int32_t at = h->oldest;
    int32_t *link = &h->heads[hash_of_key(&h->keys[at].value, h->key_room)];
    while (*link != at) {
        link = &h->keys[*link].next;
    }
    *link = h->keys[at].next;
    take_from_over(h, at);
    h->keys[at].next = h->free_key;
    h->free_key = at;
}

void add_closed_key(home *h, int32_t at)
{
    key *k = &h->keys[at];
    k->open = NULL;
    k->older = h->newest;
    k->newer = -1;
    if (h->newest < 0) {
        h->oldest = at;
    } else {
        h->keys[h->newest].newer = at;
    }
    h->newest = at;
    h->over_count++;
}

/* Close an instance that is_over; its key is remembered for a while. */
void close_instance(run *r)
{
    home *h = r->home;
    add_closed_key(h, r->key);
    delist(r, false);
    while (h->over_count > MOST_OVER) {
        forget_oldest(h);
    }
}

/* The instance of a key; NULL: there is none. */
run *instance_of(const home *h, const rv_number *value)
{
    const int32_t at = find_key(h, value);
    return (at >= 0) ? h->keys[at].open : NULL;
}
