/* SPDX-License-Identifier: Apache-2.0 */
/* longest LOOPS SOURCES-ROOT ROOT... <DISASSEMBLY: the longest paths of functions in instructions.
 * Reads `objdump -d -l --no-show-raw-insn` of a program for Armv6-M and later, or RV32. For each ROOT
 * it prints
 *
 *   fixed ROOT INSTRUCTIONS          the longest path, with what it calls, without counted loops
 *   loop ROOT NAME INSTRUCTIONS      one round of a counted loop, with what it calls
 *
 * so that a tick costs at most fixed + sum of rounds * instructions. LOOPS says of every loop, by the
 * function and the text of its source line, how its rounds are counted:
 *
 *   FUNCTION | TEXT | each N         at most N rounds each time it is entered
 *   FUNCTION | TEXT | NAME           as many in a tick as NAME says
 *   FUNCTION | TEXT | NAME~          the same, where a compiler may have made two entries to the loop
 *   FUNCTION | | NAME                calls of a function, counted instead of added where they stand
 *   FUNCTION | | cost N              a function of the compiler's library, taken as given
 *
 * A loop that LOOPS does not name, a call through a pointer or a counted loop with two entries is an
 * error. */
#include "tests/wcet/longest_path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static insn *code;
static int code_count;
static function functions[FUNCTIONS_MAX];
static int function_count;

static void stop(const char *what, const char *where) {
  fprintf(stderr, "longest: %s: %s\n", what, where);
  exit(2);
}

static void *allocate(size_t count, size_t bytes) {
  void *at = calloc(count, bytes);
  if (at == NULL) stop("memory", "is out");
  return at;
}

static int starts(const char *text, const char *with) { return strncmp(text, with, strlen(with)) == 0; }

static function *function_at(uint32_t at) {
  for (int n = 0; n < function_count; ++n)
    if (code[functions[n].first].at == at) return &functions[n];
  return NULL;
}

/* ---- reading ---- */

/* Words with blanks between. */
static int is_one_of(const char *word, const char *words) {
  const size_t length = strlen(word);
  for (const char *at = strstr(words, word); at != NULL && length > 0; at = strstr(at + 1, word))
    if ((at == words || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0)) return 1;
  return 0;
}

static int is_condition(const char *two) {
  return is_one_of(two, "eq ne cs cc hs lo mi pl vs vc hi ls ge lt gt le");
}

static uint32_t last_target(const char *operands) {
  const char *angle = strrchr(operands, '<');
  if (angle == NULL) return 0;
  const char *word = angle;
  while (word > operands && word[-1] == ' ') --word;
  while (word > operands && word[-1] != ' ' && word[-1] != ',' && word[-1] != '\t') --word;
  return (uint32_t)strtoul(word, NULL, 16);
}

static void classify_arm(insn *i, char *name, const char *operands) {
  char *dot = strchr(name, '.');
  if (dot != NULL) *dot = 0;
  const size_t length = strlen(name);
  const int conditional = length > 2 && is_condition(name + length - 2);
  if (is_one_of(name, "cbz cbnz") || (name[0] == 'b' && length == 3 && conditional)) {
    i->kind = INSN_BRANCH;
  } else if (is_one_of(name, "b")) {
    i->kind = INSN_JUMP;
  } else if (is_one_of(name, "bl blx")) {
    i->kind = INSN_CALL;
  } else if (starts(name, "bx") || (strchr(operands, '{') != NULL && strstr(operands, "pc}") != NULL &&
                                    !starts(name, "stm") && !starts(name, "push")) ||
             (starts(name, "ldr") && starts(operands, "pc,"))) {
    i->kind = conditional && !starts(name, "bxns") ? INSN_MAY_RETURN : INSN_RETURN;
  } else if (starts(name, "tb") || (is_one_of(name, "mov") && starts(operands, "pc,"))) {
    i->kind = INSN_SWITCH;
  }
}

