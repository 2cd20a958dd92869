/* A robot's client in C99 with POSIX sockets; docs/protocol.md is the protocol that it speaks, version 2 or 1.

   cc -std=c99 -O2 -o pslv_client pslv_client.c -lm
   ./pslv_client [--raw] [TEAM [NUMBER [HOST [PORT [VIEWS [OPTIONS [VX VY OMEGA]]]]]]]   OPTIONS: "(types team)"
   The variable PSLV_KEY may hold the team's key, since other users can read the words of a command. Copy the file and
   replace main: pslv_connect, then pslv_next and, for a simulated robot, pslv_drive in each step, then pslv_close. */
#define _POSIX_C_SOURCE 200112L
#include <fcntl.h>
#include <math.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { PSLV_DATAGRAM = 2048, PSLV_EDGES = PSLV_DATAGRAM / 3, AT_ONCE = 1000, NOTHING_PX = 255 };
/* Between two inits until one is answered; after an error that passes, and silence, until the session's port is asked;
   silence, until the main port is asked: the server may have been restarted; the lease where it is not told. */
static const double RETRY_S = 0.5, PATIENCE_S = 1.0, RESTART_S = 3.0, LEASE_S = 15.0;

typedef struct {
    double time_s;                    /* when the image was grabbed, since the server's start */
    int edges;                        /* number of directions */
    char letter[PSLV_EDGES];          /* type of the nearest edge */
    int px[PSLV_EDGES];               /* its distance in the mirror's image, -1: nothing within range */
    double mm[PSLV_EDGES];            /* its distance on the floor, INFINITY: nothing */
    double direction_deg[PSLV_EDGES]; /* from straight ahead */
    int ball_px, ball_deg, ball_size; /* [px], direction and size [deg]; -1 0 0: the ball is hidden */
    double ball_mm;                   /* INFINITY: hidden */
    int unseen;                       /* the camera does not see this robot now */
} pslv_view;
typedef struct {
    char error[160];     /* why the server ended the session; empty: it did not */
    char waiting[32];    /* an error that passes, as not_ready; empty: none */
    int open, version;   /* init was answered, and the mirror is known; that the server speaks, 0: not known yet */
    double lease_s;      /* the session ends when nothing was sent for so long */
    double mirror[3], fov[2], resolution; /* A, B, C; width and center of the field of view, and its steps [deg] */
    char init[800], cookie[65], boot[32];
    struct sockaddr_in main_port, server; /* server: where views come from */
    int socket;
    double heard_s, asked_s, time_s; /* last message, last init, Time of the last view */
} pslv_client;

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Read a number, with a decimal point in every locale, and move behind it. */
static int read_number(const char **at, double *value) {
    const char *text = *at + strspn(*at, " ");
    double number = 0.0, power = 0.0, sign = *text == '-' ? -1.0 : 1.0;
    int digits = 0, point = 0;
    for (text += *text == '-'; (*text >= '0' && *text <= '9') || (*text == '.' && !point); text++) {
        if (*text == '.') point = 1;
        else number = number * 10.0 + (*text - '0'), power -= point, digits++;
    }
    if (digits > 0 && *text == 'e') power += (double)strtol(text + 1, (char **)&text, 10);
    *value = sign * (power < 0.0 ? number / pow(10.0, -power) : number * pow(10.0, power));
    *at = text;
    return digits > 0 && isfinite(*value);
}

/* Read the numbers that follow a mark, as "(lease ", anywhere in a text. Returns where they end, or NULL. */
static const char *read_after(const char *text, const char *mark, int count, double *values) {
    const char *at = strstr(text, mark);
    if (at != NULL) at += strlen(mark);
    for (int i = 0; i < count && at != NULL; i++)
        if (!read_number(&at, &values[i])) at = NULL;
    return at;
}

/* Copy the word that follows a mark; none: empty. */
static void read_word(const char *text, const char *mark, char *word, size_t size) {
    const char *found = strstr(text, mark), *at = found == NULL ? "" : found + strlen(mark);
    snprintf(word, size, "%.*s", (int)strcspn(at, " ()"), at);
}

static int starts(const char *text, const char *with) { return strncmp(text, with, strlen(with)) == 0; }
static int read_mirror(pslv_client *client, const char *text, const char *mark) {
    double m[3];
    int valid = read_after(text, mark, 3, m) != NULL && m[2] > 0.0 && m[1] >= 0.0 && m[0] > m[1] * sqrt(m[2]);
    if (valid) memcpy(client->mirror, m, sizeof m);
    return valid;
}

