/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/auth.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"

enum {
  PLAIN = DICTIONARY_LENGTH,
  SEALED = DICTIONARY_LENGTH_AUTH,
  FRESHNESS_AT = PLAIN,
  TAG_AT = FRESHNESS_AT + 4
};

_Static_assert(TAG_AT + AUTH_TAG_FD == SEALED, "freshness and tag fill the frame");
_Static_assert(2 + AUTH_TAG_CLASSIC == PLAIN, "freshness and tag fill a classic frame");

const char *auth_reason_text(auth_reason reason) {
  switch (reason) {
    case AUTH_OK: return "no error";
    case AUTH_ID: return "another id";
    case AUTH_FLAGS: return "a remote or error frame";
    case AUTH_LENGTH: return "a wrong length";
    case AUTH_OLD: return "an old freshness";
    case AUTH_FORGED: return "a tag that does not fit";
    case AUTH_SPENT: return "no freshness left under this key";
  }
  return "an unknown reason";
}

static void auth_count(uint32_t *counter, uint32_t by) {
  *counter = *counter > UINT32_MAX - by ? UINT32_MAX : *counter + by;
}

/* CAN FD */

void auth_lane_init(auth_lane *lane, const cmac_key *key, dictionary_message message,
                    uint32_t instance, uint32_t last) {
  FRAY_ASSERT(lane != NULL && key != NULL);
  FRAY_ASSERT(message < MESSAGES && instance < DICTIONARY_INSTANCES);
  bytes_zero(lane, sizeof *lane);
  lane->key = key;
  const dictionary_message form = dictionary_auth(message);
  const uint32_t nothing = FRAME_ID_MAX + 1u;
  lane->plain_id = form == MESSAGES ? nothing : dictionary_id(message, instance);
  lane->id = form == MESSAGES ? nothing : dictionary_id(form, instance);
  lane->last = last;
  lane->max = message == MESSAGE_COMMAND && last < AUTH_RUNTIME_FIRST ? AUTH_RUNTIME_FIRST - 1u : UINT32_MAX;
}

static auth_reason auth_check_frame(const frame *f, uint32_t id, uint32_t length) {
  FRAY_ASSERT(f != NULL);
  if (f->id != id || f->extended) return AUTH_ID;
  if (f->rtr || f->error) return AUTH_FLAGS;
  if (f->length != length) return AUTH_LENGTH;
  return AUTH_OK;
}

/* The tag of `data`, which has its freshness already. */
static void auth_tag_fd(const auth_lane *lane, const uint8_t *data, uint8_t tag[CMAC_BLOCK]) {
  FRAY_ASSERT(lane->key != NULL);
  uint8_t message[4 + TAG_AT];
  bytes_store32(message, lane->id);
  bytes_copy(message + 4, data, TAG_AT);
  cmac_tag(lane->key, message, sizeof message, tag);
}

auth_reason auth_seal(auth_lane *lane, frame *f) {
  FRAY_ASSERT(lane != NULL && lane->key != NULL);
  uint8_t tag[CMAC_BLOCK];
  const auth_reason reason = auth_check_frame(f, lane->plain_id, PLAIN);
  if (reason != AUTH_OK) return reason;
  if (lane->last >= lane->max) return AUTH_SPENT;
  lane->last += 1;
  f->id = lane->id;
  f->fd = FRAME_FD | FRAME_FD_BRS;
  f->length = SEALED;
  bytes_store32(f->data + FRESHNESS_AT, lane->last);
  auth_tag_fd(lane, f->data, tag);
  bytes_copy(f->data + TAG_AT, tag, AUTH_TAG_FD);
  auth_count(&lane->accepted, 1);
  return AUTH_OK;
}

static void auth_plain(const frame *f, uint32_t id, frame *out) {
  uint8_t data[PLAIN];
  bytes_copy(data, f->data, sizeof data);
  bytes_zero(out, sizeof *out);
  out->id = id;
  out->length = PLAIN;
  bytes_copy(out->data, data, sizeof data);
}

