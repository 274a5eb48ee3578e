/* SPDX-License-Identifier: Apache-2.0 */
/* fray render: pictures of a run at given times, and a contact sheet of them. */
#include "tools/cmd/cmd.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/world/kernel.h"
#include "tools/terminal/options.h"
#include "tools/terminal/progress.h"
#include "tools/render/album.h"
#include "tools/recording/session.h"

enum { EXIT_GOOD = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };
enum { DEFAULT_FRAMES = 8 };
enum { SIDE_MIN = 64, SIDE_MAX = 4096 };

typedef struct {
  const char *file, *log, *key, *kernel, *folder;
  const char *at;      /* list of times */
  double every_s;      /* 0: not given */
  double length_s;     /* 0: not given */
  uint32_t width, height, instance;
  uint32_t frames;     /* 0: not given */
  float yaw, pitch;
  float focus[4];      /* cm: a point and a radius */
  int has_view, has_focus, strain, yarn, wire, cut;
} options;

typedef struct {
  const options *o;
  session s;
  uint64_t start, end;   /* ticks computed before the first picture, and of the whole run */
  uint32_t tears;        /* until the last picture */
  uint64_t *ticks;       /* of the pictures, rising */
  size_t count;
} render_job;

static void print_usage(FILE *out) {
  fputs("usage: fray render X.scene|X.img [options]\n"
        "\n"
        "Runs a scene or image and writes DIR/frame_<ticks>.png and DIR/sheet.png, a contact\n"
        "sheet of at most 48 of them, at even intervals.\n"
        "\n"
        "  --log IN.log          the inputs: a device log or a recording (candump -L)\n"
        "  --cut                 the log was cut off: takes what of it is whole\n"
        "  --key FILE            the key of an authenticated recording\n"
        "  --instance N          which runtime in the log, 0 to 7 (default 0)\n"
        "  --at 0.5s,1s,2500ms   times of the pictures, since tick 0 of the scene\n"
        "  --every 100ms         or: their interval, from the start\n"
        "  --frames N            or: their number, at even intervals from start to end\n"
        "  --for 2s              how long to run (default: the log's length, or 1 s)\n"
        "  --size 1280x960       pixels\n"
        "  --view YAW,PITCH      degrees to the right and up (default: chosen from the scene)\n"
        "  --focus X,Y,Z,R       frames a sphere of R cm at X,Y,Z cm (default: all)\n"
        "  --yarn                yarns as splines that pass over and under each other (default: of\n"
        "                        scenes with yarns; of others the cloth as a surface)\n"
        "  --wire                springs as lines: magenta, at split crossings cyan\n"
        "                        (with --yarn: two pictures of each moment, frame_ and wire_)\n"
        "  --kernel NAME         scalar, avx2, avx512, neon (default: the fastest; same pictures)\n"
        "  --strain              colour by strain: blue slack, white at rest, red about to tear\n"
        "                        (membranes by stress; red is 100 N/m where they never tear)\n"
        "  -o DIR                default out/render\n"
        "\n"
        "exit: 0 written, 1 writing failed, 2 wrong use or input\n",
        out);
}

/* `2.5s`, `100ms`; a unit is needed. Returns the seconds and moves *text on, or -1. */
static double parse_time(const char **text) {
  char *end;
  const double value = strtod(*text, &end);
  if (end == *text || !(value >= 0.0) || value > 1e12) return -1.0;
  double scale = 0.0;
  if (end[0] == 's') scale = 1.0;
  if (end[0] == 'm' && end[1] == 's') scale = 1e-3;
  if (scale == 0.0) return -1.0;
  *text = end + (scale == 1.0 ? 1 : 2);
  return value * scale;
}

static int parse_one_time(const char *name, const char *text, double *out) {
  const char *rest = text;
  *out = parse_time(&rest);
  if (*out > 0.0 && *rest == 0) return 1;
  fprintf(stderr, "fray render: %s %s, expected a time as 100ms or 2.5s\n", name, text);
  return 0;
}

static int parse_size(const char *text, options *o) {
  unsigned w = 0, h = 0;
  char rest;
  if (sscanf(text, "%5ux%5u%c", &w, &h, &rest) == 2 && w >= SIDE_MIN && h >= SIDE_MIN &&
      w <= SIDE_MAX && h <= SIDE_MAX) {
    o->width = w;
    o->height = h;
    return 1;
  }
  fprintf(stderr, "fray render: --size %s, expected WIDTHxHEIGHT, %d to %d each\n", text,
          (int)SIDE_MIN, (int)SIDE_MAX);
  return 0;
}

static int parse_view(const char *text, options *o) {
  char rest;
  o->has_view = 1;
  if (sscanf(text, "%f,%f%c", &o->yaw, &o->pitch, &rest) == 2 && fabsf(o->yaw) <= 360.0f &&
      fabsf(o->pitch) <= 89.0f) {
    return 1;
  }
  fprintf(stderr, "fray render: --view %s, expected YAW,PITCH in degrees, pitch -89 to 89\n", text);
  return 0;
}

