/* The plan is checked before anything reads it: every index, size and bound, so that no bytes can
 * make the core read or write outside of its memory. */
#include "state.h"

#include <string.h>

/* The size of the records of each section. */
static const size_t RECORD[SECTIONS] = {
    sizeof(int32_t),       sizeof(int32_t),        sizeof(subscription), sizeof(part_plan),
    sizeof(signal_plan),   sizeof(event_plan),     sizeof(atom_plan),    sizeof(node_plan),
    sizeof(link_plan),     sizeof(judge_plan),     sizeof(automaton_plan), sizeof(form_plan),
    sizeof(operator_plan), sizeof(number_plan),    sizeof(int32_t),      sizeof(int32_t),
    sizeof(int32_t),       sizeof(int64_t)};

/* Where no record was found wrong. */
#define FINE (-1)
#define MOST INT32_MAX

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

/* Whether the bytes are a plan of this version, and each section lies within them. */
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

static const void *section_at(const plan_header *h, int32_t which)
{
    return (const char *)h + table_of(h)[which].offset;
}

bool plan_view(plan *p, const void *bytes, size_t size)
{
    const plan_header *h = bytes;
    int32_t i;
    if (!is_whole(bytes, size)) {
        return false;
    }
    p->header = h;
    p->field_first = section_at(h, SEC_FIELD_FIRST);
    p->subscription_first = section_at(h, SEC_SUBSCRIPTION_FIRST);
    p->subscriptions = section_at(h, SEC_SUBSCRIPTIONS);
    p->parts = section_at(h, SEC_PARTS);
    p->signals = section_at(h, SEC_SIGNALS);
    p->events = section_at(h, SEC_EVENTS);
    p->atoms = section_at(h, SEC_ATOMS);
    p->nodes = section_at(h, SEC_NODES);
    p->links = section_at(h, SEC_LINKS);
    p->judges = section_at(h, SEC_JUDGES);
    p->automata = section_at(h, SEC_AUTOMATA);
    p->forms = section_at(h, SEC_FORMS);
    p->operators = section_at(h, SEC_OPERATORS);
    p->numbers = section_at(h, SEC_NUMBERS);
    p->code = section_at(h, SEC_CODE);
    p->lists = section_at(h, SEC_LISTS);
    p->ints = section_at(h, SEC_INTS);
    p->ticks = section_at(h, SEC_TICKS);
    for (i = 0; i < SECTIONS; i++) {
        p->counts[i] = table_of(h)[i].count;
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
    made.clocks = a->clocks;
    made.classes = a->classes;
    return made;
}

static bool is_within(int64_t x, int64_t low, int64_t behind)
{
    return (x >= low) && (x < behind);
}

/* Whether so many records from `first` on lie in a section. */
static bool has(const plan *p, int32_t which, int64_t first, int64_t count)
{
    return (first >= 0) && (count >= 0) && (first + count <= p->counts[which]);
}

/* A list of numbers that are at least `low` and less than `behind`. */
static bool lists(const plan *p, list l, int64_t low, int64_t behind)
{
    int32_t i;
    if (!has(p, SEC_LISTS, l.first, l.count)) {
        return false;
    }
    for (i = 0; i < l.count; i++) {
        if (!is_within(p->lists[l.first + i], low, behind)) {
            return false;
        }
    }
    return true;
}

static bool both(const plan *p, const list *phases, int64_t low, int64_t behind)
{
    return lists(p, phases[0], low, behind) && lists(p, phases[1], low, behind);
}

/* Whether numbers ascend from 0 to the end of what they count. */
static bool ascends(const int32_t *first, int64_t count, int64_t end)
{
    int64_t i;
    if (first[0] != 0) {
        return false;
    }
    for (i = 0; i < count; i++) {
        if (first[i + 1] < first[i]) {
            return false;
        }
    }
    return first[count] == end;
}

static bool is_distance(int64_t t)
{
    return (t > -LIMIT) && (t < LIMIT);
}

static bool check_header(const plan *p)
{
    const plan_header *h = p->header;
    return (h->gap >= 0) && (h->gap < LIMIT) && (h->signals >= 0) && (h->events >= 0)
           && (h->fields >= 0) && (h->requirements >= 0) && (h->captured >= 0)
           && (h->signals < MOST / 4) && (h->events < MOST / 4)
           && (p->counts[SEC_FIELD_FIRST] == h->events + 1)
           && (p->counts[SEC_SUBSCRIPTION_FIRST] == (int64_t)h->signals + h->events + 1)
           && ascends(p->field_first, h->events, h->fields)
           && ascends(p->subscription_first, (int64_t)h->signals + h->events,
                      p->counts[SEC_SUBSCRIPTIONS]);
}

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

/* The sizes of a part. */
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
           && is_within(x->requirements, 0, (int64_t)judges + 1) && (x->fields >= 0)
           && is_within(x->timers, 0, (int64_t)nodes + 1) && is_within(x->seen, 0, (int64_t)nodes + 1)
           && is_within(x->edges, 0, (int64_t)nodes + 1)
           && is_within(x->stretches, 0, (int64_t)nodes + 1)
           && is_within(x->perishable, 0, (int64_t)x->signals.count + 1)
           && is_within(x->clocks, 1, CLOCKS_MOST + 1) && (x->undetermined >= 0) && (x->births >= 0)
           && lists(p, x->stateful, 0, nodes) && lists(p, x->networked, 0, judges)
           && lists(p, x->dead_timers, 0, nodes) && is_within(x->captured, 0, 1024)
           && is_within(x->each, 0, 2) && (x->each <= x->captured)
           && is_within(x->requirement, (x->captured > 0) ? 0 : -1, p->header->requirements)
           && lists(p, x->captures, 0, p->counts[SEC_CODE])
           && (x->each + x->captures.count == x->captured)
           && lists(p, x->varying_atoms, 0, x->atoms.count) && lists(p, x->varying_nodes, 0, nodes)
           && lists(p, x->varying, 0, nodes) && lists(p, x->lapsed, 0, nodes)
           && ((x->captured == 0) || (is_within(judges, 1, 31) && (x->requirements == 1)))
           && ((x->each == 0)
               || (is_within(x->each_event, 0, x->events.count)
                   && is_within(x->each_field, 0, p->events[x->events.first + x->each_event].fields)));
}