auth_reason auth_open(auth_lane *lane, const frame *f, frame *out) {
  FRAY_ASSERT(lane != NULL && lane->key != NULL);
  FRAY_ASSERT(out != NULL);
  uint8_t tag[CMAC_BLOCK];
  auth_reason reason = auth_check_frame(f, lane->id, SEALED);
  if (reason == AUTH_OK && (f->fd & FRAME_FD) == 0) reason = AUTH_LENGTH;
  if (reason != AUTH_OK) {
    auth_count(&lane->malformed, 1);
    return reason;
  }
  const uint32_t freshness = bytes_load32(f->data + FRESHNESS_AT);
  if (freshness <= lane->last || freshness > lane->max) {
    auth_count(&lane->old, 1);
    return AUTH_OLD;
  }
  auth_tag_fd(lane, f->data, tag);
  if (cmac_differs(tag, f->data + TAG_AT, AUTH_TAG_FD) != 0) {
    auth_count(&lane->forged, 1);
    return AUTH_FORGED;
  }
  FRAY_ASSERT(freshness > lane->last && freshness <= lane->max);
  auth_count(&lane->lost, freshness - lane->last - 1u);
  auth_count(&lane->accepted, 1);
  lane->last = freshness;
  auth_plain(f, lane->plain_id, out);
  return AUTH_OK;
}

int auth_strip(const frame *f, uint32_t instance, frame *out) {
  FRAY_ASSERT(f != NULL && out != NULL);
  if (f->extended || f->rtr || f->error || f->length != SEALED) return 0;
  const dictionary_message message = dictionary_find(f->id, instance);
  if (message == MESSAGES || DICTIONARY[message].protects == MESSAGES) return 0;
  auth_plain(f, dictionary_id((dictionary_message)DICTIONARY[message].protects, instance), out);
  return 1;
}

/* Classic */

void auth_group_init(auth_group *group, const cmac_key *key, uint32_t instance, uint32_t hand,
                     uint32_t last) {
  FRAY_ASSERT(group != NULL && key != NULL);
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES && hand < 2);
  bytes_zero(group, sizeof *group);
  group->key = key;
  group->pose_id = dictionary_id(dictionary_pose(hand), instance);
  group->tag_id = dictionary_id(dictionary_tag(hand), instance);
  group->last = last;
  group->max = UINT32_MAX;
}

static void auth_group_store(auth_group *group, const frame *pose) {
  FRAY_ASSERT(group->count < AUTH_GROUP);
  bytes_copy(group->poses[group->count], pose->data, PLAIN);
  group->count += 1;
}

static void auth_tag_classic(const auth_group *group, uint32_t freshness,
                             uint8_t tag[CMAC_BLOCK]) {
  FRAY_ASSERT(group->key != NULL && freshness != 0);
  uint8_t message[8 + AUTH_GROUP * PLAIN];
  bytes_store32(message, group->tag_id);
  bytes_store32(message + 4, freshness);
  bytes_copy(message + 8, group->poses, sizeof group->poses);
  cmac_tag(group->key, message, sizeof message, tag);
}

int auth_group_add(auth_group *group, const frame *pose, frame *tag) {
  FRAY_ASSERT(group != NULL && tag != NULL);
  uint8_t whole[CMAC_BLOCK];
  if (auth_check_frame(pose, group->pose_id, PLAIN) != AUTH_OK) return 0;
  auth_group_store(group, pose);
  if (group->count < AUTH_GROUP) return 0;
  group->count = 0;
  if (group->last >= group->max) return 0;
  group->last += 1;
  auth_tag_classic(group, group->last, whole);
  bytes_zero(tag, sizeof *tag);
  tag->id = group->tag_id;
  tag->length = PLAIN;
  bytes_store16(tag->data, (uint16_t)(group->last & 0xFFFFu));
  bytes_copy(tag->data + 2, whole, AUTH_TAG_CLASSIC);
  return 1;
}

