/* Baseline of the frame path: capture -> perceive -> serve -> 22 clients, as four processes without the pipeline.

       handover RATE_HZ FRAMES PERCEIVE_US SERVE_US

   The publisher (SCHED_FIFO 50, as capture) writes an instant into shared memory on an absolute grid and signals an
   eventfd. Perceive (45) and serve (40) wait for their eventfd, take the newest frame and compute for PERCEIVE_US or
   SERVE_US of CPU time. Then perceive signals serve, and serve sends 22 datagrams of 1150 bytes through connected
   sockets over loopback. The receiver (SCHED_OTHER) empties the clients' sockets. A frame is delivered when the kernel
   has put the last datagram into a client's socket (kernel timestamp, converted to CLOCK_MONOTONIC), and read when the
   receiver has taken it. When SCHED_FIFO or the memory lock is refused, it reports so and continues.

   Prints JSON: {"policies": {process: policy}, "locked", "clients", "bytes", "published", "late" (releases skipped by
   the publisher), "skipped" (frames that a newer one overtook), "incomplete" (frames that some clients received, not
   all), "delivered_us": [...], "read_us": [...], "sending_us": [...]}. The lists have one entry for each frame that all
   clients received: from publishing until it was delivered, until it was read, and how long the 22 sends took. */

#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <inttypes.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CLIENTS = 22, BYTES = 1150, PROCESSES = 4 };
enum { PUBLISH, PERCEIVE, SERVE, RECEIVE };
static const char *const NAMES[PROCESSES] = {"publish", "perceive", "serve", "receive"};
static const int PRIORITIES[PROCESSES] = {50, 45, 40, 0};
static const int64_t NS_PER_S = 1000000000, SETTLE_NS = 200000000;

typedef struct { int64_t published, sending, sent, delivered, read, clients; } Frame;
typedef struct {
    _Atomic int64_t newest, perceived;
    _Atomic int stopping, ready;
    int real_time[PROCESSES], locked[PROCESSES];
    Frame frames[];
} Shared;

static Shared *shared;
static int events[PROCESSES], outgoing[CLIENTS], incoming[CLIENTS];

static int64_t clock_ns(clockid_t which)
{
    struct timespec t;
    clock_gettime(which, &t);
    return t.tv_sec * NS_PER_S + t.tv_nsec;
}

static void sleep_until(int64_t instant)
{
    struct timespec t = {instant / NS_PER_S, instant % NS_PER_S};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL) == EINTR) continue;
}

static void fail(const char *what)
{
    fprintf(stderr, "handover: %s: %s\n", what, strerror(errno));
    exit(1);
}

static void get_ready(int process)
{
    shared->locked[process] = !mlockall(MCL_CURRENT | MCL_FUTURE);
    struct sched_param priority = {PRIORITIES[process]};
    shared->real_time[process] = priority.sched_priority && !sched_setscheduler(0, SCHED_FIFO, &priority);
    shared->ready++;
}

static void raise_event(int process)
{
    if (write(events[process], &(uint64_t){1}, 8) != 8) fail("write to an eventfd");
}

static void await_event(int process)
{
    uint64_t times;
    if (read(events[process], &times, 8) != 8) fail("read from an eventfd");
}

static void be_busy(int64_t duration_ns)
{
    if (duration_ns == 0) return;
    int64_t end = clock_ns(CLOCK_THREAD_CPUTIME_ID) + duration_ns;
    while (clock_ns(CLOCK_THREAD_CPUTIME_ID) < end) continue;
}

/* Publishes count frames. Returns how many releases were skipped because they were already past. */
static int64_t publish(double rate_hz, int64_t count)
{
    int64_t period = (int64_t)(1e9 / rate_hz), release = clock_ns(CLOCK_MONOTONIC) + period, late = 0;
    for (int64_t frame = 0; frame < count; frame++) {
        sleep_until(release);
        int64_t now = clock_ns(CLOCK_MONOTONIC), past = (now - release) / period;
        late += past;
        release += (past + 1) * period;
        shared->frames[frame].published = now;
        shared->newest = frame + 1;
        raise_event(PERCEIVE);
    }
    return late;
}

