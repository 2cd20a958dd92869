/* Baseline of vision_core.rtdb.slots.SlotWriter: the same ring of slots, written as fast as C can.

       ring DESCRIPTOR CAPACITY SLOTS SLOT_BYTES

   Writes the only record of the shared memory block (an inherited descriptor), without checksum, with the payloads of
   bench.torn_reads.PayloadCheck: 64-bit words that follow from the sequence number and from their position. It writes
   bursts of two rounds of the ring with pauses of 0 to 20 us between them, so that some reads are overtaken in the
   middle of a copy. Prints "ready", reads the end [ns of CLOCK_MONOTONIC] from standard input, prints {"writes": n}. */

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

enum { LINE = 64, BURST = 8, LONGEST_PAUSE_NS = 20000 };
enum { BEGUN, ENDED, MEASURED, WRITTEN, LENGTH, CHECKSUM };
static const uint64_t STEP = 0x9E3779B97F4A7C15u, STRIDE = 0xD1B54A32D192ED03u, MEASURED_NS = 1000, TOOK_NS = 7;

static uint64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static void write_slot(uint8_t *memory, uint64_t sequence, uint64_t capacity, uint64_t slots, uint64_t slot_bytes)
{
    uint64_t *fields = (uint64_t *)(memory + LINE + sequence % slots * slot_bytes), *words = fields + LINE / 8;
    __atomic_store_n(&fields[BEGUN], sequence, __ATOMIC_RELAXED);
    __atomic_thread_fence(__ATOMIC_RELEASE);
    for (uint64_t k = 0; k < capacity / 8; k++) words[k] = (k + 1) * STRIDE ^ sequence * STEP;
    fields[MEASURED] = sequence * MEASURED_NS, fields[WRITTEN] = sequence * MEASURED_NS + TOOK_NS;
    fields[LENGTH] = capacity - sequence * 7919 % (capacity / 2);
    __atomic_store_n(&fields[ENDED], sequence, __ATOMIC_RELEASE);
    __atomic_store_n((uint64_t *)memory, sequence, __ATOMIC_RELEASE);
}

int main(int count, char **words)
{
    if (count != 5) {
        fprintf(stderr, "ring: %d arguments were given; accepted: DESCRIPTOR CAPACITY SLOTS SLOT_BYTES\n", count - 1);
        return 2;
    }
    uint64_t capacity = strtoull(words[2], NULL, 10), slots = strtoull(words[3], NULL, 10);
    uint64_t slot_bytes = strtoull(words[4], NULL, 10), end = 0;
    uint8_t *memory = mmap(NULL, LINE + slots * slot_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, atoi(words[1]), 0);
    if (memory == MAP_FAILED) return perror("ring: mmap"), 1;
    puts("ready"), fflush(stdout);
    if (scanf("%" SCNu64, &end) != 1) return fputs("ring: no end was found on standard input; a number [ns] was expected\n", stderr), 2;
    uint64_t sequence = *(uint64_t *)memory, first = sequence;
    for (uint64_t now = now_ns(); now < end; now = now_ns()) {
        for (int k = 0; k < BURST; k++) write_slot(memory, ++sequence, capacity, slots, slot_bytes);
        uint64_t until = now_ns() + (sequence * STEP >> 40) % LONGEST_PAUSE_NS;
        while (now_ns() < until) continue;
    }
    printf("{\"writes\": %" PRIu64 "}\n", sequence - first);
    return 0;
}