void auth_monitor_init(auth_monitor *monitor, const cmac_key *key, uint32_t instance, uint32_t hand,
                     uint32_t last) {
  FRAY_ASSERT(monitor != NULL);
  bytes_zero(monitor, sizeof *monitor);
  auth_group_init(&monitor->group, key, instance, hand, last);
}

void auth_monitor_clear(auth_monitor *monitor) {
  FRAY_ASSERT(monitor != NULL);
  monitor->level = 0;
  monitor->failed = 0;
  monitor->group.count = 0;
}

static void auth_monitor_fail(auth_monitor *monitor, uint32_t *counter) {
  FRAY_ASSERT(monitor->failed == 0 && monitor->level < AUTH_LEVEL_MAX);
  auth_count(counter, 1);
  monitor->level += AUTH_FAILURE;
  if (monitor->level < AUTH_LEVEL_MAX) return;
  monitor->level = AUTH_LEVEL_MAX;
  monitor->failed = 1;
}

static auth_verdict auth_monitor_pose(auth_monitor *monitor, const frame *f) {
  FRAY_ASSERT(monitor->group.count <= AUTH_GROUP);
  if (monitor->group.count == AUTH_GROUP) {
    auth_monitor_fail(monitor, &monitor->missing);
    monitor->group.count = 0;
    if (monitor->failed != 0) return AUTH_MONITOR_FAILED;
  }
  auth_group_store(&monitor->group, f);
  auth_count(&monitor->poses, 1);
  return AUTH_MONITOR_POSE;
}

/* The smallest freshness above `last` with these low 16 bits; 0 iff there is none. */
static uint32_t auth_freshness(uint32_t last, uint16_t low) {
  const uint32_t same = (last & 0xFFFF0000u) | low;
  if (same > last) return same;
  return same > UINT32_MAX - 0x10000u ? 0 : same + 0x10000u;
}

static int auth_tag_fits(const auth_group *group, const frame *f, uint32_t freshness) {
  uint8_t tag[CMAC_BLOCK];
  if (f->length != PLAIN || f->rtr || group->count != AUTH_GROUP || freshness == 0) return 0;
  auth_tag_classic(group, freshness, tag);
  return cmac_differs(tag, f->data + 2, AUTH_TAG_CLASSIC) == 0;
}

static auth_verdict auth_monitor_tag(auth_monitor *monitor, const frame *f) {
  FRAY_ASSERT(monitor->group.count <= AUTH_GROUP);
  auth_group *group = &monitor->group;
  const uint32_t freshness = auth_freshness(group->last, bytes_load16(f->data));
  const int fits = auth_tag_fits(group, f, freshness);
  group->count = 0;
  if (!fits) {
    auth_monitor_fail(monitor, &monitor->bad);
    return monitor->failed ? AUTH_MONITOR_FAILED : AUTH_MONITOR_BAD;
  }
  FRAY_ASSERT(freshness > group->last);
  group->last = freshness;
  monitor->level -= monitor->level > 0;
  auth_count(&monitor->good, 1);
  return AUTH_MONITOR_GOOD;
}

auth_verdict auth_monitor_check(auth_monitor *monitor, const frame *f) {
  FRAY_ASSERT(monitor != NULL && f != NULL);
  FRAY_ASSERT((monitor->failed != 0) == (monitor->level == AUTH_LEVEL_MAX));
  if (f->extended || f->error) return AUTH_MONITOR_OTHER;
  const int pose = auth_check_frame(f, monitor->group.pose_id, PLAIN) == AUTH_OK;
  if (!pose && f->id != monitor->group.tag_id) return AUTH_MONITOR_OTHER;
  if (monitor->failed != 0) return AUTH_MONITOR_FAILED;
  return pose ? auth_monitor_pose(monitor, f) : auth_monitor_tag(monitor, f);
}
