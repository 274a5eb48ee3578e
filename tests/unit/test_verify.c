/* SPDX-License-Identifier: Apache-2.0 */
/* Each kind of change to a recording, and whether `fray verify` refuses it, each tried at up to TRIES places. The table
 * of tools/recording/README.md is written from the rows here: `test_verify --write`. Run from the repository's root. */
#define _GNU_SOURCE
#include "tools/recording/verify.h"

#include "tests/lib/altered_recording.h"
#include "tools/world/world_workers.h"

enum { TRIES = 8 / TEST_FEWER > 0 ? 8 / TEST_FEWER : 1 };

static const char README[] = "tools/recording/README.md";
static const char BEGIN[] = "<!-- begin: written by build/tests/unit/test_verify --write -->\n";
static const char END[] = "<!-- end -->\n";

static world_workers workers;
static char *said;
static size_t said_bytes;

/* Whether `changed` verifies; what was said is in `said`. */
static int verifies(int cut) {
  fixture again = open_world();
  FILE *out;
  free(said);
  out = open_memstream(&said, &said_bytes);
  if (out == NULL || !world_workers_open(&workers, again.w, 1, WORKERS_ANY_CPU)) fixture_give_up("verify", "no memory");
  const verify_recording of = {"r.log", &changed, 0, cut};
  const int same = verify_run(&of, again.w, &workers.group, out, out);
  world_workers_close(&workers);
  fclose(out);
  free(again.memory);
  return same;
}

typedef struct {
  uint32_t of;           /* session */
  dictionary_message at; /* tried on entries of this message; MESSAGES: on any */
  const char *name, *change;
  int (*make)(size_t at);
  enum { PASSES, REFUSED, CUT } verdict; /* CUT: refused, but with --cut the ticks before are taken */
  const char *words;                     /* one of these is said, `|` between them */
  const char *why;                       /* PASSES: why it changes nothing */
} row;