/* A jalr is a call of no known target, unless objdump shows one. */
static void classify_riscv(insn *i, const char *name, const char *operands) {
  if (name[0] == 'b') i->kind = INSN_BRANCH;
  else if (is_one_of(name, "j tail")) i->kind = INSN_JUMP;
  else if (is_one_of(name, "jal call jalr")) i->kind = INSN_CALL;
  else if (is_one_of(name, "ret")) i->kind = INSN_RETURN;
  else if (is_one_of(name, "jr")) i->kind = strcmp(operands, "t0") == 0 ? INSN_RETURN : INSN_SWITCH;
}

/* "  5a: \tadd.w\tr0, r1" */
static void read_insn(char *text, const char *owner, const char *file, int line, int riscv) {
  char *tab = strchr(text, '\t');
  if (tab == NULL) return;
  char *name = tab + 1;
  char *operands = strchr(name, '\t');
  if (operands != NULL) *operands++ = 0;
  char nothing[1] = "";
  if (operands == NULL) operands = nothing;
  insn i = {0};
  i.at = (uint32_t)strtoul(text, NULL, 16);
  snprintf(i.owner, sizeof i.owner, "%s", owner);
  snprintf(i.file, sizeof i.file, "%s", file);
  i.line = line;
  char word[32];
  snprintf(word, sizeof word, "%s", name);
  word[strcspn(word, " ")] = 0;
  if (word[0] == '.') i.kind = INSN_DATA;
  else if (riscv) classify_riscv(&i, word, operands);
  else classify_arm(&i, word, operands);
  if (i.kind == INSN_BRANCH || i.kind == INSN_JUMP || i.kind == INSN_CALL) i.target = last_target(operands);
  if (code_count % 4096 == 0) {
    code = realloc(code, sizeof *code * (size_t)(code_count + 4096));
    if (code == NULL) stop("memory", "is out");
  }
  code[code_count++] = i;
  functions[function_count - 1].count++;
}

static void read_disassembly(FILE *in) {
  static char text[4096];
  char owner[NAME] = "";
  char file[FILE_NAME] = "";
  int line = 0;
  int riscv = 0;
  while (fgets(text, sizeof text, in) != NULL) {
    text[strcspn(text, "\n")] = 0;
    const size_t length = strlen(text);
    char name[NAME];
    if (strstr(text, "file format") != NULL) riscv = strstr(text, "riscv") != NULL;
    if (sscanf(text, "%*x <%63[^>]>:", name) == 1 && text[0] != ' ' && text[length - 1] == ':') {
      if (function_count == FUNCTIONS_MAX) stop("functions", "too many");
      memset(&functions[function_count], 0, sizeof functions[0]);
      snprintf(functions[function_count].name, NAME, "%s", name);
      functions[function_count++].first = code_count;
      owner[0] = file[0] = 0;
      line = 0;
    } else if (length > 3 && strcmp(text + length - 3, "():") == 0) {
      snprintf(owner, sizeof owner, "%.*s", (int)(length - 3), text);
    } else if (strchr(text, '\t') == NULL && strchr(text, ':') != NULL) {
      const char *colon = strrchr(text, ':');
      snprintf(file, sizeof file, "%.*s", (int)(colon - text), text);
      line = atoi(colon + 1);
    } else if (function_count > 0) {
      read_insn(text, owner, file, line, riscv);
    }
  }
}

/* ---- loops and their counts ---- */

static rule rules[RULES_MAX];
static int rule_count;

static char *trimmed(char *text) {
  while (*text == ' ') ++text;
  for (size_t n = strlen(text); n > 0 && (text[n - 1] == ' ' || text[n - 1] == '\n'); --n) text[n - 1] = 0;
  return text;
}

