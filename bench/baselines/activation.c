/* Baseline of the executive's periodic release: a program that wakes on an absolute grid of CLOCK_MONOTONIC.

       activation PERIOD_NS COUNT PRIORITY [FIRST_NS [EARLY_NS]]

   Release k is due at FIRST_NS + k * PERIOD_NS; without FIRST_NS the first is due one period after the start. With
   EARLY_NS it wakes so long before each release and polls the clock until the release is due, as the executive does.
   Releases that are already past are skipped and counted, as the executive does. With PRIORITY over 0 it asks for
   SCHED_FIFO and locks its memory; when that is refused, it reports so and continues.

   Prints JSON: {"policy", "locked", "refused", "first_ns", "period_ns", "skipped", "wakes_ns": [...]}. */

#include <errno.h>
#include <inttypes.h>
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

static const int64_t NS_PER_S = 1000000000;

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * NS_PER_S + t.tv_nsec;
}

static void sleep_until(int64_t instant)
{
    struct timespec t = {instant / NS_PER_S, instant % NS_PER_S};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL) == EINTR) continue;
}

/* Runs count releases and notes when it woke for each [ns]. Returns how many releases were skipped. */
static int64_t run(int64_t first, int64_t period, int64_t count, int64_t early, int64_t *wakes)
{
    int64_t release = first, skipped = 0;
    for (int64_t k = 0; k < count; k++) {
        sleep_until(release - early);
        do wakes[k] = now_ns();
        while (wakes[k] < release);
        int64_t past = (wakes[k] - release) / period;
        skipped += past;
        release += (past + 1) * period;
    }
    return skipped;
}

int main(int count, char **words)
{
    int64_t period = count > 1 ? atoll(words[1]) : 0, wanted = count > 2 ? atoll(words[2]) : 0;
    int priority = count > 3 ? atoi(words[3]) : -1;
    int64_t early = count > 5 ? atoll(words[5]) : 0;
    if (count < 4 || count > 6 || early < 0 || period < 1 || wanted < 1 || priority < 0 || priority > 99) {
        fprintf(stderr, "activation: %d arguments; accepted: PERIOD_NS >= 1, COUNT >= 1, PRIORITY 0 to 99 "
                "[FIRST_NS [EARLY_NS >= 0]]\n",
                count - 1);
        return 2;
    }
    int64_t *wakes = malloc((size_t)wanted * sizeof *wakes);
    if (!wakes) return fputs("activation: no memory for the wakes\n", stderr), 1;
    memset(wakes, 0, (size_t)wanted * sizeof *wakes);
    const char *refused = NULL;
    int locked = 0;
    if (priority) {
        if (mlockall(MCL_CURRENT | MCL_FUTURE)) refused = "mlockall";
        else locked = 1;
        if (sched_setscheduler(0, SCHED_FIFO, &(struct sched_param){priority})) refused = "SCHED_FIFO";
    }
    int64_t first = count > 4 ? atoll(words[4]) : now_ns() + period;
    int64_t skipped = run(first, period, wanted, early, wakes);
    printf("{\"policy\": \"%s\", \"locked\": %s, ", sched_getscheduler(0) == SCHED_FIFO ? "SCHED_FIFO" : "SCHED_OTHER",
           locked ? "true" : "false");
    if (refused) printf("\"refused\": \"%s\", ", refused);
    else printf("\"refused\": null, ");
    printf("\"first_ns\": %" PRId64 ", \"period_ns\": %" PRId64 ", \"skipped\": %" PRId64 ", \"wakes_ns\": [", first,
           period, skipped);
    for (int64_t k = 0; k < wanted; k++) printf("%s%" PRId64, k ? ", " : "", wakes[k]);
    puts("]}");
    return 0;
}
