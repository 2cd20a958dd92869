/* Baseline of vision_core.net's compiled send: one send per connected socket, in a given order.

   Fills results with the return value of each send; returns how many datagrams were sent whole. */

#include <stdint.h>
#include <sys/socket.h>

int64_t send_in_order(const int64_t *descriptors, const int64_t *order, int64_t count, const char *text,
                      const int64_t *starts, const int64_t *lengths, int64_t *results)
{
    int64_t sent = 0;
    for (int64_t rank = 0; rank < count; rank++) {
        int64_t k = order[rank];
        results[k] = send((int)descriptors[k], text + starts[k], (size_t)lengths[k], MSG_DONTWAIT | MSG_NOSIGNAL);
        sent += results[k] == lengths[k];
    }
    return sent;
}
