/* A monitor on a Cortex-M4, without an operating system, a heap, or printf.
 *
 * The samples of a recording replace the sensors of a robot. Verdicts go to the debugger
 * (semihosting); on a robot they might go to a serial line.
 */
#include "rows.h" /* written by run.py: the plan, rows[] of samples, ATTEMPTS, MEMORY */

#define SYSTICK ((volatile uint32_t *)0xE000E010) /* control, reload, value */

static uint64_t block[(MEMORY + 7) / 8];

static void host(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

static void say(const char *text) { host(0x04 /* SYS_WRITE0 */, text); }

static void say_number(int64_t number)
{
    char digits[24];
    char *first = digits + sizeof digits;
    uint64_t rest = number < 0 ? -(uint64_t)number : (uint64_t)number;
    *--first = '\0';
    do {
        *--first = (char)('0' + rest % 10);
    } while (rest /= 10);
    if (number < 0) {
        *--first = '-';
    }
    say(first);
    say(" ");
}

static void tell(rv_monitor *m)
{
    static const char *const verdicts[] = {"F ", "P ", "I ", "NT "};
    const rv_record *records;
    const int64_t count = rv_records(m, &records);
    for (int64_t i = 0; i < count; i++) {
        say(REQUIREMENTS[records[i].requirement]);
        say(records[i].in_doubt ? "?" : "#");
        say_number(records[i].number);
        say(verdicts[records[i].verdict]);
        say_number(records[i].triggered);
        say_number(records[i].decided);
        say("\n");
    }
    rv_forget_records(m);
}

void reset(void)
{
    const rv_memory memory = {.block = block, .size = sizeof block};
    rv_monitor *m = rv_new(PLAN, sizeof PLAN, memory);
    const size_t begun = m == NULL ? 0 : rv_memory_used(m);
    const rv_update *updates = all_updates;
    uint32_t ticks = 0, most = 0;
    int code = m == NULL ? RV_NO_MEMORY : rv_reserve(m, ATTEMPTS);
    const size_t reserved = m == NULL ? 0 : rv_memory_used(m);
    SYSTICK[1] = 0xFFFFFF;
    for (size_t row = 0; code == RV_OK && row < sizeof rows / sizeof *rows; row++) {
        SYSTICK[2] = 0; /* writing any value resets the counter */
        SYSTICK[0] = 5; /* enable, processor clock, no interrupt */
        code = rv_step(m, rows[row].t, updates, rows[row].count);
        const uint32_t took = 0xFFFFFF - SYSTICK[2];
        ticks += took;
        most = took > most ? took : most;
        updates += rows[row].count;
        tell(m);
    }
    if (code == RV_OK) {
        code = rv_finish(m, RV_NO_TIME);
        tell(m);
    }
    say_number(code);
    say_number(ticks);
    say_number(most);
    say_number((int64_t)begun);
    say_number((int64_t)reserved);
    say_number(m == NULL ? 0 : (int64_t)rv_memory_used(m));
    say("\n");
    host(0x18 /* SYS_EXIT */, (const void *)0x20026 /* the application has ended */);
}

extern char stack_top[];
__attribute__((section(".vectors"), used)) static void *const vectors[] = {stack_top, (void *)reset};
