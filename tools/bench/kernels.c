/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/kernels.h"

#include <stdlib.h>
#include <string.h>

#include "platform/linux/cpu.h"
#include "rt/state/world.h"
#include "tools/world/kernel.h"

int kernels_find(kernels *k, fray_world *w, const char *name) {
  const fray_kernel own = w->kernel;
  int good = 1;
  k->count = 0;
  if (name != NULL) {
    good = kernel_use(w, name);
    k->list[k->count++] = w->kernel;
  } else {
    for (fray_kernel n = FRAY_KERNEL_SCALAR; n <= FRAY_KERNEL_HELIUM; ++n)
      if (cpu_has(n) && fray_set_kernel(w, n)) k->list[k->count++] = n;
  }
  fray_set_kernel(w, own);
  return good;
}

fray_kernel kernels_fastest(const kernels *k) { return k->list[k->count - 1]; }

int kernels_reopen_world(const struct world_file *from, struct world_file *to) {
  memset(to, 0, sizeof *to);
  to->image = malloc(from->image_bytes);
  if (to->image == NULL) return 0;
  memcpy(to->image, from->image, from->image_bytes);
  to->image_bytes = from->image_bytes;
  if (world_file_open_image("image", to, stderr) == 0) return 1;
  world_file_close(to);
  return 0;
}
