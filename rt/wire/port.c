/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/port.h"

#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"

enum { LANE_COMMAND = FRAY_HANDS, LANES }; /* the first ones are POSE of a hand */

static void port_count(uint32_t *counter, uint32_t by) {
  *counter = *counter > UINT32_MAX - by ? UINT32_MAX : *counter + by;
}

void port_init(port *p, uint32_t instance, uint32_t hands, const uint8_t *consumed) {
  bytes_zero(p, sizeof *p);
  p->instance = (uint8_t)(instance & 7u);
  p->hands = (uint8_t)(hands & 3u);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    sequence_begin(&p->pose[h], consumed == NULL ? 0 : consumed[h]);
}

/* LANES iff the frame is not for this port. */
static uint32_t port_lane(const port *p, const frame *f) {
  if (f->extended || f->error) return LANES;
  switch (dictionary_find(f->id, p->instance)) {
    case MESSAGE_POSE_LEFT: return (p->hands & 1u) != 0 ? 0u : (uint32_t)LANES;
    case MESSAGE_POSE_RIGHT: return (p->hands & 2u) != 0 ? 1u : (uint32_t)LANES;
    case MESSAGE_COMMAND: return LANE_COMMAND;
    default: return LANES;
  }
}

static void port_push_plain(port *p, const frame *f) {
  const uint32_t lane = port_lane(p, f);
  if (lane == LANES) {
    port_count(&p->statistics.unknown_id, 1);
    return;
  }
  const codec_reason reason = codec_check_frame(f, f->id);
  if (reason != CODEC_OK) {
    port_count(reason == CODEC_LENGTH ? &p->statistics.wrong_length : &p->statistics.wrong_flags,
               1);
    return;
  }
  queue_item *item = queue_add(&p->waiting);
  if (item == NULL) {
    port_count(&p->statistics.queue_full, 1);
    return;
  }
  item->lane = (uint8_t)lane;
  item->waits = 0;
  bytes_copy(item->data, f->data, sizeof item->data);
}

static void port_push_guarded(port *p, const frame *f) {
  frame plain;
  const frame *use = guard_take(p->guard, f, &plain);
  if (use != NULL) port_push_plain(p, use);
}

void port_push(port *p, const frame *f) {
  if (GUARD_SET(p->guard))
    port_push_guarded(p, f);
  else
    port_push_plain(p, f);
}

/* 1 iff the counter differs from the last one. */
static int port_accept_command(port *p, uint8_t counter) {
  const uint32_t ahead = ((uint32_t)counter + 16u - p->command) & 15u;
  if (ahead == 0) {
    port_count(&p->statistics.repeated, 1);
    return 0;
  }
  port_count(&p->statistics.lost, ahead - 1);
  port_count(&p->statistics.accepted, 1);
  p->command = counter;
  return 1;
}

static void port_refuse(port *p, codec_reason reason) {
  port_count(reason == CODEC_CRC ? &p->statistics.wrong_crc : &p->statistics.wrong_field, 1);
}

/* What one tick has of a hand. */
typedef struct {
  uint32_t poses; /* accepted */
  uint32_t ahead; /* how far they went on from the one consumed before */
} port_share;

/* One more POSE of the hand; 0 iff it has to wait: of what a tick accepts no two have the same
 * counter, nor that of the one consumed before. */
static int port_accept_pose(port *p, uint32_t hand, const fray_pose *pose, port_share *share,
                            fray_input *input) {
  sequence after = p->pose[hand];
  const uint32_t ahead = sequence_ahead(&p->pose[hand], pose->counter);
  const sequence_result result = sequence_take(&after, pose->counter);
  if (result == SEQUENCE_NEW) {
    if (share->ahead + ahead > 15u) return 0;
    share->ahead += ahead;
    share->poses += 1;
    if (ahead <= SEQUENCE_AHEAD) port_count(&p->statistics.lost, ahead - 1);
    port_count(&p->statistics.accepted, 1);
    bytes_copy(&input->pose[hand], pose, sizeof *pose);
    input->has_pose = (uint8_t)(input->has_pose | 1u << hand);
  } else {
    port_count(result == SEQUENCE_OLD ? &p->statistics.old : &p->statistics.repeated, 1);
  }
  p->pose[hand] = after;
  return 1;
}