/* Distance on the floor; the server rounds pixels down, so their middle is half a pixel more. */
static double mm_from_px(const pslv_client *client, int px) {
    double r = px + 0.5, slope = client->mirror[0] - client->mirror[1] * sqrt(client->mirror[2] + r * r);
    return px >= 0 && slope > 0.0 ? r / slope : INFINITY;
}

/* "(see Time ((edge) w2cw2c...) ((ball) px direction size) ...)"; what follows the ball may be anything. */
static int read_see(const pslv_client *client, const char *text, pslv_view *view) {
    const char *at = read_after(text, "(see ", 1, &view->time_s), *edges = " ((edge) ";
    double ball[3];
    if (at == NULL || view->time_s < 0.0 || view->time_s >= 1e10 || !starts(at, edges)) return 0;
    at += strlen(edges);
    for (view->edges = 0; view->edges < PSLV_EDGES && *at != ')'; view->edges++, at += 3) {
        int i = view->edges;
        if (*at <= ' ' || *at > '~' || *at == '(' || strspn(at + 1, "0123456789abcdef") < 2) return 0;
        view->letter[i] = *at;
        view->px[i] = (int)strtol((char[]){at[1], at[2], '\0'}, NULL, 16);
        if (view->px[i] == NOTHING_PX) view->px[i] = -1;
        view->mm[i] = mm_from_px(client, view->px[i]);
        view->direction_deg[i] = fmod(client->fov[1] - client->fov[0] / 2.0 + i * client->resolution + 720.0, 360.0);
    }
    at = *at == ')' ? read_after(at, " ((ball) ", 3, ball) : NULL;
    if (at == NULL || at[0] != ')' || at[1] == '\0' || text[strlen(text) - 1] != ')') return 0;
    if (fabs(ball[0]) > 999.0 || fabs(ball[1]) > 999.0 || fabs(ball[2]) > 999.0) return 0;
    view->ball_px = (int)ball[0], view->ball_deg = (int)ball[1], view->ball_size = (int)ball[2];
    view->ball_mm = mm_from_px(client, view->ball_px);
    view->unseen = strstr(at, "nopose") != NULL;
    return 1;
}

static void send_text(const pslv_client *client, const char *text, const struct sockaddr_in *to) {
    sendto(client->socket, text, strlen(text), 0, (const struct sockaddr *)to, sizeof *to);
}

/* Send init. Only version 1 has to be asked for the mirror. */
static void ask(pslv_client *client, const struct sockaddr_in *to) {
    char text[sizeof client->init + 100];
    snprintf(text, sizeof text, *client->cookie ? "(%s (cookie %s))%s" : "(%s%s)%s", client->init, client->cookie,
             client->version == 1 ? "(mirror)" : "");
    send_text(client, text, to), client->asked_s = now_s();
}

/* Repeat init until it is answered; then to keep the session, and to learn what a lost message would have told. */
static void ask_if_due(pslv_client *client) {
    double now = now_s(), silent_s = now - client->heard_s, wait_s = RETRY_S;
    if (silent_s >= RESTART_S) client->open = client->version = 0;
    if (client->open) wait_s = silent_s >= PATIENCE_S ? PATIENCE_S : fmax(client->lease_s / 3.0, RETRY_S);
    if (now - client->asked_s >= wait_s) ask(client, client->open ? &client->server : &client->main_port);
}

/* An error that passes: ask again a second later. Any other ends the session. No view: 0. */
static int take_error(pslv_client *client, const char *error) {
    static const char *const meanings[] = {
        "already_connected: another program has this robot, and it still runs",
        "not_admitted: the server does not serve this computer (its key admission.subnets)",
        "replaced: a newer program has this robot",
        "unknown_command: the server does not tell its mirror",
        "wrong_key: this is not the team's key",
    };
    if (!strcmp(error, "not_ready") || !strcmp(error, "rate_limited") || !strcmp(error, "not_connected")) {
        snprintf(client->waiting, sizeof client->waiting, "%s", error);
        client->open = 0;
        client->asked_s = now_s() + PATIENCE_S - RETRY_S;
        return 0;
    }
    snprintf(client->error, sizeof client->error, "error %s: see docs/protocol.md", error);
    for (size_t i = 0; i < sizeof meanings / sizeof *meanings; i++)
        if (starts(meanings[i], error)) snprintf(client->error, sizeof client->error, "error %s", meanings[i]);
    return 0;
}