static const row ROWS[] = {
    {SMALL, MESSAGE_SYNC, "SYNC", "removed", sync_removed, REFUSED,
     "a SYNC is missing|starts with tick|before the first SYNC", 0},
    {SMALL, MESSAGE_SYNC, "SYNC", "removed, one of two equal ones", sync_of_two_removed, PASSES, "verified 700",
     "a runtime repeats a SYNC that was not confirmed; the other one says the same"},
    {SMALL, MESSAGE_SYNC, "SYNC", "repeated", repeated, PASSES, "verified 700",
     "a runtime does so when it was not confirmed; no tick is between them"},
    {SMALL, MESSAGE_SYNC, "SYNC", "repeated with another hash, before or behind", wrong_sync_before, REFUSED,
     "a repeated SYNC has the same hash", 0},
    {SMALL, MESSAGE_SYNC, NULL, NULL, wrong_sync_behind, REFUSED, "a repeated SYNC has the same hash", 0},
    {SMALL, MESSAGE_SYNC, "SYNC", "swapped", sync_swapped, REFUSED, "a SYNC is missing|starts with tick", 0},
    {SMALL, MESSAGE_SYNC, "SYNC", "altered: tick", sync_number, REFUSED, "a SYNC is missing|starts with tick|a repeated SYNC has", 0},
    {SMALL, MESSAGE_SYNC, "SYNC", "altered: hash", sync_hash, REFUSED,
     "SYNC at line|a repeated SYNC has the same hash|the start differs", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "removed, of a tick", taken_removed, REFUSED, "which is not in the log", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "altered, of a tick: any bit under the CRC", taken_bit, REFUSED,
     "differs|which is not in the log", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "swapped", swapped, REFUSED, "which is not in the log", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "added before, with the same counter", other_before, REFUSED, "differs", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "added behind, with the same counter", other_behind, PASSES, "verified 700",
     "a port drops a repeated counter; the tick has the first one"},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "removed or altered, of no tick", other_removed, PASSES, "verified 700",
     "a newer one came in its tick: it never was in the world"},
    {SMALL, MESSAGE_POSE_RIGHT, NULL, NULL, other_bit, PASSES, "verified 700", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "repeated", repeated, PASSES, "verified 700", "a port drops it"},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "added behind, with the next counter", pose_next, REFUSED, "differs", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "added with another counter, ahead or old", other_counter_before, PASSES, "verified 700",
     "FORCE says that its tick took another one, and listeners see the next one before it"},
    {SMALL, MESSAGE_POSE_RIGHT, NULL, NULL, other_counter_behind, PASSES, "verified 700", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "added, with a wrong CRC", wrong_crc_added, PASSES, "verified 700", "a port drops it"},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "added, of a hand that the world does not have", pose_left, PASSES, "verified 700",
     "a port does not read it"},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "moved, three ticks or more later", later_3, REFUSED, "which is not in the log", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "moved earlier, before others of its hand", earlier_5, REFUSED,
     "which is not in the log|differs", 0},
    {SMALL, MESSAGE_POSE_RIGHT, "POSE", "moved earlier, with all that follow, at any distance", all_behind_this, PASSES,
     "verified 700", "a port keeps their order, and FORCE says which tick took which; how long they waited is no part of the world"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "removed", command_removed, REFUSED, "whose COMMAND is not in the log", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "altered: counter, command, a reserved bit", command_bit, REFUSED,
     "whose COMMAND is not in the log", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "altered: argument", argument_bit, REFUSED, "no command has one", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with another counter", command_added, REFUSED, "has no ACK", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with the counter of the last but one", last_but_one_far, REFUSED, "has no ACK", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with the counter of the last but one, within two ticks of the last",
     last_but_one_near, PASSES, "verified 700", "listeners see a repetition later"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with the last counter, whatever else it says", last_again, PASSES, "verified 700",
     "a port takes it for a repetition and drops it"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added: a later one, three ticks or more before it", copied_far, REFUSED, "has no ACK", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added: a later one, within two ticks", copied_near, PASSES, "verified 700",
     "one of both is a repetition; listeners see other orders"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with another counter, in a tick that answers HALT or STOP", added_beside_stop,
     PASSES, "verified 700", "one of the runtime's own takes the place of a COMMAND, which then has no ACK"},
    {SMALL, MESSAGE_POSE_RIGHT, "COMMAND", "added, with another counter, beside more than 64 POSEs and COMMANDs in three ticks",
     command_in_flood, PASSES, "verified 700", "frames wait in a queue then, and one that finds it full is dropped"},
    {SMALL, MESSAGE_IDENTITY, "COMMAND", "added, before IDENTITY", command_before_all, PASSES, "verified 700",
     "the runtime did not listen yet"},
    {SMALL, MESSAGE_IDENTITY, "COMMAND", "added, behind the SYNC of the last tick", command_behind_all, PASSES, "verified 700",
     "no tick reads it"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with a wrong CRC", wrong_crc_added, PASSES, "verified 700", "a port drops it"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "added, with a reserved bit, or of command 0", malformed_added, PASSES, "verified 700",
     "a port drops it"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "moved, three ticks or more later, or earlier where none went before it", command_later,
     REFUSED, "whose COMMAND is not in the log", 0},
    {SMALL, MESSAGE_COMMAND, NULL, NULL, command_earlier, REFUSED, "whose COMMAND is not in the log", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "moved, within two ticks", command_near, PASSES, "verified 700", "listeners see other orders"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "repeated", repeated, PASSES, "verified 700", "a port drops it"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "removed, a repetition", repetition_removed, PASSES, "verified 700",
     "a port had dropped it"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "swapped, over more than two ticks", far_swapped, REFUSED,
     "whose COMMAND is not in the log", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "swapped, within two ticks", near_swapped, PASSES, "verified 700",
     "ACK says which tick took which; listeners see other orders"},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "removed with its ACK, where it had an effect", start_removed, REFUSED, "differs", 0},
    {SMALL, MESSAGE_COMMAND, "COMMAND", "removed with its ACK, where it had none", idle_removed, PASSES, "verified 700",
     "the log of a session without it: no state, force or answer is another one"},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "removed", removed, REFUSED, "a FORCE or a SYNC is missing|has no FORCE", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "altered: any bit under the CRC", any_bit, REFUSED, "differs|a FORCE or a SYNC is missing|which is not in the log", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "swapped", swapped, REFUSED, "a FORCE or a SYNC is missing", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "added", added, REFUSED, "a FORCE or a SYNC is missing|FORCE right with counter|differs", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "repeated", repeated, PASSES, "verified 700", "controllers may send a frame twice; both say the same"},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "added, of a hand that the world does not have", force_left, REFUSED,
     "does not have this hand", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "moved, eight ticks or more later, with others between or with all that follow", later_12,
     REFUSED, "a FORCE or a SYNC is missing|has no FORCE", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, NULL, NULL, all_at_the_end, REFUSED, "a FORCE or a SYNC is missing", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "moved earlier, before others of its hand", earlier_5, REFUSED,
     "a FORCE or a SYNC is missing|before the first SYNC", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE", "moved earlier, with all that follow, at any distance", all_behind_this, PASSES,
     "verified 700", "the n-th is that of the n-th tick; its place says nothing"},
    {SMALL, MESSAGE_ACK, "ACK", "removed, also where the command changed nothing", removed, REFUSED, "has no ACK", 0},
    {SMALL, MESSAGE_ACK, "ACK", "altered: any bit under the CRC", any_bit, REFUSED,
     "differs|is not in the log|has no SYNC|a field outside its range", 0},
    {SMALL, MESSAGE_ACK, "ACK", "added", added, REFUSED, "has no SYNC|is not in the log|differs", 0},
    {SMALL, MESSAGE_ACK, "ACK", "repeated", repeated, PASSES, "verified 700", "as FORCE"},
    {SMALL, MESSAGE_ACK, "ACK", "swapped", swapped, PASSES, "verified 700", "it names its tick; its place says nothing"},
    {SMALL, MESSAGE_ACK, "ACK", "added, of the tick before the first", ack_of_before, REFUSED, "has no SYNC", 0},
    {SMALL, MESSAGE_ACK, "ACK", "moved, anywhere behind the first SYNC", to_the_end, PASSES, "verified 700", "as swapped"},
    {SMALL, MESSAGE_ACK, NULL, NULL, to_the_first, PASSES, "verified 700", 0},
    {SMALL, MESSAGES, "FORCE, ACK, TEAR, STATUS", "added before the first SYNC", before_the_first, REFUSED,
     "before the first SYNC, of another session", 0},
    {SMALL, MESSAGE_FORCE_RIGHT, "FORCE, ACK", "added, with a wrong CRC", wrong_crc_added, REFUSED, "has a wrong CRC", 0},
    {SMALL, MESSAGE_ACK, NULL, NULL, wrong_crc_added, REFUSED, "has a wrong CRC", 0},
    {SMALL, MESSAGE_TEAR, "TEAR, STATUS", "moved, with all that follow or without passing another, anywhere behind the first SYNC",
     all_behind_this, PASSES, "verified 700", "the n-th is that of the n-th tick that sends one; its place says nothing"},
    {SMALL, MESSAGE_TEAR, NULL, NULL, all_at_the_end, PASSES, "verified 700", 0},
    {SMALL, MESSAGE_STATUS, NULL, NULL, all_behind_this, PASSES, "verified 700", 0},
    {SMALL, MESSAGE_STATUS, NULL, NULL, all_at_the_end, PASSES, "verified 700", 0},
    {SMALL, MESSAGE_TEAR, "TEAR", "removed", removed, REFUSED, "differs|the log has no TEAR", 0},
    {SMALL, MESSAGE_TEAR, "TEAR", "altered: any bit", any_bit, REFUSED, "differs|has a field|has a reserved", 0},
    {SMALL, MESSAGE_TEAR, "TEAR", "swapped", swapped, REFUSED, "differs", 0},
    {SMALL, MESSAGE_TEAR, "TEAR", "added or repeated", added, REFUSED, "differs|a TEAR that this run does not have", 0},
    {SMALL, MESSAGE_TEAR, NULL, NULL, repeated, REFUSED, "differs|a TEAR that this run does not have", 0},
    {SMALL, MESSAGE_STATUS, "STATUS", "removed", removed, REFUSED, "differs|the log has no STATUS", 0},
    {SMALL, MESSAGE_STATUS, "STATUS", "altered: any bit but of Overruns", other_field, REFUSED, "differs|has a field", 0},
    {SMALL, MESSAGE_STATUS, "STATUS", "swapped", swapped, REFUSED, "differs", 0},
    {SMALL, MESSAGE_STATUS, "STATUS", "added or repeated", added, REFUSED, "differs|a STATUS that this run does not have", 0},
    {SMALL, MESSAGE_STATUS, NULL, NULL, repeated, REFUSED, "differs|a STATUS that this run does not have", 0},
    {SMALL, MESSAGE_STATUS, "STATUS", "altered: Overruns falls", overruns_fall, REFUSED, "differs: STATUS", 0},
    {SMALL, MESSAGE_STATUS, "STATUS", "altered: Overruns rises, and stays", overruns_rise, PASSES, "verified 700",
     "how many ticks came late is a matter of clocks, and no part of the world"},
    {SMALL, MESSAGE_IDENTITY, "IDENTITY", "removed", removed, PASSES, "does not state its physics",
     "it only explains differences; verify says that it is missing"},
    {SMALL, MESSAGE_IDENTITY, "IDENTITY", "altered: physics", physics_bit, PASSES, "made by another version of the physics",
     "said before anything that differs; the hashes decide"},
    {SMALL, MESSAGE_IDENTITY, "IDENTITY", "altered: high half of the tick", tick_high_bit, REFUSED, "differs: IDENTITY", 0},
    {SMALL, MESSAGE_IDENTITY, "IDENTITY", "added", identity_added, REFUSED, "an IDENTITY that this run does not have", 0},
    {SMALL, MESSAGE_IDENTITY, "IDENTITY", "repeated", repeated, PASSES, "verified 700", "as FORCE"},
    {SMALL, MESSAGE_IDENTITY, NULL, NULL, identity_at_end, PASSES, "verified 700", 0},
    {ACROSS, MESSAGE_IDENTITY, NULL, NULL, repeated, PASSES, "verified 40", 0},
    {SMALL, MESSAGE_IDENTITY, "IDENTITY", "moved behind what follows, anywhere", to_the_end, PASSES, "verified 700", "as removed"},
    {ACROSS, MESSAGE_IDENTITY, "IDENTITY", "altered: physics, in one of those of a recording across 2^32 ticks", physics_bit, REFUSED,
     "differs: IDENTITY", 0},
    {ACROSS, MESSAGE_IDENTITY, "IDENTITY", "removed, one of those of a recording across 2^32 ticks", removed, REFUSED,
     "differs: IDENTITY|the log has no IDENTITY", 0},
    {ACROSS, MESSAGE_IDENTITY, "IDENTITY", "repeated or moved behind another one, across 2^32 ticks", first_identity_at_end, REFUSED,
     "an IDENTITY that this run does not have", 0},
    {ACROSS, MESSAGE_IDENTITY, NULL, NULL, swapped, REFUSED, "differs: IDENTITY", 0},
    {SMALL, MESSAGES, "POSE, COMMAND, FORCE, ACK", "altered, and the CRC not mended", crc_bit, REFUSED, "which is not in the log|is not in the log|has a wrong CRC", 0},
    {SMALL, MESSAGES, "any", "one place later, behind a frame of another message", neighbours, PASSES, "verified 700",
     "listeners see other orders: counters say what belongs together, places do not"},
    {SMALL, MESSAGES, "any", "made a CAN FD frame, also with BRS", as_fd, PASSES, "verified 700",
     "a port takes 8 bytes in either form"},
    {SMALL, MESSAGES, "any", "added, of another instance or with an extended id", of_others, PASSES, "verified 700",
     "it is none of this runtime's frames"},
    {SMALL, MESSAGES, "any", "altered: time", other_time, PASSES, "verified 700", "ticks go by SYNC"},
    {SMALL, MESSAGE_SYNC, "end", "the closing SYNC removed", closing_removed, CUT, "tick 699 has no hash", 0},
    {NO_HANDS, MESSAGE_SYNC, "end", "the closing SYNC removed, of a world without hands", closing_removed, PASSES, "verified 24",
     "ticks send no FORCE there: it is the log of a session that is a tick shorter"},
    {SMALL, MESSAGES, "end", "cut off, but behind a SYNC", cut_behind, CUT, "has no hash", 0},
    {SMALL, MESSAGE_SYNC, "end", "cut off behind a SYNC", cut_behind_sync, PASSES, "verified",
     "a shorter session: each of its ticks has its hash"},
    {SMALL, MESSAGE_SYNC, "key", "none: sealed, and opened with its key", same_key, PASSES, "verified 700", "it is the recording"},
    {SMALL, MESSAGE_SYNC, "key", "another one", other_key, REFUSED, "has no FORCE", 0},
    {SMALL, MESSAGE_SYNC, "POSE_AUTH", "altered: any bit, also of its tag", sealed_pose, REFUSED, "which is not in the log", 0},
    {SMALL, MESSAGE_SYNC, "COMMAND_AUTH", "altered: any bit, also of its tag", sealed_command, REFUSED, "whose COMMAND is not in the log", 0},
    {SMALL, MESSAGE_SYNC, "FORCE_AUTH", "altered: any bit, also of its tag", sealed_force, REFUSED, "a FORCE or a SYNC is missing", 0},
    {SMALL, MESSAGE_SYNC, "ACK_AUTH", "altered: any bit, also of its tag", sealed_ack, REFUSED, "has no ACK", 0},
};
enum { ROW_COUNT = sizeof ROWS / sizeof *ROWS };

