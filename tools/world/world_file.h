/* SPDX-License-Identifier: Apache-2.0 */
/* Opens a file of the command line as a world: an image, or a scene, which is compiled first. */
#ifndef FRAY_TOOLS_WORLD_WORLD_FILE_H
#define FRAY_TOOLS_WORLD_WORLD_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "rt/fray.h"
#include "tools/scene_compiler/compile.h"

struct world_file {
  uint8_t *image; /* outlives the world: its constants are used in place */
  size_t image_bytes;
  void *memory;
  size_t memory_bytes;
  fray_world *world;
};

/* A file that begins with "FRAY" is an image, any other a scene. Returns 0, or 2 (the exit code)
 * after a message to `err`; *out is then empty. */
int world_file_open(const char *path, struct world_file *out, FILE *err);

/* Opens o->image, which is malloc'ed and filled. Returns as above; the image stays. */
int world_file_open_image(const char *path, struct world_file *o, FILE *err);
void world_file_close(struct world_file *o);

/* Compiles a scene to a malloc'ed image; NULL after a message to `err`. Shows progress. */
uint8_t *world_file_compile(const char *path, size_t *bytes, compile_report *report, FILE *err);

/* A whole file of at most `most` bytes, malloc'ed, with a 0 after its end; NULL after a message to `err`. */
uint8_t *world_file_read(const char *path, uint64_t most, size_t *bytes, FILE *err);

#endif