/* The answer to init: facts in version 2, none in version 1, where the mirror has to be asked for. */
static void take_init(pslv_client *client, const char *text, const struct sockaddr_in *from) {
    char boot[sizeof client->boot];
    client->server = *from;
    client->version = read_after(text, "(lease ", 1, &client->lease_s) != NULL ? 2 : 1;
    read_word(text, "(boot ", boot, sizeof boot);
    if (*boot == '\0' || strcmp(boot, client->boot) != 0) client->time_s = -1.0; /* Time has begun anew */
    strcpy(client->boot, boot);
    read_after(text, "(fov ", 2, client->fov);
    read_after(text, "(resolution ", 1, &client->resolution);
    if (client->version == 2) client->open = read_mirror(client, text, "(mirror ");
    else if (!client->open) send_text(client, "(mirror)", from);
}

/* Take a message of the server; 1 for a view that is newer than the last one. */
static int take(pslv_client *client, const char *text, const struct sockaddr_in *from, pslv_view *view) {
    char word[sizeof client->cookie];
    pslv_view seen = {0};
    read_word(text, " ", word, sizeof word);
    if (starts(text, "(error ")) return take_error(client, word);
    client->heard_s = now_s(), client->waiting[0] = '\0';
    if (starts(text, "(see ") && client->open && read_see(client, text, &seen) && seen.time_s > client->time_s) {
        client->server = *from, client->time_s = seen.time_s, *view = seen;
        return 1;
    }
    if (starts(text, "(init ")) take_init(client, text, from);
    if (starts(text, "(mirror ") && read_mirror(client, text, "(mirror ") && client->version == 1) client->open = 1;
    if (starts(text, "(hear ")) read_mirror(client, text, " mirror ");
    if (starts(text, "(ping")) send_text(client, text, from);
    if (starts(text, "(challenge ")) strcpy(client->cookie, word), ask(client, from);
    if (starts(text, "(warning fixed_by_match)") && client->open && now_s() - client->asked_s >= PATIENCE_S)
        ask(client, from); /* a match has begun: its mirror and field of view are in the answer to init */
    return 0;
}

/* Read one datagram that has arrived. Returns 0 if none has, 1 for one that holds a new view, -1 for any other. */
static int receive(pslv_client *client, pslv_view *view) {
    char text[PSLV_DATAGRAM + 1];
    struct sockaddr_in from;
    socklen_t room = sizeof from;
    ssize_t size = recvfrom(client->socket, text, PSLV_DATAGRAM, 0, (struct sockaddr *)&from, &room);
    if (size < 0) return 0;
    while (size > 0 && strchr(" \t\r\n", text[size - 1]) != NULL) size--; /* NUL is found too */
    text[size] = '\0';
    if (from.sin_addr.s_addr != client->main_port.sin_addr.s_addr || text[0] != '(') return -1;
    return take(client, text, &from, view) ? 1 : -1;
}

/* Ask for a robot's views. options: as "(types team) (rate 10)", or ""; key: the team's, or "". Returns 0, or -1 with
   the reason in client->error. Whether the server answers shows pslv_next. */
int pslv_connect(pslv_client *client, const char *host, int port, const char *team, int number, const char *options,
                 const char *key) {
    struct addrinfo hints = {.ai_family = AF_INET, .ai_socktype = SOCK_DGRAM}, *found = NULL;
    *client = (pslv_client){.fov = {360.0, 180.0}, .resolution = 1.0, .lease_s = LEASE_S, .time_s = -1.0};
    int length = snprintf(client->init, sizeof client->init, *key ? "init %s %d (version 2) %s (key %s)"
                          : "init %s %d (version 2) %s%s", team, number, options, key);
    client->socket = socket(AF_INET, SOCK_DGRAM, 0);
    if (length >= (int)sizeof client->init) strcpy(client->error, "the options are too long");
    else if (getaddrinfo(host, NULL, &hints, &found) != 0) snprintf(client->error, 99, "no such host: %.60s", host);
    else if (fcntl(client->socket, F_SETFL, O_NONBLOCK) < 0) strcpy(client->error, "no socket can be opened");
    if (found != NULL) memcpy(&client->main_port, found->ai_addr, sizeof client->main_port), freeaddrinfo(found);
    client->main_port.sin_port = htons((unsigned short)port);
    if (client->error[0] == '\0') ask(client, &client->main_port);
    return client->error[0] == '\0' ? 0 : -1;
}