static bool check_inputs(const plan *p, const part_plan *x)
{
    int32_t i;
    int32_t fields = 0;
    for (i = 0; i < x->signals.count; i++) {
        const signal_plan *s = &p->signals[x->signals.first + i];
        if (!is_within(s->name, 0, p->header->signals) || !is_within(s->births, 0, 3)
            || !is_within(s->stale_after, 0, LIMIT) || !is_within(s->perishable, -1, x->perishable)
            || !both(p, s->on_change, 0, x->atoms.count) || !both(p, s->on_update, 0, x->atoms.count)
            || !lists(p, s->on_birth, 0, x->nodes.count) || !lists(p, s->needs, 0, x->atoms.count)) {
            return false;
        }
    }
    for (i = 0; i < x->events.count; i++) {
        const event_plan *e = &p->events[x->events.first + i];
        const int32_t number = e->name - p->header->signals;
        if (!is_within(number, 0, p->header->events) || (e->field != fields)
            || (e->fields != p->field_first[number + 1] - p->field_first[number])
            || (((e->flags & EVENT_KEY) != 0) && ((x->each == 0) || (i != x->each_event)))
            || !both(p, e->on_occurrence, 0, x->atoms.count)
            || !lists(p, e->needs, 0, x->atoms.count)
            || !is_within(e->key, -1, e->fields)) {
            return false;
        }
        fields += e->fields;
    }
    return fields == x->fields;
}

/* Walk a program: its stack neither runs empty nor over. `allowed`: the events of which it may read
 * fields; NULL: all. */
static bool check_program(const plan *p, const part_plan *x, int64_t place)
{
    int32_t depth = 0;
    int64_t at;
    for (at = place; is_within(at, 0, p->counts[SEC_CODE]); at++) {
        const int32_t op = p->code[at] & 255;
        const int32_t arg = p->code[at] >> 8;
        switch (op) {
        case CODE_END: return depth == 1;
        case CODE_NUMBER:
            if (!is_within(arg, 0, p->counts[SEC_NUMBERS])) {
                return false;
            }
            depth++;
            break;
        case CODE_SIGNAL:
        case CODE_PREV:
        case CODE_DELTA:
        case CODE_RATE:
            if (!is_within(arg, 0, x->signals.count)) {
                return false;
            }
            depth++;
            break;
        case CODE_CAPTURED:
            if (!is_within(arg, 0, x->captured)) {
                return false;
            }
            depth++;
            break;
        case CODE_FIELD:
            at++;
            if (!is_within(arg, 0, x->events.count) || (at >= p->counts[SEC_CODE])
                || !is_within(p->code[at], 0, p->events[x->events.first + arg].fields)) {
                return false;
            }
            depth++;
            break;
        case CODE_NEG:
        case CODE_ABS:
        case CODE_SQRT:
            if (depth < 1) {
                return false;
            }
            break;
        default:
            if (!is_within(op, CODE_ADD, CODES) || (depth < 2)) {
                return false;
            }
            depth--;
            break;
        }
        if (depth >= PROGRAM_DEPTH) {
            return false;
        }
    }
    return false;
}

