/* Twin of vision_core.pipeline.view_encoder.encode_views for robots that are circles and clients with the paper's options:
   a world in; every robot's edges by angular splat, the ball's visible share, pixels and characters out. */

#include <math.h>
#include <stdint.h>
#include <string.h>

#define RAYS 360
#define MOST_ROBOTS 64
#define SLOT 1408
#define HEAD 32
#define SLIVER 1e-9
#define ON_THE_LINE 1e-6
#define CORNER 1e-9
#define PARALLEL 1e-12

typedef struct {
    double x, y, heading, cosine, sine;
    int32_t kind, viewer;
} body;

typedef struct {
    double a, b, c, d, radius, ball_radius, limit_x, limit_y;
    int64_t segments, solid;
} place;

static double segment_reach(double ux, double uy, double x1, double y1, double x2, double y2)
{
    double ex = x2 - x1, ey = y2 - y1;
    double slant = ux * ey - uy * ex, aside = x1 * uy - y1 * ux, length = hypot(ex, ey);
    if (fabs(slant) <= PARALLEL * length) {
        if (fabs(aside) > PARALLEL * (fabs(x1) + fabs(y1))) return INFINITY;
        double first = x1 * ux + y1 * uy, second = x2 * ux + y2 * uy;
        if (fmax(first, second) < 0.0) return INFINITY;
        return fmax(fmin(first, second), 0.0);
    }
    double share = aside / slant;
    if (share < -CORNER || share > 1.0 + CORNER) return INFINITY;
    double distance = (x1 * ey - y1 * ex) / slant;
    return distance >= 0.0 ? distance : INFINITY;
}

static void try_segment(double x1, double y1, double x2, double y2, uint8_t kind, int64_t start, int64_t end,
                        const double *ux, const double *uy, double *distances, uint8_t *kinds)
{
    for (int64_t i = start; i < end; i++) {
        double reach = segment_reach(ux[i], uy[i], x1, y1, x2, y2);
        if (reach < distances[i]) distances[i] = reach, kinds[i] = kind;
    }
}

static void meet_line(double cross, double ex, double ey, uint8_t kind, int64_t start, int64_t end,
                      const double *restrict ux, const double *restrict uy, double *restrict distances,
                      uint8_t *restrict kinds)
{
    for (int64_t i = start; i < end; i++) {
        double reach = cross / (ux[i] * ey - uy[i] * ex);
        int nearer = reach < distances[i];
        distances[i] = nearer ? reach : distances[i];
        kinds[i] = nearer ? kind : kinds[i];
    }
}

static int64_t wrapped(int64_t ray)
{
    ray %= RAYS;
    return ray < 0 ? ray + RAYS : ray;
}

static void splat_segment(double x1, double y1, double x2, double y2, uint8_t kind, double heading, const double *ux,
                          const double *uy, double *distances, uint8_t *kinds)
{
    double ex = x2 - x1, ey = y2 - y1, cross = x1 * ey - y1 * ex;
    if (fabs(cross) <= ON_THE_LINE * sqrt(ex * ex + ey * ey)) {
        try_segment(x1, y1, x2, y2, kind, 0, RAYS, ux, uy, distances, kinds);
        return;
    }
    double per_rad = RAYS / (2.0 * M_PI);
    double opening = atan2(cross, x1 * x2 + y1 * y2) * per_rad;
    double low = (atan2(y1, x1) - heading) * per_rad + fmin(opening, 0.0);
    int64_t first = (int64_t)floor(low), last = (int64_t)ceil(low + fabs(opening)), inner = last - first - 1;
    first = wrapped(first), last = wrapped(last);
    try_segment(x1, y1, x2, y2, kind, first, first + 1, ux, uy, distances, kinds);
    try_segment(x1, y1, x2, y2, kind, last, last + 1, ux, uy, distances, kinds);
    int64_t start = first + 1, end = first + 1 + inner;
    meet_line(cross, ex, ey, kind, start, end < RAYS ? end : RAYS, ux, uy, distances, kinds);
    meet_line(cross, ex, ey, kind, start > RAYS ? start - RAYS : 0, end - RAYS, ux, uy, distances, kinds);
}