static void read_rules(const char *path) {
  FILE *f = fopen(path, "r");
  char text[512];
  if (f == NULL) stop("cannot open", path);
  while (fgets(text, sizeof text, f) != NULL) {
    if (text[0] == '#' || text[0] == '\n') continue;
    char *first = strchr(text, '|');
    char *second = first != NULL ? strrchr(text, '|') : NULL;
    if (second == NULL || second == first || rule_count == RULES_MAX) stop(path, text);
    *first = *second = 0;
    rule *r = &rules[rule_count++];
    snprintf(r->owner, sizeof r->owner, "%s", trimmed(text));
    snprintf(r->text, sizeof r->text, "%s", trimmed(first + 1));
    snprintf(r->count, sizeof r->count, "%s", trimmed(second + 1));
    r->each = starts(r->count, "each ") ? atoi(r->count + 5) : 0;
    r->loose = r->count[strlen(r->count) - 1] == '~';
    if (r->loose) r->count[strlen(r->count) - 1] = 0;
    r->cost = starts(r->count, "cost ") ? atol(r->count + 5) : -1;
  }
  fclose(f);
}

static const char *source_line(const char *root, const char *file, int line) {
  static char text[512];
  char path[1024];
  while (starts(file, "./")) file += 2;
  snprintf(path, sizeof path, "%s/%s", root, file);
  FILE *f = fopen(path, "r");
  text[0] = 0;
  for (int n = 0; f != NULL && n < line; ++n)
    if (fgets(text, sizeof text, f) == NULL) text[0] = 0;
  if (f != NULL) fclose(f);
  return text;
}

static const char *sources = ".";

/* `owner`, or `owner@function` for what stands inlined in that function. */
static int owns(const rule *r, const insn *i, const function *f) {
  const size_t length = strcspn(r->owner, "@");
  if (strlen(i->owner) != length || strncmp(r->owner, i->owner, length) != 0) return 0;
  return r->owner[length] == 0 || strcmp(r->owner + length + 1, f->name) == 0;
}

static rule *rule_of_line(const insn *i, const function *f) {
  if (i->line == 0) return NULL;
  const char *text = NULL;
  for (int n = 0; n < rule_count; ++n) {
    if (rules[n].text[0] == 0 || !owns(&rules[n], i, f)) continue;
    if (text == NULL) text = source_line(sources, i->file, i->line);
    if (strstr(text, rules[n].text) != NULL) return &rules[n];
  }
  return NULL;
}

/* ---- one function ---- */

static int index_of(const function *f, uint32_t at) {
  for (int n = 0; n < f->count; ++n)
    if (code[f->first + n].at == at) return n;
  return -1;
}

static void add_edge(function *f, int from, int to) {
  node *a = &f->nodes[from];
  if (a->next_count < NEXT_MAX) a->next[a->next_count++] = to;
  else stop("too many ways out of one instruction", f->name);
}

/* A switch goes to whatever begins behind an end and is not reached otherwise. */
static void add_switch_edges(function *f, int from) {
  for (int n = 1; n < f->count; ++n) {
    const insn *before = &code[f->first + n - 1];
    const int ends = before->kind == INSN_JUMP || before->kind == INSN_RETURN ||
                     before->kind == INSN_DATA || before->kind == INSN_SWITCH;
    int reached = code[f->first + n].kind == INSN_DATA;
    for (int m = 0; m < f->count && !reached; ++m) {
      const insn *i = &code[f->first + m];
      reached = (i->kind == INSN_BRANCH || i->kind == INSN_JUMP) && i->target == code[f->first + n].at;
    }
    if (ends && !reached) add_edge(f, from, n);
  }
}

/* Armv6-M has no long branch but `bl`. */
static void find_far_jumps(const function *f) {
  for (int n = 0; n < f->count; ++n) {
    insn *i = &code[f->first + n];
    if (i->kind == INSN_CALL && index_of(f, i->target) > 0) i->kind = INSN_JUMP;
  }
}