static void copy_good(void) {
  changed.count = good.count;
  changed.entries = realloc(changed.entries, good.count * sizeof *good.entries);
  if (changed.entries == NULL) fixture_give_up("copy_good", "no memory");
  memcpy(changed.entries, good.entries, good.count * sizeof *good.entries);
}

static int says_one_of(const char *words) {
  char word[128];
  while (*words != 0) {
    const size_t bytes = strcspn(words, "|");
    snprintf(word, sizeof word, "%.*s", (int)bytes, words);
    if (strstr(said, word) != NULL) return 1;
    words += bytes + (words[bytes] == '|');
  }
  return 0;
}

static void check_row(const row *r, const char *name, size_t at) {
  const int same = verifies(0);
  const int as_said = says_one_of(r->words);
  if (same != (r->verdict == PASSES) || !as_said)
    printf("%s %s, line %zu of %d: %s, expected %s and '%s'; said: %s", name, r->change == NULL ? "" : r->change, at + 1,
           (int)good.count, same ? "passes" : "refused", r->verdict == PASSES ? "passes" : "refused", r->words, said);
  CHECK_EQ_INT(same, r->verdict == PASSES);
  CHECK(as_said);
  if (r->verdict != CUT) return;
  CHECK(verifies(1));
  CHECK(says_one_of("cut off: tick"));
}