static void meet_circle(double x, double y, double radius, uint8_t kind, int64_t start, int64_t end,
                        const double *restrict ux, const double *restrict uy, double *restrict distances,
                        uint8_t *restrict kinds)
{
    double square = radius * radius;
    for (int64_t i = start; i < end; i++) {
        double along = x * ux[i] + y * uy[i], aside = x * uy[i] - y * ux[i], depth = square - aside * aside;
        if (depth >= 0.0 && along > 0.0) {
            double reach = along - sqrt(depth);
            if (reach < distances[i]) distances[i] = reach, kinds[i] = kind;
        }
    }
}

static void splat_circle(double x, double y, double radius, uint8_t kind, double heading, const double *ux,
                         const double *uy, double *distances, uint8_t *kinds)
{
    double per_rad = RAYS / (2.0 * M_PI);
    double middle = (atan2(y, x) - heading) * per_rad;
    double half = asin(fmin(radius / sqrt(x * x + y * y), 1.0)) * per_rad;
    int64_t first = (int64_t)ceil(middle - half - 0.5), rays = (int64_t)floor(middle + half + 0.5) - first + 1;
    if (rays > RAYS) rays = RAYS;
    first = wrapped(first);
    int64_t end = first + rays;
    meet_circle(x, y, radius, kind, first, end < RAYS ? end : RAYS, ux, uy, distances, kinds);
    if (end > RAYS) meet_circle(x, y, radius, kind, 0, end - RAYS, ux, uy, distances, kinds);
}

static int holder(const body *bodies, int count, int own, double radius)
{
    int found = -1;
    double nearest = INFINITY;
    for (int k = 0; k < count; k++) {
        double dx = bodies[own].x - bodies[k].x, dy = bodies[own].y - bodies[k].y;
        if (k == own || fabs(dx) > 1.5 * radius || fabs(dy) > 1.5 * radius) continue;
        double away = hypot(dx, dy);
        if (away <= radius && away <= nearest) found = k, nearest = away;
    }
    return found;
}

static double turn(double angle)
{
    angle = fmod(angle + M_PI, 2.0 * M_PI);
    return (angle < 0.0 ? angle + 2.0 * M_PI : angle) - M_PI;
}

static int hide(double direction, double half, double azimuth, double alpha, double *lows, double *highs, int count)
{
    double offset = turn(direction - azimuth);
    if (half > 0.0 && offset - half < alpha && offset + half > -alpha) {
        lows[count] = fmax(offset - half, -alpha), highs[count] = fmin(offset + half, alpha);
        return count + 1;
    }
    return count;
}

static void segment_shadow(double x1, double y1, double x2, double y2, double within, double *direction, double *half)
{
    double ex = x2 - x1, ey = y2 - y1, square = ex * ex + ey * ey, middle = -(x1 * ex + y1 * ey) / square;
    double aside = x1 * ey - y1 * ex, room = within * within * square - aside * aside;
    *direction = *half = 0.0;
    if (room <= 0.0) return;
    double half_chord = sqrt(room) / square, start = fmax(middle - half_chord, 0.0), end = fmin(middle + half_chord, 1.0);
    if (start >= end) return;
    double first = atan2(y1 + start * ey, x1 + start * ex);
    double opening = turn(atan2(y1 + end * ey, x1 + end * ex) - first);
    *direction = first + opening / 2.0, *half = fabs(opening) / 2.0;
}

static void circle_shadow(double x, double y, double radius, double within, double *direction, double *half)
{
    double away = hypot(x, y);
    *direction = *half = 0.0;
    if (away - radius >= within) return;
    if (within * within >= away * away - radius * radius) *half = asin(radius / away);
    else *half = acos(fmin((away * away + within * within - radius * radius) / (2.0 * away * within), 1.0));
    *direction = atan2(y, x);
}