static bool check_atoms(const plan *p, const part_plan *x)
{
    int32_t i;
    for (i = 0; i < x->atoms.count; i++) {
        const atom_plan *a = &p->atoms[x->atoms.first + i];
        const bool of_event = (a->op == ATOM_EVENT) || (a->op == ATOM_KNOWN_EVENT)
                              || (a->op == ATOM_UPDATED_EVENT);
        const bool of_programs = (a->op == ATOM_COMPARE) || (a->op == ATOM_PAYLOAD);
        const bool of_signal = !of_event && !of_programs && (a->op != ATOM_START);
        if (!is_within(a->op, 0, ATOMS) || !is_within(a->compare, 0, CMPS)
            || !is_within(a->momentary, 0, 256) || !both(p, a->nodes, 0, x->nodes.count)
            || (of_event && !is_within(a->input, 0, x->events.count))
            || (of_signal && !is_within(a->input, 0, x->signals.count))
            || (of_programs
                && (!check_program(p, x, a->left) || !check_program(p, x, a->right)))
            || !lists(p, a->events, 0, x->events.count)
            || (a->events.count > PAYLOAD_EVENTS_MOST)
            || ((a->op == ATOM_PAYLOAD) != (a->events.count > 0))) {
            return false;
        }
    }
    for (i = 0; i < x->captures.count; i++) {
        if (!check_program(p, x, p->lists[x->captures.first + i])) {
            return false;
        }
    }
    return true;
}

/* How many operands an operator has: at least, and at most. */
static bool check_operands(const plan *p, const part_plan *x, const node_plan *n, int32_t place)
{
    switch (n->op) {
    case NODE_LEAF:
    case NODE_UNBORN: return lists(p, n->operands, 0, 2 * (int64_t)x->signals.count);
    case NODE_CONSTANT:
    case NODE_LAPSED:
    case NODE_ELAPSED: return n->operands.count == 0;
    case NODE_AND:
    case NODE_OR: return (n->operands.count >= 1) && lists(p, n->operands, 0, place);
    case NODE_EVER:
    case NODE_EDGE:
    case NODE_STRETCH: return (n->operands.count == 2) && lists(p, n->operands, 0, place);
    default: return (n->operands.count == 1) && lists(p, n->operands, 0, place);
    }
}

/* The memory that a node has, and its timer; each timer is one node's. */
static bool check_memory(const part_plan *x, const node_plan *n, int32_t *timed_nodes)
{
    int32_t slots = 0;
    bool timed = true;
    switch (n->op) {
    case NODE_DOUBT:
    case NODE_PREVIOUS: slots = x->seen; break;
    case NODE_EVER:
        slots = x->seen;
        timed = false;
        break;
    case NODE_EDGE: slots = x->edges; break;
    case NODE_STRETCH: slots = x->stretches; break;
    case NODE_ELAPSED: break;
    default: timed = false; break;
    }
    if ((slots > 0) ? !is_within(n->slot, 0, slots) : (n->op == NODE_DOUBT) || (n->op > NODE_DOUBT)) {
        return false;
    }
    if (!timed) {
        return n->timer == -1;
    }
    (*timed_nodes)++;
    return n->timer == *timed_nodes - 1;
}

/* What a node adds to the letter of a judge, if that has a table of letters; else nothing. So no sum
 * of them leaves 32 bits; see `check_letters`. */
static bool check_weights(const plan *p, const part_plan *x, const link_plan *l)
{
    const judge_plan *j = &p->judges[x->judges.first + l->judge];
    const int64_t behind = ((j->automaton >= 0) && (j->diagram < 0)) ? MOST : 1;
    int32_t v;
    for (v = 0; v < 3; v++) {
        if (!is_within(l->worse[v], 0, behind) || !is_within(l->better[v], 0, behind)) {
            return false;
        }
    }
    return true;
}