/* The places of a row: it fits them, and they are spread over all. */
static void try_row(const row *r, const char *name) {
  size_t fits = 0, tries = 0;
  for (int counting = 1; counting >= 0; --counting) {
    size_t seen = 0;
    for (size_t at = 0; at < good.count; ++at) {
      if (r->at != MESSAGES && message_at(&good, at) != r->at) continue;
      copy_good();
      if (!r->make(at)) continue;
      number_lines(&changed);
      if (counting) ++fits;
      if (counting || seen++ * TRIES / fits < tries) continue;
      ++tries;
      check_row(r, name, at);
    }
  }
  if (tries == 0) printf("%s %s: fits no place\n", name, r->change);
  CHECK(tries > 0);
}

static void every_row(void) {
  const char *name = "";
  for (int n = 0; n < ROW_COUNT; ++n) {
    if (ROWS[n].name != NULL) name = ROWS[n].name;
    use_session(ROWS[n].of);
    try_row(&ROWS[n], name);
  }
}

static void as_recorded(void) {
  for (uint32_t n = 0; n < SESSIONS; ++n) {
    char words[64];
    snprintf(words, sizeof words, "verified %u ticks, hash ", (unsigned)OF[n].ticks);
    use_session(n);
    copy_good();
    CHECK(verifies(0));
    CHECK_EQ_INT(strncmp(said, words, strlen(words)), 0);
    CHECK(verifies(1)); /* a whole recording is not cut */
    CHECK(!says_one_of("cut off"));
  }
}

