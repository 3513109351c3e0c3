/* A sheet falls on a ball that this program moves, in memory that it owns.
 *
 *     drape SCENE
 *
 * SCENE is drape.toml, cooked with room for a hand and with impulses. */
#include <muslin.h>
#include <stdio.h>
#include <stdlib.h>

static int fail(const char *what, MuslinStatus status) {
    fprintf(stderr, "%s: %s\n", what, muslin_message(status));
    return 1;
}

/* A file, at an address that is a multiple of 32. */
static unsigned char *load(const char *path, size_t *length) {
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    *length = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = aligned_alloc(32, (*length + 31) / 32 * 32);
    if (bytes && fread(bytes, 1, *length, file) != *length) {
        free(bytes);
        bytes = NULL;
    }
    fclose(file);
    return bytes;
}

int main(int count, char **words) {
    size_t length = 0, needed = 0, vertices = 0;
    unsigned char *scene = count == 2 ? load(words[1], &length) : NULL;
    if (!scene) {
        fprintf(stderr, "usage: drape SCENE, a file of `muslin cook drape.toml --impulses -o SCENE`\n");
        return 2;
    }
    MuslinStatus status = muslin_required_bytes(scene, length, &needed);
    if (status) return fail(words[1], status);
    unsigned char *memory = aligned_alloc(32, (needed + 31) / 32 * 32);
    MuslinCloth *cloth = NULL;
    status = muslin_open(scene, length, memory, needed, &cloth);
    if (status) return fail(words[1], status);

    const float *positions = muslin_positions(cloth, &vertices); /* stays valid */
    const double step = muslin_step_length(cloth);
    const MuslinBudget budget = {2000, 100000};
    MuslinReport report;
    for (int n = 1; n <= 120; n++) {
        /* The ball rises by 10 cm in a second. */
        MuslinPose pose = {{0, 0.1 * n * step, 0}, {0, 0, 0, 1}};
        status = muslin_move_collider(cloth, 0, &pose, step);
        if (!status) status = muslin_step(cloth, &budget, &report);
        if (status) {
            char words_of_it[200];
            muslin_error(cloth, words_of_it, sizeof words_of_it);
            fprintf(stderr, "%s\n", words_of_it);
            return fail("a step", status);
        }
        if (n % 30 == 0) {
            MuslinImpulse impulse;
            float lowest = positions[1];
            for (size_t i = 0; i < vertices; i++)
                if (positions[3 * i + 1] < lowest) lowest = positions[3 * i + 1];
            status = muslin_take_impulse(cloth, 0, &impulse);
            if (status) return fail("the impulse", status);
            printf("%.2f s: %u contacts, %u iterations, lowest %.3f m, %.2f N on the ball\n", muslin_time(cloth), report.contacts,
                   report.iterations, lowest, impulse.linear[1] / (30 * step));
        }
    }
    printf("hash %016llx\n", (unsigned long long)muslin_hash(cloth));
    free(memory);
    free(scene);
    return 0;
}