static double ball_share(const body *bodies, int count, int own, const place *p, const double (*segments)[4],
                         double bx, double by)
{
    static double lows[256], highs[256];
    double x = bodies[own].x, y = bodies[own].y, within = hypot(bx, by), direction, half;
    if (within <= p->ball_radius) return 1.0;
    if (holder(bodies, count, own, p->radius) >= 0) return 0.0;
    double azimuth = atan2(by, bx), sine = p->ball_radius / within, alpha = asin(sine);
    double tx = bx / within, ty = by / within, cosine = sqrt(1.0 - sine * sine);
    int hidden = 0;
    for (int64_t k = 0; k < p->solid; k++) {
        const double *s = segments[k];
        segment_shadow(s[0] - x, s[1] - y, s[2] - x, s[3] - y, within, &direction, &half);
        hidden = hide(direction, half, azimuth, alpha, lows, highs, hidden);
    }
    for (int k = 0; k < count; k++) {
        double dx = bodies[k].x - x, dy = bodies[k].y - y, along = dx * tx + dy * ty, aside = fabs(dx * ty - dy * tx);
        if (k == own || aside * cosine - along * sine > p->radius + SLIVER || along - p->radius > within) continue;
        circle_shadow(dx, dy, p->radius, within, &direction, &half);
        hidden = hide(direction, half, azimuth, alpha, lows, highs, hidden);
    }
    double visible = 0.0, here = -alpha;
    while (here < alpha) {
        double further = here, gap_end = alpha;
        for (int k = 0; k < hidden; k++) {
            if (lows[k] <= here + SLIVER) further = fmax(further, highs[k]);
            else gap_end = fmin(gap_end, lows[k]);
        }
        if (further > here) here = further;
        else visible += gap_end - here, here = gap_end;
    }
    if (visible >= 2.0 * alpha - SLIVER) return 1.0;
    return visible > SLIVER ? visible / (2.0 * alpha) : 0.0;
}

static void edges(const body *bodies, int count, int own, const place *p, const double (*segments)[4],
                  const uint8_t *segment_kinds, const double *ray_x, const double *ray_y, double *ux, double *uy,
                  double *distances, uint8_t *kinds)
{
    double c = bodies[own].cosine, s = bodies[own].sine, x = bodies[own].x, y = bodies[own].y;
    for (int i = 0; i < RAYS; i++) ux[i] = ray_x[i] * c - ray_y[i] * s, uy[i] = ray_x[i] * s + ray_y[i] * c;
    int over = holder(bodies, count, own, p->radius);
    for (int i = 0; i < RAYS; i++) distances[i] = over >= 0 ? p->radius : INFINITY;
    memset(kinds, over >= 0 ? bodies[over].kind : 0, RAYS);
    if (over >= 0) return;
    int inside = fabs(x) <= p->limit_x && fabs(y) <= p->limit_y;
    for (int64_t k = 0; k < (inside ? p->segments : p->solid); k++) {
        const double *e = segments[k];
        splat_segment(e[0] - x, e[1] - y, e[2] - x, e[3] - y, segment_kinds[k], bodies[own].heading, ux, uy, distances,
                      kinds);
    }
    for (int k = 0; k < count; k++)
        if (k != own)
            splat_circle(bodies[k].x - x, bodies[k].y - y, p->radius, (uint8_t)bodies[k].kind, bodies[own].heading, ux,
                         uy, distances, kinds);
    for (int i = 0; i < RAYS; i++) distances[i] = distances[i] > p->radius ? distances[i] : p->radius;
}

static void mirror(const double *restrict distances, const place *p, uint8_t *restrict px)
{
    for (int i = 0; i < RAYS; i++) {
        double mm = (distances[i] < 1e6 ? distances[i] : 1e6) * 1000.0;
        int32_t pixels = (int32_t)(p->d * mm / (p->a + p->b * sqrt(p->c + p->d * (mm * mm))));
        px[i] = distances[i] == INFINITY ? 255 : (uint8_t)pixels;
    }
}