/* The page */

static char *table_text(void) {
  char *text = NULL;
  size_t bytes = 0;
  FILE *out = open_memstream(&text, &bytes);
  if (out == NULL) fixture_give_up("table_text", "no memory");
  fprintf(out, "| frame | change | refused | says, or why it changes nothing |\n|---|---|---|---|\n");
  for (int n = 0; n < ROW_COUNT; ++n) {
    const row *r = &ROWS[n];
    if (r->name == NULL) continue;
    fprintf(out, "| %s | %s | %s | ", r->name, r->change,
            r->verdict == PASSES ? "no" : r->verdict == CUT ? "yes, but with `--cut`" : "yes");
    if (r->verdict == PASSES)
      fprintf(out, "%s |\n", r->why);
    else
      fprintf(out, "`%.*s` |\n", (int)strcspn(r->words, "|"), r->words);
  }
  fclose(out);
  return text;
}

/* The page before, in and behind the table; `write` puts the table there. */
static void page_has_the_table(int write) {
  char *page = fixture_read(README), *table = table_text();
  char *begin = strstr(page, BEGIN);
  char *end = begin == NULL ? NULL : strstr(begin, END);
  CHECK(end != NULL);
  if (end == NULL) return;
  begin += strlen(BEGIN);
  const size_t bytes = (size_t)(end - begin);
  const int same = bytes == strlen(table) && memcmp(begin, table, bytes) == 0;
  FILE *out = write && !same ? fopen(README, "wb") : NULL;
  if (out != NULL) {
    fprintf(out, "%.*s%s%s", (int)(begin - page), page, table, end);
    fclose(out);
  } else if (!same) {
    printf("%s: the table differs; write it with `test_verify --write`\n", README);
  }
  CHECK(same || write);
  free(page);
  free(table);
}

static void the_page(void) { page_has_the_table(0); }

int main(int argc, char **argv) {
  if (argc == 2 && strcmp(argv[1], "--write") == 0) {
    page_has_the_table(1);
    return test_bad_checks != 0;
  }
  for (session = 0; session < SESSIONS; ++session) record_session();
  TEST(as_recorded);
  TEST(every_row);
  TEST(the_page);
  printf("figure verify_changes %d kinds of change, each at up to %d places\n", ROW_COUNT, (int)TRIES);
  return test_end();
}
