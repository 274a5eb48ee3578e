/* SPDX-License-Identifier: Apache-2.0 */
/* fray scene: compiles a text scene to an image, or to a C array for firmware. */
#include "tools/cmd/cmd.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/output_file.h"
#include "rt/state/world.h"
#include "tools/world/world_file.h"
#include "tools/terminal/options.h"
#include "tools/analysis/scaled_stiffness.h"
#include "tools/analysis/yarn_level.h"

enum { FALL_STEPS_MIN = 16 };

static void print_usage(FILE *out) {
  fprintf(out,
          "usage: fray scene X.scene [-o X.img] [--emit-c NAME]\n\n"
          "Compiles a scene to an image. Where the scene leaves substeps or iterations open, finds\n"
          "them by test runs and prints them. Prints the strain of woven cloth at rest, beside what it\n"
          "may be. The same scene gives the same bytes everywhere.\n\n"
          "  -o FILE         the image (default: the scene's name with .img, or .c)\n"
          "  --emit-c NAME   writes a C array `NAME`, and `NAME_bytes`, instead of the bytes\n\n"
          "exit: 0 good, 1 writing failed, 2 wrong use or unreadable input\n");
}

/* Letters, digits and underscores, and no keyword of C. */
static int is_identifier(const char *name) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_";
  static const char *const taken[] = {"auto", "break", "case", "char", "const", "continue",
                                      "default", "do", "double", "else", "enum", "extern", "float",
                                      "for", "goto", "if", "inline", "int", "long", "register",
                                      "restrict", "return", "short", "signed", "sizeof", "static",
                                      "struct", "switch", "typedef", "union", "unsigned", "void",
                                      "volatile", "while"};
  for (size_t n = 0; n < sizeof taken / sizeof taken[0]; ++n)
    if (strcmp(name, taken[n]) == 0) return 0;
  const size_t length = strlen(name);
  return length > 0 && strspn(name, letters) > 0 &&
         strspn(name + 1, "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_") ==
             length - 1;
}

static void write_c(FILE *out, const char *name, const uint8_t *image, size_t bytes) {
  fprintf(out,
          "#include <stdint.h>\n\nextern const uint8_t %s[%zu];\nextern const uint32_t %s_bytes;\n"
          "const uint32_t %s_bytes = %zu;\n_Alignas(16) const uint8_t %s[%zu] = {",
          name, bytes, name, name, bytes, name, bytes);
  for (size_t n = 0; n < bytes; ++n) fprintf(out, "%s%u,", n % 24 == 0 ? "\n" : "", image[n]);
  fprintf(out, "\n};\n");
}

static int write_image(const char *path, const char *name, const uint8_t *image, size_t bytes) {
  output_file out = {NULL, "", -1};
  int good = name != NULL ? output_file_open(&out, path) : output_file_write(path, image, bytes);
  if (name != NULL && good) {
    write_c(out.stream, name, image, bytes);
    good = output_file_keep(&out);
  }
  if (!good) fprintf(stderr, "%s: cannot be written: %s\n", path, output_file_reason());
  return good;
}

static void default_name(const char *from, const char *ending, char *to, size_t room) {
  snprintf(to, room - strlen(ending), "%s", from);
  char *dot = strrchr(to, '.');
  if (dot != NULL && strchr(dot, '/') == NULL) *dot = 0;
  strcat(to, ending);
}

/* Of the image, g/s2. */
static double stiffness_of(const fray_world *w, uint32_t class) {
  const fray_info f = fray_get_info(w);
  const bend_shear_class *c = &w->woven.bend_shear_classes[class];
  const double pulls = f.yarn_steps != 0 ? f.substeps : 1; /* a tick */
  return ldexp(c->mantissa, -c->shift) * f.substeps * pulls * f.rate_hz * f.rate_hz * f.particle_mass_ng * 1e-9;
}

static void print_softer(const char *key, exact wanted, double stiffness) {
  const double asked = (double)wanted.numerator / (double)wanted.denominator;
  if (asked > 1.001 * stiffness)
    printf("%s: %.4g g/s2 in place of its default of %g, as much as the rate bears\n", key, stiffness, asked);
}