static void perceive(int64_t busy_ns)
{
    for (int64_t frame = 0, last = 0; await_event(PERCEIVE), !shared->stopping; last = frame) {
        if ((frame = shared->newest) == last) continue;
        be_busy(busy_ns);
        shared->perceived = frame;
        raise_event(SERVE);
    }
}

static void serve(int64_t busy_ns)
{
    static char datagram[BYTES];
    for (int64_t frame = 0, last = 0; await_event(SERVE), !shared->stopping; last = frame) {
        if ((frame = shared->perceived) == last) continue;
        be_busy(busy_ns);
        memcpy(datagram, &frame, sizeof frame);
        shared->frames[frame - 1].sending = clock_ns(CLOCK_MONOTONIC);
        for (int k = 0; k < CLIENTS; k++) send(outgoing[k], datagram, BYTES, MSG_DONTWAIT | MSG_NOSIGNAL);
        shared->frames[frame - 1].sent = clock_ns(CLOCK_MONOTONIC);
    }
}

/* Offset from CLOCK_REALTIME, which the kernel's timestamps have, to CLOCK_MONOTONIC [ns]: the closest of three
   pairs of readings. */
static int64_t monotonic_from_realtime(void)
{
    int64_t best = INT64_MAX, offset = 0;
    for (int k = 0; k < 3; k++) {
        int64_t before = clock_ns(CLOCK_MONOTONIC), real = clock_ns(CLOCK_REALTIME);
        int64_t took = clock_ns(CLOCK_MONOTONIC) - before;
        if (took < best) best = took, offset = before + took / 2 - real;
    }
    return offset;
}

static void take(int descriptor)
{
    char datagram[BYTES], extra[CMSG_SPACE(sizeof(struct timespec))];
    struct iovec part = {datagram, sizeof datagram};
    for (;;) {
        struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1, .msg_control = extra, .msg_controllen = sizeof extra};
        if (recvmsg(descriptor, &message, MSG_DONTWAIT) != BYTES) return;
        int64_t now = clock_ns(CLOCK_MONOTONIC), number, delivered = now;
        struct cmsghdr *header = CMSG_FIRSTHDR(&message);
        if (header && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_TIMESTAMPNS) {
            struct timespec stamp;
            memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
            delivered = stamp.tv_sec * NS_PER_S + stamp.tv_nsec + monotonic_from_realtime();
        }
        memcpy(&number, datagram, sizeof number);
        Frame *frame = &shared->frames[number - 1];
        if (delivered > frame->delivered) frame->delivered = delivered;
        frame->read = now, frame->clients++;
    }
}

static void receive(void)
{
    int poller = epoll_create1(0);
    struct epoll_event found[CLIENTS + 1], stop = {EPOLLIN, {.fd = -1}};
    if (epoll_ctl(poller, EPOLL_CTL_ADD, events[RECEIVE], &stop)) fail("epoll_ctl");
    for (int k = 0; k < CLIENTS; k++) {
        struct epoll_event event = {EPOLLIN, {.fd = incoming[k]}};
        if (epoll_ctl(poller, EPOLL_CTL_ADD, incoming[k], &event)) fail("epoll_ctl");
    }
    while (!shared->stopping) {
        int count = epoll_wait(poller, found, CLIENTS + 1, -1);
        for (int k = 0; k < count; k++)
            if (found[k].data.fd >= 0) take(found[k].data.fd);
    }
}

static void connect_clients(void)
{
    for (int k = 0; k < CLIENTS; k++) {
        struct sockaddr_in place = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
        socklen_t size = sizeof place;
        incoming[k] = socket(AF_INET, SOCK_DGRAM, 0), outgoing[k] = socket(AF_INET, SOCK_DGRAM, 0);
        if (incoming[k] < 0 || outgoing[k] < 0) fail("socket");
        if (bind(incoming[k], (struct sockaddr *)&place, size)) fail("bind");
        if (setsockopt(incoming[k], SOL_SOCKET, SO_TIMESTAMPNS, &(int){1}, sizeof(int))) fail("SO_TIMESTAMPNS");
        if (getsockname(incoming[k], (struct sockaddr *)&place, &size)) fail("getsockname");
        if (connect(outgoing[k], (struct sockaddr *)&place, size)) fail("connect");
    }
}