static bool check_links(const plan *p, const part_plan *x, list links)
{
    int32_t i;
    if (!has(p, SEC_LINKS, links.first, links.count)) {
        return false;
    }
    for (i = links.first; i < links.first + links.count; i++) {
        if (!is_within(p->links[i].judge, 0, x->judges.count)
            || !check_weights(p, x, &p->links[i])) {
            return false;
        }
    }
    return true;
}

static bool check_nodes(const plan *p, const part_plan *x)
{
    int32_t timed_nodes = 0;
    int32_t i;
    for (i = 0; i < x->nodes.count; i++) {
        const node_plan *n = &p->nodes[x->nodes.first + i];
        if (!is_within(n->op, 0, NODES) || !check_operands(p, x, n, i)
            || !check_memory(x, n, &timed_nodes) || !both(p, n->parents, (int64_t)i + 1, x->nodes.count)
            || !check_links(p, x, n->links) || (n->low < 0) || (n->high < 0)
            || ((n->op == NODE_LEAF)
                && (!is_within(n->a, 0, x->atoms.count) || !is_within(n->b, 0, 3)))
            || ((n->op == NODE_CONSTANT) && !is_within(n->a, 0, 3))) {
            return false;
        }
    }
    for (i = 0; i < x->dead_timers.count; i++) {
        if (p->nodes[x->nodes.first + p->lists[x->dead_timers.first + i]].timer < 0) {
            return false;
        }
    }
    return timed_nodes == x->timers;
}

static bool has_ints(const plan *p, int64_t first, int64_t count)
{
    return has(p, SEC_INTS, first, count);
}

static bool ints_within(const plan *p, int64_t first, int64_t count, int64_t low, int64_t behind)
{
    int64_t i;
    if (!has_ints(p, first, count)) {
        return false;
    }
    for (i = 0; i < count; i++) {
        if (!is_within(p->ints[first + i], low, behind)) {
            return false;
        }
    }
    return true;
}

/* The regions of each location lead to rows that there are. */
static bool check_rows(const plan *p, const automaton_plan *a)
{
    int64_t last = 0;
    int32_t i;
    int32_t c;
    if (!has_ints(p, a->cut_first, (int64_t)a->locations * a->clocks + 1)
        || (p->ints[a->cut_first] != 0)) {
        return false;
    }
    for (i = 0; i < a->locations; i++) {
        int64_t row = p->ints[a->bases + i];
        for (c = 0; c < a->clocks; c++) {
            const int64_t at = (int64_t)i * a->clocks + c;
            const int64_t cuts = (int64_t)p->ints[a->cut_first + at + 1] - p->ints[a->cut_first + at];
            const int64_t stride = p->ints[a->strides + at];
            if ((cuts < 0) || (stride < 0) || (cuts >= MOST) || (stride >= MOST)) {
                return false;
            }
            row += cuts * stride;
            if (row >= MOST) {
                return false;
            }
        }
        if ((p->ints[a->bases + i] < 0) || (row >= a->rows)) {
            return false;
        }
        last = p->ints[a->cut_first + ((int64_t)i + 1) * a->clocks];
    }
    for (i = 0; has(p, SEC_TICKS, a->cuts, last) && (i < last); i++) {
        if (!is_within(p->ticks[a->cuts + i], 1, LIMIT + 1)) {
            return false;
        }
    }
    return has(p, SEC_TICKS, a->cuts, last);
}

/* The rule for the end of a trace. */
static bool check_clauses(const plan *p, const automaton_plan *a)
{
    int64_t clauses;
    int64_t tests;
    int64_t i;
    if (!has_ints(p, a->clause_first, (int64_t)a->locations + 1)) {
        return false;
    }
    clauses = p->ints[a->clause_first + a->locations];
    if (!ascends(&p->ints[a->clause_first], a->locations, clauses)
        || !has_ints(p, a->test_first, clauses + 1)) {
        return false;
    }
    tests = p->ints[a->test_first + clauses];
    if (!ascends(&p->ints[a->test_first], clauses, tests) || !has_ints(p, a->tests, 2 * tests)
        || !has(p, SEC_TICKS, a->ages, tests)) {
        return false;
    }
    for (i = 0; i < tests; i++) {
        if (!is_within(p->ints[a->tests + 2 * i], -1, a->clocks)
            || !is_within(p->ticks[a->ages + i], 0, LIMIT + 1)) {
            return false;
        }
    }
    return true;
}

