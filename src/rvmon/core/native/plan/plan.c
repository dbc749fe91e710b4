/* Opening and validating a plan. After rv_plan_check succeeded, every index, size and offset that
 * the core takes from the plan is in range, so no bytes can make it read or write outside its
 * memory. It does not check that the plan means anything sensible. Cost: linear in the plan, except
 * that each judge with a table of letters looks through all links of its part (plan_judges.c). */
#include "plan/plan_check.h"

#include <string.h>

/* Record size of each section. */
#define SECTION_SIZE(name, field, record) sizeof(record),
static const size_t RECORD[SECTIONS] = {PLAN_SECTIONS(SECTION_SIZE)};

/* No section is wrong: what rv_plan_check returns for a valid plan. */
#define FINE (-1)

static uint64_t hash_of_words(const uint64_t *words, size_t count)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    size_t i;
    for (i = 0; i < count; i++) {
        hash = (hash ^ words[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static const section *table_of(const plan_header *h)
{
    return (const section *)(const void *)(h + 1);
}

/* Whether the header is that of a plan of this version and byte order, the hash fits, and every
 * section lies within the bytes. 8-byte alignment makes the casts to records valid. */
static bool is_whole(const void *bytes, size_t size)
{
    const plan_header *h = bytes;
    const size_t head = sizeof *h + SECTIONS * sizeof(section);
    const section *table;
    int32_t i;
    if ((bytes == NULL) || ((uintptr_t)bytes % 8 != 0) || (size % 8 != 0) || (size < head)
        || (memcmp(h->magic, PLAN_MAGIC, sizeof h->magic) != 0) || (h->order != PLAN_ORDER)
        || (h->sections != SECTIONS) || (h->size < 0) || ((uint64_t)h->size != size)) {
        return false;
    }
    if (h->hash != hash_of_words((const uint64_t *)(const void *)(h + 1), (size - sizeof *h) / 8)) {
        return false;
    }
    table = table_of(h);
    for (i = 0; i < SECTIONS; i++) {
        const section *s = &table[i];
        if ((s->offset < (int64_t)head) || (s->offset % 8 != 0) || (s->count < 0)
            || (s->count >= MOST) || ((uint64_t)s->offset > size)
            || ((uint64_t)s->count > (size - (uint64_t)s->offset) / RECORD[i])) {
            return false;
        }
    }
    return true;
}

#define SECTION_VIEW(name, field, record) \
    p->field = (const record *)(const void *)((const char *)bytes + table[SEC_##name].offset);

bool plan_view(plan *p, const void *bytes, size_t size)
{
    const section *table;
    int32_t i;
    if (!is_whole(bytes, size)) {
        return false;
    }
    p->header = bytes;
    table = table_of(p->header);
    PLAN_SECTIONS(SECTION_VIEW)
    for (i = 0; i < SECTIONS; i++) {
        p->counts[i] = table[i].count;
    }
    p->part_count = (int32_t)p->counts[SEC_PARTS];
    return true;
}

machine machine_view(const plan *p, const automaton_plan *a)
{
    machine made;
    made.class_of = &p->ints[a->class_of];
    made.bases = &p->ints[a->bases];
    made.widths = &p->ints[a->widths];
    made.strides = &p->ints[a->strides];
    made.cut_first = &p->ints[a->cut_first];
    made.cuts = &p->ticks[a->cuts];
    made.edges = &p->ints[a->edges];
    made.targets = &p->ints[a->targets];
    made.sources = &p->ints[a->sources];
    made.time_values = &p->ints[a->time_values];
    made.clause_first = &p->ints[a->clause_first];
    made.test_first = &p->ints[a->test_first];
    made.tests = &p->ints[a->tests];
    made.ages = &p->ticks[a->ages];
    made.gap = p->header->gap;
    made.step = (made.gap > 0) ? made.gap : 1;
    made.initial = a->initial;
    made.locations = a->locations;
    made.clocks = a->clocks;
    made.classes = a->classes;
    return made;
}

/* Check the header. Names stay below a quarter of 32 bits, as leaves use 2 * signal + 1. */
static bool check_header(const plan *p)
{
    const plan_header *h = p->header;
    return (h->gap >= 0) && (h->gap < LIMIT) && (h->signals >= 0) && (h->events >= 0)
           && is_within(h->fields, 0, FIELDS_MOST + 1) && (h->requirements >= 0)
           && is_within(h->captured, 0, CAPTURED_MOST + 1)
           && (h->filling == 0)
           && (h->signals < MOST / 4) && (h->events < MOST / 4)
           && (p->counts[SEC_FIELD_FIRST] == h->events + 1)
           && (p->counts[SEC_SUBSCRIPTION_FIRST] == (int64_t)h->signals + h->events + 1)
           && ascends(p->field_first, h->events, h->fields)
           && ascends(p->subscription_first, (int64_t)h->signals + h->events,
                      p->counts[SEC_SUBSCRIPTIONS]);
}

/* Whether every subscription leads to a signal or event of a part that has the same name. */
static bool check_subscriptions(const plan *p)
{
    int32_t name;
    int32_t i;
    for (name = 0; name < p->header->signals + p->header->events; name++) {
        const bool event = name >= p->header->signals;
        for (i = p->subscription_first[name]; i < p->subscription_first[name + 1]; i++) {
            const subscription *s = &p->subscriptions[i];
            const part_plan *owner;
            int32_t own;
            if (!is_within(s->part, 0, p->part_count)) {
                return false;
            }
            owner = &p->parts[s->part];
            if (!is_within(s->local, 0, event ? owner->events.count : owner->signals.count)) {
                return false;
            }
            own = event ? p->events[owner->events.first + s->local].name
                        : p->signals[owner->signals.first + s->local].name;
            if (own != name) {
                return false;
            }
        }
    }
    return true;
}

/* Check the ranges and counts of a part. Bounds by the number of nodes keep the memory of a run
 * proportional to the plan. With captured values, judges must fit the bits of an int32, and there is
 * one requirement. */
static bool check_part(const plan *p, const part_plan *x)
{
    const int32_t nodes = x->nodes.count;
    const int32_t judges = x->judges.count;
    return has(p, SEC_SIGNALS, x->signals.first, x->signals.count)
           && has(p, SEC_EVENTS, x->events.first, x->events.count)
           && has(p, SEC_ATOMS, x->atoms.first, x->atoms.count)
           && has(p, SEC_NODES, x->nodes.first, nodes)
           && has(p, SEC_JUDGES, x->judges.first, judges)
           && has(p, SEC_FORMS, x->forms.first, x->forms.count)
           && has(p, SEC_WATCHES, x->watches.first, x->watches.count)
           && has(p, SEC_GROUPS, x->groups.first, x->groups.count)
           && is_within(x->requirements, 0, (int64_t)judges + 1) && (x->fields >= 0)
           && is_within(x->timers, 0, (int64_t)nodes + 1) && is_within(x->seen, 0, (int64_t)nodes + 1)
           && is_within(x->edges, 0, (int64_t)nodes + 1)
           && is_within(x->stretches, 0, (int64_t)nodes + 1)
           && is_within(x->sums, 0, (int64_t)x->stretches + 1)
           && is_within(x->amounts, 0, (int64_t)x->stretches + 1)
           && is_within(x->perishable, 0, (int64_t)x->signals.count + 1)
           && is_within(x->clocks, 1, CLOCKS_MOST + 1) && (x->undetermined >= 0) && (x->births >= 0)
           && lists(p, x->stateful, 0, nodes) && lists(p, x->networked, 0, judges)
           && lists(p, x->dead_timers, 0, nodes) && is_within(x->captured, 0, (int64_t)p->header->captured + 1)
           && is_within(x->each, 0, 2) && (x->each <= x->captured)
           && is_within(x->requirement, (x->captured > 0) ? 0 : -1, p->header->requirements)
           && lists(p, x->captures, 0, p->counts[SEC_CODE])
           && (x->each + x->captures.count == x->captured)
           && lists(p, x->varying_atoms, 0, x->atoms.count) && lists(p, x->varying_nodes, 0, nodes)
           && lists(p, x->varying, 0, nodes) && lists(p, x->lapsed, 0, nodes)
           && ((x->captured == 0) || (is_within(judges, 1, 31) && (x->requirements == 1)))
           && is_within(x->truths, -1, (x->captured == 0) ? x->forms.count : 0)
           && ((x->captured == 0) || (x->watches.count == 0))
           && ((x->each == 0)
               || (is_within(x->each_event, 0, x->events.count)
                   && is_within(x->each_field, 0, p->events[x->events.first + x->each_event].fields)));
}

/* Whether constants are known and not NaN, which comparisons rely on. */
static bool check_numbers(const plan *p)
{
    int64_t i;
    for (i = 0; i < p->counts[SEC_NUMBERS]; i++) {
        const number_plan *own = &p->numbers[i];
        if (!is_within(own->kind, RV_WHOLE, RV_REAL + 1)
            || ((own->kind == RV_REAL) && (own->as.real != own->as.real))) {
            return false;
        }
    }
    return true;
}

/* Whether requirements that capture values have at most one part each, in ascending order. */
static bool check_parts(const plan *p)
{
    int32_t last = -1;
    int32_t i;
    for (i = 0; i < p->part_count; i++) {
        if (p->parts[i].captured > 0) {
            if (p->parts[i].requirement <= last) {
                return false;
            }
            last = p->parts[i].requirement;
        }
    }
    return true;
}

/* The first section found wrong for a part, or FINE. The order matters: later checks index by what
 * earlier ones have validated. */
static int32_t wrong_in_part(const plan *p, const part_plan *x)
{
    int32_t i;
    if (!check_part(p, x)) {
        return SEC_PARTS;
    }
    if (!check_inputs(p, x)) {
        return SEC_SIGNALS;
    }
    if (!check_atoms(p, x)) {
        return SEC_ATOMS;
    }
    if (!check_nodes(p, x)) {
        return SEC_NODES;
    }
    if (!check_forms(p, x)) {
        return SEC_FORMS;
    }
    for (i = 0; i < x->judges.count; i++) {
        if (!check_judge(p, x, i)) {
            return SEC_JUDGES;
        }
    }
    if (!check_watches(p, x)) {
        return SEC_WATCHES;
    }
    if (!check_groups(p, x)) {
        return SEC_GROUPS;
    }
    return check_margins(p, x) ? FINE : SEC_MARGINS;
}

int32_t rv_plan_check(const void *bytes, size_t size)
{
    plan p;
    int32_t i;
    if (!plan_view(&p, bytes, size) || !check_header(&p)) {
        return 0;
    }
    if (!check_numbers(&p)) {
        return SEC_NUMBERS;
    }
    if (!check_parts(&p)) {
        return SEC_PARTS;
    }
    if ((p.counts[SEC_MARGINS] != 0) && (p.counts[SEC_MARGINS] != p.counts[SEC_JUDGES])) {
        return SEC_MARGINS;
    }
    for (i = 0; i < (int32_t)p.counts[SEC_AUTOMATA]; i++) {
        if (!check_automaton(&p, &p.automata[i])) {
            return SEC_AUTOMATA;
        }
    }
    for (i = 0; i < p.part_count; i++) {
        const int32_t wrong = wrong_in_part(&p, &p.parts[i]);
        if (wrong != FINE) {
            return wrong;
        }
    }
    return check_subscriptions(&p) ? FINE : SEC_SUBSCRIPTIONS;
}
