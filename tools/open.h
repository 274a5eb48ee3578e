/* SPDX-License-Identifier: Apache-2.0 */
/* Opens what a command line names as a world: an image, or a scene that is compiled first. */
#ifndef FRAY_TOOLS_OPEN_H
#define FRAY_TOOLS_OPEN_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "rt/fray.h"
#include "tools/build/build.h"

struct opened {
  uint8_t *image; /* outlives the world: its constants are used in place */
  size_t image_bytes;
  void *memory;
  size_t memory_bytes;
  fray_world *world;
};

/* A file that begins with "FRAY" is an image, any other a scene. Returns 0, or 2 (the exit code)
 * after writing what is wrong to `err`; *out is then empty. */
int world_open_file(const char *path, struct opened *out, FILE *err);

/* Opens o->image, which is malloc'ed and filled. Returns as above; the image stays. */
int world_open_image(const char *path, struct opened *o, FILE *err);
void world_close(struct opened *o);

/* Compiles a scene to a malloc'ed image; NULL after a message to `err`. Shows progress. */
uint8_t *world_compile_file(const char *path, size_t *bytes, build_report *report, FILE *err);

/* A whole file, malloc'ed, with a 0 after its end; NULL after a message to `err`. */
uint8_t *world_read_file(const char *path, size_t *bytes, FILE *err);

#endif