static void build_graph(function *f) {
  find_far_jumps(f);
  f->nodes = allocate((size_t)f->count + 1, sizeof *f->nodes);
  for (int n = 0; n < f->count; ++n) {
    const insn *i = &code[f->first + n];
    const int target = i->kind == INSN_BRANCH || i->kind == INSN_JUMP ? index_of(f, i->target) : -1;
    if (target >= 0) add_edge(f, n, target);
    if (i->kind == INSN_SWITCH) add_switch_edges(f, n);
    const int goes_on = i->kind != INSN_JUMP && i->kind != INSN_RETURN && i->kind != INSN_SWITCH &&
                        i->kind != INSN_DATA;
    if (goes_on && n + 1 < f->count && code[f->first + n + 1].kind != INSN_DATA) add_edge(f, n, n + 1);
  }
}

static void find_back_edges(function *f, int n) {
  node *a = &f->nodes[n];
  a->seen = 1;
  for (int k = 0; k < a->next_count; ++k) {
    node *b = &f->nodes[a->next[k]];
    if (b->seen == 0) find_back_edges(f, a->next[k]);
    else if (b->seen == 1) {
      a->back[k] = 1;
      b->header = 1;
    }
  }
  a->seen = 2;
  f->order[f->order_count++] = n; /* reversed topological order without back edges */
}

static void mark_loop(function *f, loop *l, int n) {
  if (l->in[n]) return;
  l->in[n] = 1;
  ++l->size;
  for (int m = 0; m < f->count; ++m)
    for (int k = 0; k < f->nodes[m].next_count; ++k)
      if (f->nodes[m].next[k] == n && f->nodes[m].seen) mark_loop(f, l, m);
}

static void find_loops(function *f) {
  for (int h = 0; h < f->count; ++h) {
    if (!f->nodes[h].header) continue;
    if (f->loop_count == LOOPS_MAX) stop("too many loops", f->name);
    loop *l = &f->loops[f->loop_count++];
    l->header = h;
    l->in = allocate((size_t)f->count + 1, 1);
    l->in[h] = 1;
    l->size = 1;
    for (int n = 0; n < f->count; ++n)
      for (int k = 0; k < f->nodes[n].next_count; ++k)
        if (f->nodes[n].back[k] && f->nodes[n].next[k] == h) mark_loop(f, l, n);
  }
  for (int a = 0; a < f->loop_count; ++a) /* innermost first */
    for (int b = a + 1; b < f->loop_count; ++b)
      if (f->loops[b].size < f->loops[a].size) {
        const loop swap = f->loops[a];
        f->loops[a] = f->loops[b];
        f->loops[b] = swap;
      }
}

/* The first test of a round may leave the loop: then the test runs once more than the rounds. */
static int tested_first(const function *f, const loop *l) {
  for (int n = l->header;; n = f->nodes[n].next[0]) {
    int inside = 0;
    for (int k = 0; k < f->nodes[n].next_count; ++k) inside += l->in[f->nodes[n].next[k]];
    if (inside < f->nodes[n].next_count) {
      for (int k = 0; k < f->nodes[n].next_count; ++k)
        if (f->nodes[n].back[k]) return 0; /* the only test is the last thing of the round */
      return 1;
    }
    if (f->nodes[n].next_count != 1 || f->nodes[n].back[0]) return 0;
  }
}

/* Loops inside of `l`, and whether one of them has this rule. */
static int taken_inside(const function *f, const loop *l, int which, const rule *r) {
  for (int m = 0; m < which; ++m)
    if (l->in[f->loops[m].header] && &f->loops[m] != l && f->loops[m].rule == r) return 1;
  return 0;
}
static int is_inside(const function *f, const loop *l, int which, int n) {
  for (int m = 0; m < which; ++m)
    if (f->loops[m].in[n] && l->in[f->loops[m].header]) return 1;
  return 0;
}