static int parse_focus(const char *text, options *o) {
  char rest;
  float *f = o->focus;
  o->has_focus = 1;
  if (sscanf(text, "%f,%f,%f,%f%c", f, f + 1, f + 2, f + 3, &rest) == 4 && fabsf(f[0]) <= 1e4f &&
      fabsf(f[1]) <= 1e4f && fabsf(f[2]) <= 1e4f && f[3] >= 0.01f && f[3] <= 1e4f) {
    return 1;
  }
  fprintf(stderr, "fray render: --focus %s, expected X,Y,Z,R in cm, R 0.01 to 10000\n", text);
  return 0;
}

static int parse_options(options *o, const char *every, const char *length, const char *size,
                         const char *view, const char *focus) {
  if ((o->at != NULL) + (every != NULL) + (o->frames != 0) > 1) {
    fprintf(stderr, "fray render: --at, --every and --frames exclude each other\n");
    return 0;
  }
  if (o->wire && o->strain) {
    fprintf(stderr, "fray render: --wire and --strain exclude each other\n");
    return 0;
  }
  return (every == NULL || parse_one_time("--every", every, &o->every_s)) &&
         (length == NULL || parse_one_time("--for", length, &o->length_s)) &&
         (size == NULL || parse_size(size, o)) && (view == NULL || parse_view(view, o)) &&
         (focus == NULL || parse_focus(focus, o));
}

/* Membranes have neither yarns nor springs. */
static int applies(const options *o, const fray_info *f) {
  if (f->triangles_max == 0 || (!o->yarn && !o->wire)) return 1;
  fprintf(stderr, "fray render: %s draws %s of woven cloth, but %s holds a membrane\n", o->yarn ? "--yarn" : "--wire",
          o->yarn ? "the yarns" : "the springs", o->file);
  return 0;
}

/* A surface would span the way between the two yarns of a crossing that has split. */
static void choose_look(options *o, const fray_info *f) {
  if (f->splits_max != 0 && !o->wire) o->yarn = 1;
}

/* The nearest; one beyond every end where a double has no number for each. */
static uint64_t whole(double ticks) { return ticks < 0x1p52 ? (uint64_t)(ticks + 0.5) : UINT64_MAX; }

static int add_tick(render_job *job, uint64_t tick) {
  if (job->count == ALBUM_PICTURES_MAX) {
    fprintf(stderr, "fray render: more than %d pictures\n", (int)ALBUM_PICTURES_MAX);
    return 0;
  }
  job->ticks[job->count++] = tick;
  return 1;
}

static int tick_order(const void *a, const void *b) {
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return x < y ? -1 : x > y;
}

static int take_at(render_job *job) {
  for (const char *text = job->o->at;;) {
    const double seconds = parse_time(&text);
    if (seconds < 0.0 || (*text != 0 && *text != ',')) {
      fprintf(stderr, "fray render: --at %s, expected times as 0.5s,1s,2500ms\n", job->o->at);
      return 0;
    }
    if (!add_tick(job, whole(seconds * job->s.facts.rate_hz))) return 0;
    if (*text == 0) break;
    text++;
  }
  qsort(job->ticks, job->count, sizeof *job->ticks, tick_order);
  size_t kept = 0;
  for (size_t n = 0; n < job->count; n++)
    if (kept == 0 || job->ticks[n] != job->ticks[kept - 1]) job->ticks[kept++] = job->ticks[n];
  job->count = kept;
  return 1;
}

/* From the start to the end, rounded to ticks; a single one shows the end. */
static int take_frames(render_job *job) {
  const uint32_t frames = job->o->frames;
  const uint64_t ticks = job->end - job->start;
  if (frames > ticks + 1) {
    fprintf(stderr, "fray render: --frames %" PRIu32 ", but the run has %" PRIu64 " ticks\n",
            frames, ticks);
    return 0;
  }
  for (uint32_t n = 0; n < frames; n++) {
    const double share = frames > 1 ? (double)n / (frames - 1) : 1.0;
    if (!add_tick(job, job->start + whole(share * (double)ticks))) return 0;
  }
  return 1;
}

/* Which ticks, and how long to run. A tick number counts ticks computed: 0 is the start. */
static int plan(render_job *job) {
  const options *o = job->o;
  const double rate = job->s.facts.rate_hz;
  double length = o->log ? (double)job->s.log.count : rate;
  if (o->at && !take_at(job)) return 0;
  if (o->at && !o->log) length = (double)job->ticks[job->count - 1] - (double)job->start;
  if (o->length_s > 0.0) length = o->length_s * rate;
  if (o->log && length > (double)job->s.log.count) {
    fprintf(stderr, "fray render: --for %gs, but the log has %" PRIu32 " ticks\n", o->length_s,
            job->s.log.count);
    return 0;
  }
  job->end = job->start + (length > 0.0 ? (uint32_t)fmin(length + 0.5, 1e9) : 0);
  if (o->frames != 0) {
    if (!take_frames(job)) return 0;
  } else if (!o->at) {
    double step = o->every_s > 0.0 ? o->every_s * rate : length / DEFAULT_FRAMES;
    if (step < 1.0) step = 1.0;
    for (double t = 0.0; t <= length + 1e-6; t += step)
      if (!add_tick(job, job->start + whole(t))) return 0;
  }
  for (size_t n = 0; n < job->count; n++) {
    if (job->ticks[n] >= job->start && job->ticks[n] <= job->end) continue;
    fprintf(stderr, "fray render: %gs is outside the run, expected %gs to %gs of the scene's time\n",
            (double)job->ticks[n] / rate, (double)job->start / rate, (double)job->end / rate);
    return 0;
  }
  return 1;
}