static bool check_automaton(const plan *p, const automaton_plan *a)
{
    return is_within(a->locations, 2, MOST / CLOCKS_MOST) && is_within(a->clocks, 1, CLOCKS_MOST + 1)
           && is_within(a->initial, 0, a->locations) && is_within(a->classes, 1, MOST)
           && (a->letters >= 0) && is_within(a->rows, 1, MOST) && is_within(a->targets_count, 0, MOST)
           && ints_within(p, a->class_of, a->letters, 0, a->classes)
           && has_ints(p, a->bases, a->locations)
           && ints_within(p, a->widths, a->locations, 0, (int64_t)a->clocks + 1)
           && has_ints(p, a->strides, (int64_t)a->locations * a->clocks)
           && ((int64_t)a->rows * a->classes < MOST)
           && ints_within(p, a->edges, (int64_t)a->rows * a->classes, 0, a->targets_count)
           && ints_within(p, a->targets, a->targets_count, 0, a->locations)
           && ints_within(p, a->sources, (int64_t)a->targets_count * a->clocks, -1, a->clocks)
           && ints_within(p, a->time_values, a->rows, 0, 3) && check_rows(p, a)
           && check_clauses(p, a);
}

/* A diagram leads down to classes: each child lies behind the node that it is of. */
static bool check_diagram(const plan *p, const judge_plan *j, int64_t at, int32_t classes)
{
    const int64_t end = p->counts[SEC_INTS];
    int64_t farthest = at;
    int64_t one = at;
    while (one <= farthest) {
        int32_t children;
        int32_t i;
        if (!has_ints(p, one, 8) || !is_within(p->ints[one], 0, j->propositions.count)) {
            return false;
        }
        children = p->ints[one + 7];
        if ((children < 1) || !ints_within(p, one + 1, 6, 0, children)
            || !has_ints(p, one + 8, children)) {
            return false;
        }
        for (i = 0; i < children; i++) {
            const int32_t child = p->ints[one + 8 + i];
            if (child < 0) {
                if (!is_within(~child, 0, classes)) {
                    return false;
                }
            } else if (!is_within(child, one + 8 + children, end)) {
                return false;
            } else {
                farthest = (child > farthest) ? child : farthest;
            }
        }
        one += 8 + children;
    }
    return true;
}

/* What the letters of a judge can add up to lies in the table of classes. */
static bool check_letters(const plan *p, const part_plan *x, int32_t judge_number, int32_t letters)
{
    int64_t low[2] = {0, 0};
    int64_t high[2] = {0, 0};
    int32_t i;
    int32_t k;
    int32_t v;
    for (i = 0; i < x->nodes.count; i++) {
        const list links = p->nodes[x->nodes.first + i].links;
        for (k = links.first; k < links.first + links.count; k++) {
            const link_plan *l = &p->links[k];
            const int32_t *weights[2];
            int32_t r;
            if ((l->judge != judge_number) || ((l->kind & LINK_LETTER) == 0)) {
                continue;
            }
            weights[0] = l->worse;
            weights[1] = l->better;
            for (r = 0; r < 2; r++) {
                int32_t least_one = weights[r][0];
                int32_t most_one = weights[r][0];
                for (v = 1; v < 3; v++) {
                    least_one = (weights[r][v] < least_one) ? weights[r][v] : least_one;
                    most_one = (weights[r][v] > most_one) ? weights[r][v] : most_one;
                }
                low[r] += least_one;
                high[r] += most_one;
            }
        }
    }
    return (low[0] >= 0) && (low[1] >= 0) && (high[0] < letters) && (high[1] < letters);
}

static bool is_node(const part_plan *x, int32_t node)
{
    return is_within(node, -1, x->nodes.count);
}