static void start(int process, int64_t busy_ns, pid_t parent)
{
    pid_t child = fork();
    if (child < 0) fail("fork");
    if (child) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    get_ready(process);
    if (process == PERCEIVE) perceive(busy_ns);
    else if (process == SERVE) serve(busy_ns);
    else receive();
    _exit(0);
}

static int64_t field_of(const Frame *frame, size_t offset)
{
    return *(const int64_t *)((const char *)frame + offset);
}

static void print_times(const char *name, int64_t count, size_t from, size_t to)
{
    const char *comma = "";
    printf(", \"%s\": [", name);
    for (int64_t k = 0; k < count; k++) {
        const Frame *frame = &shared->frames[k];
        if (frame->clients != CLIENTS) continue;
        printf("%s%.1f", comma, (double)(field_of(frame, to) - field_of(frame, from)) / 1e3), comma = ", ";
    }
    printf("]");
}

static void report(int64_t count, int64_t late)
{
    int64_t skipped = 0, incomplete = 0;
    int locked = 1;
    for (int64_t k = 0; k < count; k++) {
        skipped += shared->frames[k].clients == 0;
        incomplete += shared->frames[k].clients > 0 && shared->frames[k].clients < CLIENTS;
    }
    printf("{\"policies\": {");
    for (int k = 0; k < PROCESSES; k++) {
        locked &= shared->locked[k];
        printf("%s\"%s\": \"", k ? ", " : "", NAMES[k]);
        if (shared->real_time[k]) printf("SCHED_FIFO %d\"", PRIORITIES[k]);
        else printf("SCHED_OTHER%s\"", PRIORITIES[k] ? ", SCHED_FIFO was refused" : "");
    }
    printf("}, \"locked\": %s, \"clients\": %d, \"bytes\": %d, \"published\": %" PRId64, locked ? "true" : "false",
           CLIENTS, BYTES, count);
    printf(", \"late\": %" PRId64 ", \"skipped\": %" PRId64 ", \"incomplete\": %" PRId64, late, skipped, incomplete);
    print_times("delivered_us", count, offsetof(Frame, published), offsetof(Frame, delivered));
    print_times("read_us", count, offsetof(Frame, published), offsetof(Frame, read));
    print_times("sending_us", count, offsetof(Frame, sending), offsetof(Frame, sent));
    puts("}");
}

int main(int argc, char **words)
{
    double rate_hz = argc == 5 ? atof(words[1]) : 0.0;
    int64_t count = argc == 5 ? atoll(words[2]) : 0, busy_us[2] = {0, 0};
    if (argc == 5) busy_us[0] = atoll(words[3]), busy_us[1] = atoll(words[4]);
    if (!(rate_hz > 0.0 && rate_hz <= 10000.0) || count < 1 || busy_us[0] < 0 || busy_us[1] < 0) {
        fprintf(stderr, "handover: %d arguments; accepted: RATE_HZ to 10000, FRAMES >= 1, PERCEIVE_US and SERVE_US >= 0\n",
                argc - 1);
        return 2;
    }
    size_t size = sizeof(Shared) + (size_t)count * sizeof(Frame);
    shared = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) fail("mmap");
    memset(shared, 0, size);
    for (int k = 0; k < PROCESSES; k++)
        if ((events[k] = eventfd(0, EFD_CLOEXEC)) < 0) fail("eventfd");
    connect_clients();
    pid_t parent = getpid();
    for (int k = PERCEIVE; k <= RECEIVE; k++) start(k, k == RECEIVE ? 0 : busy_us[k - PERCEIVE] * 1000, parent);
    get_ready(PUBLISH);
    while (shared->ready < PROCESSES) sleep_until(clock_ns(CLOCK_MONOTONIC) + 1000000);
    int64_t late = publish(rate_hz, count);
    sleep_until(clock_ns(CLOCK_MONOTONIC) + SETTLE_NS);
    shared->stopping = 1;
    for (int k = PERCEIVE; k <= RECEIVE; k++) raise_event(k);
    int status, failed = 0;
    while (wait(&status) > 0) failed |= status;
    report(count, late);
    return failed ? 1 : 0;
}
