/* Baseline of vision_core/blobs/run_lengths.py, the reference segmentation: color table, run lengths, union-find, sums.

   After Bruce, Balch and Veloso, "Fast and inexpensive color image segmentation for interactive robots", IROS 2000.
   Each row is read twice: the class of every pixel is written without a branch; then the classes are cut into runs, and
   background is skipped eight pixels at a time.
   The caller provides all memory. Returns the number of blobs, or -1 when there is not enough for runs or blobs. */

#include <stdint.h>
#include <string.h>

enum { CHUNK = 256 }; /* pixels of a row at a time */

typedef struct { int32_t y, start, end, color, parent, region; } Run;
typedef struct { int64_t area, sum_x, sum_y; int32_t left, top, right, bottom, color; } Region;
typedef struct { int32_t color, area; double x, y; int32_t left, top, right, bottom; } Blob;

static inline int32_t root(Run *runs, int32_t run) {
    while (runs[run].parent != run) run = runs[run].parent = runs[runs[run].parent].parent;
    return run;
}

static inline int32_t append(Run *runs, int32_t number, int32_t y, int32_t start, int32_t end, int32_t color,
                             int32_t above, int32_t above_end) {
    runs[number] = (Run){y, start, end, color, number, 0};
    while (above < above_end && runs[above].end < start) above++;
    for (int32_t other = above; other < above_end && runs[other].start <= end; other++)
        if (runs[other].color == color) {
            int32_t one = root(runs, number), two = root(runs, other);
            if (one < two) runs[two].parent = one; else runs[one].parent = two;
        }
    return above;
}

/* The class of each pixel of a row. Cells first, classes next: a compiler makes vector code of the first loop only where
   no look-up stands in it. */
static inline void classify(const uint8_t *restrict pixels, int32_t width, const uint8_t *restrict classes,
                            uint8_t *restrict row) {
    uint16_t cells[CHUNK];
    for (int32_t first = 0; first < width; first += CHUNK) {
        int32_t count = width - first < CHUNK ? width - first : CHUNK;
        for (int32_t i = 0; i < count; i++, pixels += 3)
            cells[i] = (pixels[0] >> 3) << 11 | (pixels[1] >> 2) << 5 | pixels[2] >> 3;
        for (int32_t i = 0; i < count; i++) row[first + i] = classes[cells[i]];
    }
}

/* Column of the next pixel from x on that is not background, or width. */
static inline int32_t skip_background(const uint8_t *row, int32_t x, int32_t width) {
    uint64_t eight;
    while (x + 8 <= width) {
        memcpy(&eight, row + x, 8);
        if (eight) return x + (__builtin_ctzll(eight) >> 3);
        x += 8;
    }
    while (x < width && !row[x]) x++;
    return x;
}

/* row: scratch of one row of pixels. */
static int32_t collect_runs(const uint8_t *pixels, int32_t width, int32_t height, const uint8_t *classes, uint8_t *row,
                            Run *runs, int32_t max_runs) {
    int32_t count = 0, above = 0, above_end = 0;
    for (int32_t y = 0; y < height; y++) {
        int32_t first = count;
        classify(pixels + 3 * (int64_t)y * width, width, classes, row);
        for (int32_t x = skip_background(row, 0, width); x < width; x = skip_background(row, x, width)) {
            int32_t start = x;
            uint8_t color = row[x];
            while (x < width && row[x] == color) x++;
            if (count == max_runs) return -1;
            above = append(runs, count++, y, start, x, color, above, above_end);
        }
        above = first;
        above_end = count;
    }
    return count;
}

int32_t segment(const uint8_t *pixels, int32_t width, int32_t height, const uint8_t *classes, int32_t min_area,
                uint8_t *row, Run *runs, Region *regions, int32_t max_runs, Blob *blobs, int32_t max_blobs) {
    int32_t found = 0, kept = 0, count = collect_runs(pixels, width, height, classes, row, runs, max_runs);
    for (int32_t i = 0; i < count; i++) {
        Run *run = runs + i;
        int32_t top = root(runs, i);
        if (top == i) {
            run->region = found;
            regions[found++] = (Region){0, 0, 0, run->start, run->y, run->end - 1, run->y, run->color};
        }
        run->region = runs[top].region;
        Region *region = regions + run->region;
        int64_t length = run->end - run->start;
        region->area += length;
        region->sum_x += (run->start + run->end - 1) * length / 2;
        region->sum_y += run->y * length;
        if (run->start < region->left) region->left = run->start;
        if (run->end - 1 > region->right) region->right = run->end - 1;
        region->bottom = run->y;
    }
    for (int32_t i = 0; i < found; i++) {
        const Region *region = regions + i;
        if (region->area < min_area) continue;
        if (kept == max_blobs) return -1;
        blobs[kept++] = (Blob){region->color, (int32_t)region->area, (double)region->sum_x / region->area,
                               (double)region->sum_y / region->area, region->left, region->top, region->right,
                               region->bottom};
    }
    return count < 0 ? -1 : kept;
}
