/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/auth_gate.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"

static void auth_gate_count(uint32_t *counter) { *counter += *counter < UINT32_MAX; }

static void auth_gate_add_in(auth_gate *g, const cmac_key *key, dictionary_message message) {
  FRAY_ASSERT(g->in_count < AUTH_GATE_IN);
  auth_lane_init(&g->in[g->in_count], key, message, g->instance, 0);
  g->in_count += 1;
}

static void auth_gate_add_out(auth_gate *g, const cmac_key *key, dictionary_message message,
                              uint32_t last) {
  FRAY_ASSERT(g->out_count < AUTH_GATE_OUT);
  auth_lane_init(&g->out[g->out_count], key, message, g->instance, last);
  g->out_count += 1;
}

static void auth_gate_init_fd(auth_gate *g, const cmac_key *key) {
  const int runtime = g->end == AUTH_GATE_RUNTIME;
  auth_gate_add_in(g, key, runtime ? MESSAGE_COMMAND : MESSAGE_ACK);
  auth_gate_add_out(g, key, runtime ? MESSAGE_ACK : MESSAGE_COMMAND, 0);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    auth_gate_add_in(g, key, runtime ? dictionary_pose(h) : dictionary_force(h));
    auth_gate_add_out(g, key, runtime ? dictionary_force(h) : dictionary_pose(h), 0);
  }
  if (runtime) auth_gate_add_out(g, key, MESSAGE_COMMAND, AUTH_RUNTIME_FIRST);
}

void auth_gate_init(auth_gate *g, const cmac_key *key, auth_gate_form form, auth_gate_end end,
                    uint32_t instance, uint32_t hands) {
  FRAY_ASSERT(g != NULL && key != NULL);
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES && hands < 1u << FRAY_HANDS);
  bytes_zero(g, sizeof *g);
  g->form = (uint8_t)form;
  g->end = (uint8_t)end;
  g->instance = (uint8_t)(instance & 7u);
  g->hands = (uint8_t)(hands & 3u);
  if (form == AUTH_GATE_FD) auth_gate_init_fd(g, key);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    auth_monitor_init(&g->monitor[h], key, g->instance, h, 0);
    auth_group_init(&g->group[h], key, g->instance, h, 0);
  }
}

static auth_gate_lane auth_gate_lane_of(dictionary_message message, uint8_t sends, uint32_t *last,
                                uint32_t *max) {
  const auth_gate_lane lane = {message, sends, last, max};
  return lane;
}

uint32_t auth_gate_lanes(auth_gate *g, auth_gate_lane lanes[AUTH_GATE_LANES]) {
  FRAY_ASSERT(g != NULL && lanes != NULL);
  FRAY_ASSERT(g->in_count <= AUTH_GATE_IN && g->out_count <= AUTH_GATE_OUT);
  uint32_t count = 0;
  for (uint32_t n = 0; n < g->in_count + g->out_count; ++n) {
    const uint8_t sends = n >= g->in_count;
    auth_lane *lane = sends ? &g->out[n - g->in_count] : &g->in[n];
    lanes[count++] = auth_gate_lane_of(dictionary_find(lane->id, g->instance), sends, &lane->last,
                                   &lane->max);
  }
  if (g->form == AUTH_GATE_FD) return count;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const uint8_t sends = g->end == AUTH_GATE_DEVICE;
    auth_group *group = sends ? &g->group[h] : &g->monitor[h].group;
    lanes[count++] = auth_gate_lane_of(dictionary_tag(h), sends, &group->last, &group->max);
  }
  return count;
}

void auth_gate_begin_tick(auth_gate *g) { g->tags = 0; }

static auth_lane *auth_gate_find(auth_lane *lanes, uint32_t count, uint32_t id, int plain) {
  for (uint32_t n = 0; n < count; ++n) {
    if ((plain ? lanes[n].plain_id : lanes[n].id) == id) return &lanes[n];
  }
  return NULL;
}

static const frame *auth_gate_receive_fd(auth_gate *g, const frame *f, frame *plain) {
  FRAY_ASSERT(g->in_count == AUTH_GATE_IN && g->tags <= AUTH_GATE_TAGS_PER_TICK);
  const dictionary_message message = dictionary_find(f->id, g->instance);
  if (dictionary_auth(message) != MESSAGES) {
    auth_gate_count(&g->plain);
    return NULL;
  }
  auth_lane *lane = auth_gate_find(g->in, g->in_count, f->id, 0);
  if (lane == NULL) return f;
  if (g->tags == AUTH_GATE_TAGS_PER_TICK) {
    auth_gate_count(&g->over_budget);
    return NULL;
  }
  const auth_reason reason = auth_open(lane, f, plain);
  g->tags += reason == AUTH_OK || reason == AUTH_FORGED;
  return reason == AUTH_OK ? plain : NULL;
}

static const frame *auth_gate_receive_classic(auth_gate *g, const frame *f) {
  FRAY_ASSERT(g->in_count == 0 && g->out_count == 0);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (g->end != AUTH_GATE_RUNTIME || ((uint32_t)g->hands >> h & 1u) == 0) continue;
    switch (auth_monitor_check(&g->monitor[h], f)) {
      case AUTH_MONITOR_OTHER: continue;
      case AUTH_MONITOR_POSE: return f;
      case AUTH_MONITOR_FAILED:
        g->failed = (uint8_t)(g->failed | 1u << h);
        if (f->id == g->monitor[h].group.pose_id) auth_gate_count(&g->plain);
        return NULL;
      default: return NULL;
    }
  }
  return f;
}

const frame *auth_gate_receive(auth_gate *g, const frame *f, frame *plain) {
  FRAY_ASSERT(g != NULL && f != NULL && plain != NULL);
  if (f->extended || f->error) return f;
  return g->form == AUTH_GATE_FD ? auth_gate_receive_fd(g, f, plain) : auth_gate_receive_classic(g, f);
}

int auth_gate_seal(auth_gate *g, frame *f) {
  FRAY_ASSERT(g != NULL && f != NULL);
  FRAY_ASSERT(g->form == AUTH_GATE_FD || g->out_count == 0);
  auth_lane *lane = auth_gate_find(g->out, g->out_count, f->id, 1);
  return lane == NULL || auth_seal(lane, f) == AUTH_OK;
}

int auth_gate_tag(auth_gate *g, const frame *pose, frame *tag) {
  FRAY_ASSERT(g != NULL && pose != NULL && tag != NULL);
  if (g->form != AUTH_GATE_CLASSIC || g->end != AUTH_GATE_DEVICE) return 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (auth_group_add(&g->group[h], pose, tag)) return 1;
  }
  return 0;
}

int auth_gate_alarm(auth_gate *g) {
  FRAY_ASSERT(g != NULL && g->failed < 1u << FRAY_HANDS);
  if (g->failed == 0 || g->alarm_raised != 0) return 0;
  g->alarm_raised = 1;
  return 1;
}

void auth_gate_clear(auth_gate *g) {
  FRAY_ASSERT(g != NULL && g->failed < 1u << FRAY_HANDS);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (((uint32_t)g->failed >> h & 1u) != 0) auth_monitor_clear(&g->monitor[h]);
  }
  g->failed = 0;
  g->alarm_raised = 0;
}