static void print_defaults(const fray_world *w, const compile_report *report) {
  if (world_has_membrane(w)) return;
  print_softer("bend", report->default_bend, stiffness_of(w, CLASS_WEFT));
  print_softer("shear", report->default_shear, stiffness_of(w, CLASS_SHEAR));
}

static void print_cloth(const char *path, uint8_t *image, size_t bytes, const compile_report *report) {
  char scaled[SCALED_STIFFNESS_TEXT];
  struct world_file o = {image, bytes, NULL, 0, NULL};
  if (world_file_open_image(path, &o, stderr) != 0) return;
  const fray_info f = fray_get_info(o.world);
  if (scaled_stiffness_text(&f, scaled)) printf("stiffness: %s\n", scaled);
  print_defaults(o.world, report);
  yarn_level_print(o.world, stdout);
  free(o.memory);
}

/* The strain that the cloth has with its substeps while bodies stay, and what it may have. */
static void print_rest(const compile_report *report) {
  static const char *const whose[] = {"'max_rest_strain'", "4/5 of the least 'tear'",
                                      "4/5 of the least 'split_strain'"};
  const int asked = report->searched || report->limit != REST_BY_MAX;
  printf("largest strain at rest %.2f %%", report->strain_q16 / 655.36);
  if (report->searched) printf(", found in %u test runs", report->tries);
  if (asked) printf("; bound %.2f %%, %s", report->strain_max_q16 / 655.36, whose[report->limit]);
  printf("\n");
  if (asked && report->strain_q16 >= report->strain_max_q16)
    printf("warning: so it %s at rest, or as soon as it moves: take more substeps, or 'auto'\n",
           report->limit == REST_BY_SPLIT ? "splits" : "tears");
}

static void print_built(const char *output, const char *array, size_t bytes, const compile_report *report) {
  printf("%s: %s%s%zu bytes, %u substeps, %u iterations\n", output, array != NULL ? array : "",
         array != NULL ? ", an array of " : "", bytes, report->substeps, report->iterations);
  if (report->strain_max_q16 > 0) print_rest(report);
  if (report->stretch_steps > 0)
    printf("yarns take %u elastic steps a substep, %u a tick, for their stiffness, mass and spacing\n",
           report->stretch_steps, report->stretch_steps * report->substeps);
  if (report->fall_steps > 0 && report->fall_steps < FALL_STEPS_MIN)
    printf("note: gravity moves a particle by %u units of position a substep; below %d, slow sideways\n"
           "      motion of loose ends sticks (rt/README.md): take fewer substeps\n",
           report->fall_steps, FALL_STEPS_MIN);
}

int cmd_scene(int argc, char **argv) {
  const char *file = NULL;
  const char *output = NULL;
  const char *array = NULL;
  const option table[] = {{"-o", &output, NULL, NULL, OPTION_OUTPUT, 0}, {"--emit-c", &array, NULL, NULL, 0, 0}};
  const options_result wish = options_parse(argc, argv, table, 2, &file);
  if (wish == OPTIONS_HELP || (wish == OPTIONS_GOOD && file == NULL)) {
    print_usage(wish == OPTIONS_HELP ? stdout : stderr);
    return wish == OPTIONS_HELP ? 0 : 2;
  }
  if (wish == OPTIONS_WRONG) return 2;
  if (array != NULL && !is_identifier(array)) {
    fprintf(stderr, "fray scene: --emit-c '%s', expected a name that C takes\n", array);
    return 2;
  }
  char named[4096];
  default_name(file, array != NULL ? ".c" : ".img", named, sizeof named);
  if (output == NULL) {
    output = named;
    if (!options_are_apart(argv[0], table, 2, file)) return 2;
  }
  compile_report report;
  size_t bytes = 0;
  uint8_t *image = world_file_compile(file, &bytes, &report, stderr);
  if (image == NULL) return 2;
  const int written = write_image(output, array, image, bytes);
  if (written) {
    print_built(output, array, bytes, &report);
    print_cloth(output, image, bytes, &report);
  }
  free(image);
  return written ? 0 : 1;
}