static bool check_judge(const plan *p, const part_plan *x, int32_t number)
{
    const judge_plan *j = &p->judges[x->judges.first + number];
    const automaton_plan *a;
    int32_t i;
    if (!is_node(x, j->trigger) || !is_node(x, j->again) || !is_node(x, j->unborn)
        || !is_node(x, j->determined) || !is_node(x, j->running) || !is_node(x, j->blurs)
        || !is_within(j->owner, 0, x->requirements)
        || !is_within(j->requirement, 0, p->header->requirements)
        || (((j->flags & (JUDGE_EPISODIC | JUDGE_HIDDEN)) == JUDGE_EPISODIC) && (j->running < 0))
        || ((x->captures.count > 0) && (x->captured > 0) && (j->blurs >= 0) && (j->trigger < 0))
        || !lists(p, j->propositions, 0, x->nodes.count)) {
        return false;
    }
    for (i = 0; i < 8; i++) {
        if (!is_within(j->outcomes[i], 0, 16) || ((j->outcomes[i] & 3) == RV_NOT_TRIGGERED)) {
            return false;
        }
    }
    if (j->automaton < 0) {
        return (j->automaton == -1) && is_within(j->form, 0, x->forms.count) && (j->diagram == -1);
    }
    if (!is_within(j->automaton, 0, p->counts[SEC_AUTOMATA])) {
        return false;
    }
    a = &p->automata[j->automaton];
    if (a->clocks > x->clocks) {
        return false;
    }
    if (j->diagram >= 0) {
        return check_diagram(p, j, j->diagram, a->classes);
    }
    return (j->diagram == -1) && check_letters(p, x, number, a->letters);
}

static bool check_operator(const plan *p, const form_plan *f, const part_plan *x, int32_t place)
{
    const operator_plan *o = &p->operators[f->operators.first + place];
    if (!is_within(o->kind, 0, OPS) || !is_within(o->turned, 0, 2) || !is_distance(o->low)
        || !is_distance(o->high) || !is_within(o->over, -1, LIMIT)) {
        return false;
    }
    switch (o->kind) {
    case OP_LEAF:
        return is_within(o->left, 0, f->leaves) && is_node(x, o->right)
               && is_within(o->values[0], 0, 4) && is_within(o->values[1], 0, 4)
               && is_within(o->values[2], 0, 4);
    case OP_JUNCTION: return (o->operands.count >= 1) && lists(p, o->operands, 0, place);
    case OP_WINDOW:
    case OP_SHIFT: return is_within(o->left, 0, place);
    default: return is_within(o->left, 0, place) && is_within(o->right, 0, place);
    }
}

/* A chain: windows one over the other over leaves and junctions of them. */
static bool check_chain(const plan *p, const form_plan *f)
{
    const operator_plan *nodes = &p->operators[f->operators.first];
    int32_t under = f->base;
    int32_t i;
    if (!lists(p, f->windows, 0, f->operators.count) || (f->windows.count > CLOCKS_MOST)
        || (f->windows.count == 0)) {
        return f->windows.count == 0;
    }
    if (!is_within(f->base, 0, f->operators.count) || !is_within(f->left, -1, f->operators.count)
        || !is_within(f->excused, -1, f->operators.count)
        || ((f->left >= 0) && (nodes[f->left].kind != OP_LEAF))
        || ((f->excused >= 0) && ((f->left < 0) || (nodes[f->excused].kind != OP_LEAF)))
        || ((nodes[f->base].kind != OP_LEAF) && (nodes[f->base].kind != OP_JUNCTION))) {
        return false;
    }
    for (i = 0; i < f->windows.count; i++) {
        const int32_t one = p->lists[f->windows.first + i];
        const operator_plan *n = &nodes[one];
        if ((n->kind != OP_WINDOW) || (n->left != under) || (n->low < 0) || (n->high < n->low)
            || (n->over < 0) || ((p->header->gap == 0) && (n->low != 0))) {
            return false;
        }
        under = one;
    }
    return true;
}

static bool check_forms(const plan *p, const part_plan *x)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < x->forms.count; i++) {
        const form_plan *f = &p->forms[x->forms.first + i];
        if (!has(p, SEC_OPERATORS, f->operators.first, f->operators.count)
            || (f->operators.count < 1) || !is_within(f->leaves, 0, (int64_t)f->operators.count + 1)) {
            return false;
        }
        for (k = 0; k < f->operators.count; k++) {
            if (!check_operator(p, f, x, k)) {
                return false;
            }
        }
        if (!check_chain(p, f)) {
            return false;
        }
    }
    return true;
}

static bool check_numbers(const plan *p)
{
    int64_t i;
    for (i = 0; i < p->counts[SEC_NUMBERS]; i++) {
        if (!is_within(p->numbers[i].kind, RV_WHOLE, RV_REAL + 1)) {
            return false;
        }
    }
    return true;
}

/* The section of a part that is wrong. */
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
    return FINE;
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