static int run_world(render_job *job, album *pictures) {
  uint64_t tick = job->start;
  for (size_t n = 0; n < job->count; n++) {
    for (; tick < job->ticks[n]; tick++) {
      fray_output output;
      fray_tick(job->s.world_file.world, session_input(&job->s, tick - job->start), &output);
      job->tears = output.tears_total;
      progress_show("run", tick - job->start, job->end - job->start);
    }
    if (!album_add(pictures, job->s.world_file.world)) {
      fprintf(stderr, "fray render: not enough memory for %zu pictures\n", job->count);
      return 0;
    }
  }
  progress_end();
  return 1;
}

static int render_world(render_job *job) {
  const options *o = job->o;
  const float *f = o->focus;
  const album_style style = {.folder = o->folder,
                             .width = o->width,
                             .height = o->height,
                             .has_view = o->has_view,
                             .yaw = o->yaw,
                             .pitch = o->pitch,
                             .has_focus = o->has_focus,
                             .focus = {f[0] * 10.0f, f[1] * 10.0f, f[2] * 10.0f},
                             .reach = f[3] * 10.0f,
                             .strain = o->strain,
                             .yarn = o->yarn,
                             .wire = o->wire};
  album pictures;
  int code = EXIT_FAILED;
  album_open(&pictures);
  job->start = job->s.facts.tick;
  job->ticks = calloc(ALBUM_PICTURES_MAX, sizeof *job->ticks);
  if (job->ticks != NULL) {
    if (!plan(job))
      code = EXIT_USAGE;
    else if (run_world(job, &pictures) && album_write(&pictures, &style))
      code = EXIT_GOOD;
  }
  if (code == EXIT_GOOD) {
    printf("%zu moments and sheet.png in %s, %" PRIu32 " tears\n", job->count, o->folder,
           job->tears);
  }
  free(job->ticks);
  album_close(&pictures);
  return code;
}

int cmd_render(int argc, char **argv) {
  options o = {.folder = "out/render", .width = 1280, .height = 960};
  render_job job = {.o = &o};
  const char *every = NULL;
  const char *length = NULL;
  const char *size = NULL;
  const char *view = NULL;
  const char *focus = NULL;
  const option table[] = {
      {"--log", &o.log, NULL, NULL, OPTION_INPUT, 0},  {"--instance", NULL, &o.instance, NULL, 0, 7},
      {"--at", &o.at, NULL, NULL, 0, 0},    {"--every", &every, NULL, NULL, 0, 0},
      {"--for", &length, NULL, NULL, 0, 0}, {"--size", &size, NULL, NULL, 0, 0},
      {"--frames", NULL, &o.frames, NULL, 1, ALBUM_PICTURES_MAX},
      {"--focus", &focus, NULL, NULL, 0, 0},
      {"--view", &view, NULL, NULL, 0, 0},  {"--strain", NULL, NULL, &o.strain, 0, 0},
      {"--yarn", NULL, NULL, &o.yarn, 0, 0}, {"--wire", NULL, NULL, &o.wire, 0, 0},
      {"-o", &o.folder, NULL, NULL, OPTION_FOLDER, 0},  {"--key", &o.key, NULL, NULL, OPTION_INPUT, 0},
      {"--kernel", &o.kernel, NULL, NULL, 0, 0},
      {"--cut", NULL, NULL, &o.cut, 0, 0}};
  const options_result wish =
      options_parse(argc, argv, table, sizeof table / sizeof table[0], &o.file);
  if (wish == OPTIONS_HELP) {
    print_usage(stdout);
    return EXIT_GOOD;
  }
  if (wish == OPTIONS_GOOD && o.file == NULL)
    fprintf(stderr, "fray render: expected a scene or an image; fray render --help tells more\n");
  if (wish == OPTIONS_WRONG || o.file == NULL ||
      !parse_options(&o, every, length, size, view, focus)) {
    return EXIT_USAGE;
  }
  if (o.key != NULL && o.log == NULL) {
    fprintf(stderr, "fray render: --key goes with --log\n");
    return EXIT_USAGE;
  }
  if (o.cut && o.log == NULL) {
    fprintf(stderr, "fray render: --cut goes with --log\n");
    return EXIT_USAGE;
  }
  const session_log log = {.file = o.log, .key = o.key, .cut = o.cut};
  const int world_file = session_open(&job.s, o.file, &log, o.instance);
  if (world_file != 0) return world_file;
  choose_look(&o, &job.s.facts);
  const int good = applies(&o, &job.s.facts) && kernel_use(job.s.world_file.world, o.kernel);
  const int code = good ? render_world(&job) : EXIT_USAGE;
  session_close(&job.s);
  return code;
}