/* Of the rules that its own lines have: none that a loop inside took, a counted one first. */
static void name_loop(function *f, loop *l, int which) {
  char said[1024] = "";
  rule *shared = NULL; /* a loop with `continue` may have two heads: two loops of one rule */
  for (int n = 0; n < f->count; ++n) {
    if (!l->in[n] || is_inside(f, l, which, n)) continue;
    const insn *i = &code[f->first + n];
    rule *r = rule_of_line(i, f);
    if (r != NULL && !taken_inside(f, l, which, r) &&
        (l->rule == NULL || (l->rule->each > 0 && r->each == 0)))
      l->rule = r;
    if (r != NULL) shared = r;
    const char *text = i->line != 0 ? source_line(sources, i->file, i->line) : "";
    if (strlen(said) + 320 < sizeof said && strstr(said, text) == NULL)
      sprintf(said + strlen(said), "\n    %.40s | %s", i->owner, text);
  }
  for (int m = which - 1; m >= 0 && shared == NULL; --m)
    if (l->in[f->loops[m].header]) shared = f->loops[m].rule;
  if (l->rule == NULL) l->rule = shared;
  if (l->rule == NULL) {
    char where[1200];
    snprintf(where, sizeof where, "%s at %x: %s", f->name, code[f->first + l->header].at, said);
    stop("no rule for a loop", where);
  }
}

static long measure(function *f);

/* Compilers call what they made of a function NAME.isra.0 and the like. */
static rule *counted_function(const function *f) {
  const size_t length = strcspn(f->name, ".");
  for (int n = 0; n < rule_count; ++n)
    if (rules[n].text[0] == 0 && rules[n].cost < 0 && strlen(rules[n].owner) == length &&
        strncmp(rules[n].owner, f->name, length) == 0)
      return &rules[n];
  return NULL;
}

static long call_cost(const function *f, const insn *i) {
  function *callee = i->target != 0 ? function_at(i->target) : NULL;
  if (callee == NULL) {
    char where[2 * NAME];
    snprintf(where, sizeof where, "%s at %x calls %x", f->name, i->at, i->target);
    stop("no such function", where);
  }
  const long cost = measure(callee);
  return counted_function(callee) != NULL ? 0 : cost;
}

/* What passing instruction n costs, where the loops below `which` are settled: rounds of counted
 * loops are counted apart, the few rounds of others are all taken here. Loops of the region's own
 * rule are the region. */
static long cost_of(const function *f, const loop *region, int which, int n) {
  long cost = f->nodes[n].cost;
  for (int m = 0; m < which; ++m) {
    const loop *l = &f->loops[m];
    if (!l->in[n] || l == region || (region != NULL && l->rule == region->rule)) continue;
    int repeated = 0;
    for (int k = m + 1; k < which; ++k)
      repeated |= f->loops[k].rule == l->rule && f->loops[k].in[l->header];
    if (l->rule->each == 0 && !l->first_test) return 0;
    if (l->header == n && l->rule->each > 0 && !repeated)
      cost += l->round * (l->rule->each - (l->first_test ? 0 : 1));
  }
  return cost;
}

static int ends_round(const function *f, const loop *region, int which, int header) {
  if (region == NULL || header == region->header) return region != NULL;
  for (int m = 0; m < which; ++m)
    if (f->loops[m].header == header && f->loops[m].rule == region->rule) return 1;
  return 0;
}

/* Longest path from `from` inside `region` (all, if NULL); *latch: to the end of a round. */
static long longest_from(function *f, const loop *region, int which, int from, long *latch) {
  long best = 0;
  for (int n = 0; n < f->count; ++n) f->nodes[n].distance = -1;
  f->nodes[from].distance = 0;
  *latch = 0;
  for (int k = f->order_count - 1; k >= 0; --k) {
    const int n = f->order[k];
    node *a = &f->nodes[n];
    if (a->distance < 0 || (region != NULL && !region->in[n])) continue;
    const long there = a->distance + cost_of(f, region, which, n);
    if (there > best) best = there;
    for (int e = 0; e < a->next_count; ++e) {
      node *b = &f->nodes[a->next[e]];
      if (a->back[e] && ends_round(f, region, which, a->next[e]) && there > *latch) *latch = there;
      if (!a->back[e] && there > b->distance) b->distance = there;
    }
  }
  return best;
}

