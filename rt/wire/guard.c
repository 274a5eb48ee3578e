/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/guard.h"

#include "rt/base/bytes.h"

static void guard_count(uint32_t *counter) { *counter += *counter < UINT32_MAX; }

static void guard_listen(guard *g, const cmac_key *key, dictionary_message message) {
  auth_lane_init(&g->in[g->in_count], key, message, g->instance, 0);
  g->in_count += 1;
}

static void guard_speak(guard *g, const cmac_key *key, dictionary_message message, uint32_t last) {
  auth_lane_init(&g->out[g->out_count], key, message, g->instance, last);
  g->out_count += 1;
}

static void guard_init_fd(guard *g, const cmac_key *key) {
  const int runtime = g->end == GUARD_RUNTIME;
  guard_listen(g, key, runtime ? MESSAGE_COMMAND : MESSAGE_ACK);
  guard_speak(g, key, runtime ? MESSAGE_ACK : MESSAGE_COMMAND, 0);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    guard_listen(g, key, runtime ? dictionary_pose(h) : dictionary_force(h));
    guard_speak(g, key, runtime ? dictionary_force(h) : dictionary_pose(h), 0);
  }
  if (runtime) guard_speak(g, key, MESSAGE_COMMAND, AUTH_OWN);
}

void guard_init(guard *g, const cmac_key *key, guard_form form, guard_end end, uint32_t instance,
                uint32_t hands) {
  bytes_zero(g, sizeof *g);
  g->form = (uint8_t)form;
  g->end = (uint8_t)end;
  g->instance = (uint8_t)(instance & 7u);
  g->hands = (uint8_t)(hands & 3u);
  if (form == GUARD_FD) guard_init_fd(g, key);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    auth_watch_init(&g->watch[h], key, g->instance, h, 0);
    auth_group_init(&g->group[h], key, g->instance, h, 0);
  }
}

static guard_lane guard_lane_of(dictionary_message message, uint8_t sends, uint32_t *last,
                                uint32_t *most) {
  const guard_lane lane = {message, sends, last, most};
  return lane;
}

uint32_t guard_lanes(guard *g, guard_lane lanes[GUARD_LANES]) {
  uint32_t count = 0;
  for (uint32_t n = 0; n < g->in_count + g->out_count; ++n) {
    const uint8_t sends = n >= g->in_count;
    auth_lane *lane = sends ? &g->out[n - g->in_count] : &g->in[n];
    lanes[count++] = guard_lane_of(dictionary_find(lane->id, g->instance), sends, &lane->last,
                                   &lane->most);
  }
  if (g->form == GUARD_FD) return count;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const uint8_t sends = g->end == GUARD_DEVICE;
    auth_group *group = sends ? &g->group[h] : &g->watch[h].group;
    lanes[count++] = guard_lane_of(dictionary_tag(h), sends, &group->last, &group->most);
  }
  return count;
}

void guard_tick(guard *g) { g->looked = 0; }

static auth_lane *guard_find(auth_lane *lanes, uint32_t count, uint32_t id, int plain) {
  for (uint32_t n = 0; n < count; ++n) {
    if ((plain ? lanes[n].plain_id : lanes[n].id) == id) return &lanes[n];
  }
  return NULL;
}

static const frame *guard_take_fd(guard *g, const frame *f, frame *plain) {
  const dictionary_message message = dictionary_find(f->id, g->instance);
  if (dictionary_auth(message) != MESSAGES) {
    guard_count(&g->plain);
    return NULL;
  }
  auth_lane *lane = guard_find(g->in, g->in_count, f->id, 0);
  if (lane == NULL) return f;
  if (g->looked == GUARD_LOOKS) {
    guard_count(&g->unread);
    return NULL;
  }
  const auth_reason reason = auth_open(lane, f, plain);
  g->looked += reason == AUTH_OK || reason == AUTH_FORGED;
  return reason == AUTH_OK ? plain : NULL;
}

static const frame *guard_take_classic(guard *g, const frame *f) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (g->end != GUARD_RUNTIME || ((uint32_t)g->hands >> h & 1u) == 0) continue;
    switch (auth_watch_take(&g->watch[h], f)) {
      case AUTH_WATCH_OTHER: continue;
      case AUTH_WATCH_POSE: return f;
      case AUTH_WATCH_FAILED:
        g->failed = (uint8_t)(g->failed | 1u << h);
        if (f->id == g->watch[h].group.pose_id) guard_count(&g->plain);
        return NULL;
      default: return NULL;
    }
  }
  return f;
}

const frame *guard_take(guard *g, const frame *f, frame *plain) {
  if (f->extended || f->error) return f;
  return g->form == GUARD_FD ? guard_take_fd(g, f, plain) : guard_take_classic(g, f);
}

int guard_seal(guard *g, frame *f) {
  auth_lane *lane = guard_find(g->out, g->out_count, f->id, 1);
  return lane == NULL || auth_seal(lane, f) == AUTH_OK;
}

int guard_tag(guard *g, const frame *pose, frame *tag) {
  if (g->form != GUARD_CLASSIC || g->end != GUARD_DEVICE) return 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (auth_group_add(&g->group[h], pose, tag)) return 1;
  }
  return 0;
}

int guard_alarm(guard *g) {
  if (g->failed == 0 || g->told != 0) return 0;
  g->told = 1;
  return 1;
}

void guard_clear(guard *g) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (((uint32_t)g->failed >> h & 1u) != 0) auth_watch_clear(&g->watch[h]);
  }
  g->failed = 0;
  g->told = 0;
}