static char *number(char *to, int value)
{
    if (value < 0) *to++ = '-', value = -value;
    if (value >= 100) *to++ = (char)('0' + value / 100);
    if (value >= 10) *to++ = (char)('0' + value / 10 % 10);
    *to++ = (char)('0' + value % 10);
    return to;
}

static int64_t write_see(int64_t time_us, const uint8_t *px, const uint8_t *kinds, const int ball[3],
                         const uint32_t *hex, const uint8_t *letters, char *slot, int64_t *start)
{
    char *at = slot + HEAD - 9;
    int64_t seconds = time_us / 1000000, fraction = time_us % 1000000 / 1000;
    memcpy(at, " ((edge) ", 9);
    for (int k = 0; k < 3; k++, fraction /= 10) *--at = (char)('0' + fraction % 10);
    *--at = '.';
    do *--at = (char)('0' + seconds % 10);
    while (seconds /= 10);
    at -= 5;
    memcpy(at, "(see ", 5);
    uint32_t *words = (uint32_t *)(slot + HEAD);
    for (int i = 0; i < RAYS; i += 4, words += 3) {
        uint32_t one = hex[px[i]] | letters[kinds[i]], two = hex[px[i + 1]] | letters[kinds[i + 1]];
        uint32_t three = hex[px[i + 2]] | letters[kinds[i + 2]], four = hex[px[i + 3]] | letters[kinds[i + 3]];
        words[0] = one | two << 24, words[1] = two >> 8 | three << 16, words[2] = three >> 16 | four << 8;
    }
    char *end = (char *)words;
    memcpy(end, ") ((ball) ", 10);
    end = number(end + 10, ball[0]);
    *end++ = ' ';
    end = number(end, ball[1]);
    *end++ = ' ';
    end = number(end, ball[2]);
    *end++ = ')', *end++ = ')';
    *start = at - slot;
    return end - at;
}

/* bodies: the world's robots with their viewer; page: px and kinds of every robot; slots, starts, lengths: by robot. */
void encode_views(body *bodies, int64_t count, const double *ball, int64_t time_ns, const place *p,
                    const double (*segments)[4], const uint8_t *segment_kinds, const double *ray_x,
                    const double *ray_y, const uint32_t *hex, const uint8_t *letters, uint8_t *page, char *slots,
                    int64_t *starts, int64_t *lengths)
{
    static double ux[RAYS], uy[RAYS], distances[RAYS];
    for (int64_t k = 0; k < count; k++)
        bodies[k].cosine = cos(bodies[k].heading), bodies[k].sine = sin(bodies[k].heading);
    for (int own = 0; own < count; own++) {
        uint8_t *px = page + (size_t)own * 2 * RAYS, *kinds = px + RAYS;
        edges(bodies, (int)count, own, p, segments, segment_kinds, ray_x, ray_y, ux, uy, distances, kinds);
        mirror(distances, p, px);
        double bx = ball[0] - bodies[own].x, by = ball[1] - bodies[own].y, away = hypot(bx, by);
        int words[3] = {-1, 0, 0};
        if (ball_share(bodies, (int)count, own, p, segments, bx, by) > 0.0) {
            double size = away <= p->ball_radius ? 180.0 : 2.0 * asin(p->ball_radius / away) * (180.0 / M_PI);
            double turned = fmod((atan2(by, bx) - bodies[own].heading) * (180.0 / M_PI), 360.0), mm = away * 1000.0;
            turned = turned < 0.0 ? turned + 360.0 : turned;
            words[0] = (int)(p->d * mm / (p->a + p->b * sqrt(p->c + p->d * (mm * mm))));
            words[1] = (int)floor(turned + 0.5) % 360;
            words[2] = (int)fmax(floor(size + 0.5), 1.0);
        }
        lengths[own] = write_see(time_ns / 1000, px, kinds, words, hex, letters, slots + (size_t)own * SLOT,
                                 &starts[own]);
        starts[own] += own * SLOT;
    }
}