static long measure(function *f) {
  long unused;
  if (f->state == 2) return f->fixed;
  if (f->state == 1) stop("recursion", f->name);
  f->state = 1;
  for (int n = 0; n < rule_count; ++n)
    if (rules[n].cost >= 0 && strcmp(rules[n].owner, f->name) == 0) {
      f->state = 2;
      return f->fixed = rules[n].cost;
    }
  build_graph(f);
  f->order = allocate((size_t)f->count + 1, sizeof *f->order);
  find_back_edges(f, 0);
  for (int n = 0; n < f->count; ++n) {
    const insn *i = &code[f->first + n];
    if (!f->nodes[n].seen) continue;
    f->nodes[n].cost = 1;
    const int leaves = i->kind == INSN_CALL ||
                       ((i->kind == INSN_JUMP || i->kind == INSN_BRANCH) && index_of(f, i->target) < 0);
    if (leaves) f->nodes[n].cost += call_cost(f, i);
  }
  find_loops(f);
  for (int m = 0; m < f->loop_count; ++m) {
    loop *l = &f->loops[m];
    name_loop(f, l, m);
    l->first_test = tested_first(f, l);
    /* walking back from its end leads out of it to the function's entry; in a loop of a few rounds
     * the way from head to end is still a bound */
    if (l->header != 0 && l->in[0] && l->rule->each == 0 && !l->rule->loose)
      stop("a loop with two entries", f->name);
    (void)longest_from(f, l, m, l->header, &l->round);
    if (getenv("LONGEST_LOOPS"))
      fprintf(stderr, "%s %x size %d first %d round %ld: %s %s\n", f->name, code[f->first + l->header].at, l->size,
              l->first_test, l->round, l->rule->owner, l->rule->count);
  }
  f->fixed = longest_from(f, NULL, f->loop_count, 0, &unused);
  f->state = 2;
  return f->fixed;
}

/* ---- printing: a function's loops and those of all it calls. A compiler makes several of one
 * loop; the rounds are shared among them, the worst counts. ---- */

static void gather_loops(function *f, int stamp, long *rounds) {
  if (f->stamp == stamp || f->nodes == NULL) return;
  f->stamp = stamp;
  for (int m = 0; m < f->loop_count; ++m) {
    const loop *l = &f->loops[m];
    long *most = &rounds[l->rule - rules];
    if (l->rule->each == 0 && l->round > *most) *most = l->round;
  }
  for (int n = 0; n < f->count; ++n) {
    const insn *i = &code[f->first + n];
    if (!f->nodes[n].seen || i->target == 0 || i->kind == INSN_OTHER) continue;
    if (i->kind != INSN_CALL && index_of(f, i->target) >= 0) continue;
    function *callee = function_at(i->target);
    if (callee == NULL) continue;
    const rule *r = counted_function(callee);
    if (r != NULL) rounds[r - rules] = measure(callee);
    gather_loops(callee, stamp, rounds);
  }
}

static void print_root(function *root, int stamp) {
  long rounds[RULES_MAX] = {0};
  printf("fixed %s %ld\n", root->name, measure(root));
  gather_loops(root, stamp, rounds);
  for (int n = 0; n < rule_count; ++n)
    if (rounds[n] > 0) printf("loop %s %s %ld\n", root->name, rules[n].count, rounds[n]);
}

int main(int argc, char **argv) {
  if (argc < 4) stop("usage", "longest LOOPS SOURCES-ROOT ROOT... <DISASSEMBLY");
  read_rules(argv[1]);
  sources = argv[2];
  read_disassembly(stdin);
  for (int n = 3; n < argc; ++n) {
    function *root = NULL;
    for (int m = 0; m < function_count; ++m)
      if (strcmp(functions[m].name, argv[n]) == 0) root = &functions[m];
    if (root == NULL) stop("no function", argv[n]);
    print_root(root, n);
  }
  return 0;
}
