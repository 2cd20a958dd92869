/* Sends rounds of datagrams to connected sockets, each with the kernel's stamp of its sending and the program's own.

   send_stamped(sockets, count, rounds, kernel, send_ns, drain_ns, late_ns): kernel 1 asks for the kernel's stamps
   (SO_TIMESTAMPING) and fetches them after each round. Fills per round the time of all sends and of fetching, and per
   datagram how much later than the kernel's stamp the program's is, read right after send. Returns how many stamps were
   missing, or -1 where the system has none. */

#include <linux/net_tstamp.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#define BYTES 1120
#define NS 1000000000LL

static int64_t now_ns(int clock)
{
    struct timespec time;
    clock_gettime(clock, &time);
    return time.tv_sec * NS + time.tv_nsec;
}

static int64_t stamp_ns(int descriptor)
{
    char control[256];
    struct msghdr message = {.msg_control = control, .msg_controllen = sizeof control};
    if (recvmsg(descriptor, &message, MSG_ERRQUEUE | MSG_DONTWAIT) < 0)
        return -1;
    for (struct cmsghdr *item = CMSG_FIRSTHDR(&message); item; item = CMSG_NXTHDR(&message, item))
        if (item->cmsg_level == SOL_SOCKET && item->cmsg_type == SCM_TIMESTAMPING) {
            struct timespec time;
            memcpy(&time, CMSG_DATA(item), sizeof time);
            return time.tv_sec * NS + time.tv_nsec;
        }
    return -1;
}

int64_t send_stamped(const int64_t *sockets, int64_t count, int64_t rounds, int64_t kernel, int64_t *send_ns,
                     int64_t *drain_ns, int64_t *late_ns)
{
    int flags = SOF_TIMESTAMPING_TX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE | SOF_TIMESTAMPING_OPT_TSONLY;
    int64_t missing = 0, own[count];
    char data[BYTES];
    memset(data, 'w', BYTES);
    for (int64_t k = 0; kernel && k < count; k++)
        if (setsockopt((int)sockets[k], SOL_SOCKET, SO_TIMESTAMPING, &flags, sizeof flags))
            return -1;
    for (int64_t round = 0; round < rounds; round++) {
        int64_t began = now_ns(CLOCK_MONOTONIC);
        for (int64_t k = 0; k < count; k++) {
            send((int)sockets[k], data, BYTES, MSG_DONTWAIT | MSG_NOSIGNAL);
            own[k] = now_ns(CLOCK_MONOTONIC);
        }
        int64_t sent = now_ns(CLOCK_MONOTONIC), ahead = now_ns(CLOCK_REALTIME) - sent;
        for (int64_t k = 0; kernel && k < count; k++) {
            int64_t stamp = stamp_ns((int)sockets[k]);
            missing += stamp < 0;
            late_ns[round * count + k] = own[k] - (stamp - ahead);
        }
        drain_ns[round] = now_ns(CLOCK_MONOTONIC) - sent;
        send_ns[round] = sent - began;
    }
    return missing;
}