/* Wait for a view that is newer than the last one, and take the newest that has arrived. This keeps the session alive.
   Returns 1 for a view, 0 if none came in time, -1 when the server has ended the session: client->error says why. */
int pslv_next(pslv_client *client, pslv_view *view, double timeout_s) {
    double deadline_s = now_s() + timeout_s, left_s;
    struct pollfd wait = {client->socket, POLLIN, 0};
    for (int found = 0;;) {
        for (int i = 0, got = 1; i < AT_ONCE && got != 0 && client->error[0] == '\0'; i++)
            if ((got = receive(client, view)) == 1) found = 1;
        if (client->error[0] != '\0') return -1;
        ask_if_due(client);
        left_s = deadline_s - now_s();
        if (found || left_s <= 0.0) return found;
        poll(&wait, 1, left_s < 0.1 ? (int)(1e3 * left_s) + 1 : 100);
    }
}

/* Drive a simulated robot: forward, left [m/s], anticlockwise [rad/s]; kick: speed [m/s], or 0. Not answered. */
void pslv_drive(const pslv_client *client, double vx, double vy, double omega, double kick, int dribble) {
    char text[160]; /* in ten thousandths, since other locales have no decimal point */
    snprintf(text, sizeof text, "(drive %lde-4 %lde-4 %lde-4 (kick %lde-4)%s)", lround(1e4 * vx), lround(1e4 * vy),
             lround(1e4 * omega), lround(1e4 * kick), dribble ? " (dribble)" : "");
    send_text(client, text, &client->server);
}

/* End the session. */
void pslv_close(pslv_client *client) {
    if (client->version != 0 && client->error[0] == '\0') send_text(client, "(bye)", &client->server);
    close(client->socket);
}

static void print_view(const pslv_view *view) {
    char ahead[32] = "nothing", ball[32] = "hidden";
    if (view->edges > 0 && view->px[0] >= 0) snprintf(ahead, sizeof ahead, "%c at %d px", view->letter[0], view->px[0]);
    if (view->ball_px >= 0) snprintf(ball, sizeof ball, "%d px at %d deg", view->ball_px, view->ball_deg);
    if (view->unseen) printf("%.3f s: the camera does not see the robot\n", view->time_s);
    else printf("%.3f s: ahead %s, ball %s\n", view->time_s, ahead, ball);
}
/* Time, edges as the server sent them, the ball's pixels, direction and size, millimetres ahead and to the ball. */
static void print_raw(const pslv_view *view) {
    printf("%.3f ", view->time_s);
    for (int i = 0; i < view->edges; i++) printf("%c%02x", view->letter[i], (unsigned)view->px[i] & NOTHING_PX);
    printf(" %d %d %d", view->ball_px, view->ball_deg, view->ball_size);
    printf(view->edges > 0 && isfinite(view->mm[0]) ? " %.1f" : " -", view->mm[0]);
    printf(isfinite(view->ball_mm) ? " %.1f\n" : " -\n", view->ball_mm);
}

static volatile sig_atomic_t stopped; /* by Ctrl-C: the robot is given back with bye */
static void stop(int number) { stopped = number; }
int main(int count, char **words) {
    const char *given[9] = {"blue", "3", "127.0.0.1", "6000", "100", "", "", "0", "0"}, *key = getenv("PSLV_KEY"), *why;
    int raw = count > 1 && strcmp(words[1], "--raw") == 0, got, seen = 0;
    pslv_client client;
    pslv_view view;
    for (int i = 1 + raw; i < count && i - raw <= 9; i++) given[i - 1 - raw] = words[i];
    got = pslv_connect(&client, given[2], atoi(given[3]), given[0], atoi(given[1]), given[5], key ? key : "");
    signal(SIGINT, stop), setvbuf(stdout, NULL, _IOLBF, 0);
    while (got >= 0 && !stopped && seen < atoi(given[4])) {
        if ((got = pslv_next(&client, &view, 5.0)) > 0) {
            seen++, (raw ? print_raw : print_view)(&view);
            if (*given[6]) pslv_drive(&client, atof(given[6]), atof(given[7]), atof(given[8]), 0.0, 0);
        } else if (got == 0) {
            why = client.open ? "the camera does not see the robot" : "nothing answers at that address";
            fprintf(stderr, "no view for 5 s: %s\n", client.waiting[0] != '\0' ? client.waiting : why);
            if (seen == 0 && client.waiting[0] == '\0') break;
        }
    }
    if (client.error[0] != '\0') fprintf(stderr, "%s\n", client.error);
    pslv_close(&client);
    return got <= 0;
}