static int port_read_command(port *p, const queue_item *item, fray_input *input) {
  if (input->verb != FRAY_VERB_NONE) return 0;
  codec_command command;
  const codec_reason reason = codec_read_command(item->data, p->instance, &command);
  if (reason != CODEC_OK) {
    port_refuse(p, reason);
  } else if (port_accept_command(p, command.counter)) {
    input->verb = command.verb;
    input->verb_counter = command.counter;
  }
  return 1;
}

static int port_read_pose(port *p, const queue_item *item, uint32_t hand, port_share *share,
                          fray_input *input) {
  if (share->poses == PORT_POSES_PER_TICK) return 0;
  fray_pose pose;
  const codec_reason reason = codec_read_pose(item->data, p->instance, hand, &pose);
  if (reason != CODEC_OK) {
    port_refuse(p, reason);
    return 1;
  }
  if (port_accept_pose(p, hand, &pose, share, input)) return 1;
  share->poses = PORT_POSES_PER_TICK; /* the others wait behind it */
  return 0;
}

void port_take(port *p, fray_input *input) {
  bytes_zero(input, sizeof *input);
  port_share shares[FRAY_HANDS] = {{0, 0}, {0, 0}};
  const uint32_t count = p->waiting.count < PORT_FRAMES_PER_TICK ? p->waiting.count
                                                                 : (uint32_t)PORT_FRAMES_PER_TICK;
  for (uint32_t n = 0; n < count; ++n) {
    queue_item *item = queue_at(&p->waiting, n);
    const uint32_t lane = item->lane;
    const int taken = lane == LANE_COMMAND
                          ? port_read_command(p, item, input)
                          : port_read_pose(p, item, lane, &shares[lane], input);
    item->waits = taken == 0 ? 1u : 0u;
  }
  queue_drop(&p->waiting, count);
}

void port_sender_init(port_sender *s, uint32_t instance, uint32_t hands, uint32_t rate_hz) {
  bytes_zero(s, sizeof *s);
  s->instance = (uint8_t)(instance & 7u);
  s->hands = (uint8_t)(hands & 3u);
  s->status_ticks = rate_hz < 10 ? 1 : rate_hz / 10;
}

static uint16_t port_saturate16(uint32_t v) { return v > 65535u ? 65535u : (uint16_t)v; }

/* Tears and pool fill do not make a STATUS: a TEAR says the first, and both may change in every
 * tick of a long tear, when the bus is at its fullest. */
static int port_status_due(const port_sender *s, const codec_status *now, uint32_t tick) {
  return !s->has_sent || now->state != s->sent.state || now->faults != s->sent.faults ||
         tick % s->status_ticks == 0;
}

/* Contacts are the pool that fills and empties while a world runs. */
static uint8_t fill_percent(const port_sender *s, const fray_output *output) {
  if (s->contacts_max == 0) return 0;
  const uint64_t percent = (uint64_t)output->work.contacts * 100u / s->contacts_max;
  return (uint8_t)(percent < 100u ? percent : 100u);
}

uint32_t port_encode(port_sender *s, const fray_output *output, frame frames[PORT_OUT]) {
  uint32_t count = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if ((s->hands & 1u << h) == 0) continue;
    const int16_t *of = output->force[h];
    const codec_force force = {of[0], of[1], of[2], (uint8_t)(output->tick & 15u),
                               output->consumed[h]};
    codec_encode_force(&frames[count], s->instance, h, &force);
    count += 1;
  }
  if (output->acked != FRAY_VERB_NONE) {
    const codec_ack ack = {output->ack_counter, output->acked, output->result, output->tick};
    codec_encode_ack(&frames[count], s->instance, &ack);
    count += 1;
  }
  if (output->work.cuts > 0) {
    /* the first one's: tears come before cuts; only triangle sheets try lines, and none tears without */
    const uint8_t kind = output->work.slashes == output->work.cuts ? CODEC_TEAR_CUT
                         : output->work.lines != 0                 ? CODEC_TEAR_TRIANGLES
                                                                   : CODEC_TEAR_STRUCTURAL;
    const codec_tear tear = {kind, port_saturate16(output->work.cuts - 1), output->cut_first};
    codec_encode_tear(&frames[count], s->instance, &tear);
    count += 1;
  }
  const codec_status now = {output->state, fill_percent(s, output), output->faults, s->overruns,
                            port_saturate16(output->cuts_total)};
  if (port_status_due(s, &now, output->tick)) {
    codec_encode_status(&frames[count], s->instance, &now);
    bytes_copy(&s->sent, &now, sizeof now);
    s->has_sent = 1;
    count += 1;
  }
  return count;
}
