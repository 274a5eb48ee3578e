/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/port.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"

enum { LANE_COMMAND = FRAY_HANDS, LANES }; /* lane h < FRAY_HANDS: POSE of hand h */

static void port_count(uint32_t *counter, uint32_t by) {
  *counter = *counter > UINT32_MAX - by ? UINT32_MAX : *counter + by;
}

void port_init(port *p, uint32_t instance, uint32_t hands, const uint8_t *consumed) {
  FRAY_ASSERT(p != NULL);
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES && hands < 1u << FRAY_HANDS);
  bytes_zero(p, sizeof *p);
  p->instance = (uint8_t)(instance & 7u);
  p->hands = (uint8_t)(hands & 3u);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    sequence_begin(&p->pose[h], consumed == NULL ? 0 : consumed[h]);
}

/* The lane of a frame; LANES iff it is not for this port. */
static uint32_t port_lane(const port *p, const frame *f) {
  FRAY_ASSERT(f != NULL && p->instance < DICTIONARY_INSTANCES);
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
    port_count(reason == CODEC_LENGTH ? &p->statistics.wrong_length : &p->statistics.wrong_flags, 1);
    return;
  }
  queue_item *item = queue_add(&p->pending);
  if (item == NULL) {
    port_count(&p->statistics.queue_full, 1);
    return;
  }
  item->lane = (uint8_t)lane;
  item->keep = 0;
  bytes_copy(item->data, f->data, sizeof item->data);
}

static void port_push_gated(port *p, const frame *f) {
  frame plain;
  const frame *use = auth_gate_receive(p->gate, f, &plain);
  if (use != NULL) port_push_plain(p, use);
}

void port_push(port *p, const frame *f) {
  FRAY_ASSERT(p != NULL && f != NULL);
  if (AUTH_GATE_SET(p->gate))
    port_push_gated(p, f);
  else
    port_push_plain(p, f);
}

/* Returns 1 iff the counter differs from the last one. */
static int port_accept_command(port *p, uint8_t counter) {
  FRAY_ASSERT(p->command <= 15 && counter <= 15);
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

/* The poses of one hand in one tick. */
typedef struct {
  uint32_t poses; /* accepted */
  uint32_t ahead; /* how far their counters have advanced from the one consumed before */
} port_hand_input;

/* Adds a POSE of the hand; returns 0 iff it must stay for the next tick: the poses of one tick and the one
 * consumed before all have different counters. */
static int port_accept_pose(port *p, uint32_t hand, const fray_pose *pose, port_hand_input *of_hand,
                            fray_input *input) {
  FRAY_ASSERT(hand < FRAY_HANDS);
  FRAY_ASSERT(of_hand->poses < PORT_POSES_PER_TICK && of_hand->ahead <= 15);
  sequence after = p->pose[hand];
  const uint32_t ahead = sequence_ahead(&p->pose[hand], pose->counter);
  const sequence_result result = sequence_take(&after, pose->counter);
  if (result == SEQUENCE_NEW) {
    if (of_hand->ahead + ahead > 15u) return 0;
    of_hand->ahead += ahead;
    of_hand->poses += 1;
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
  FRAY_ASSERT(item->lane == LANE_COMMAND);
  if (input->command != FRAY_COMMAND_NONE) return 0;
  codec_command command;
  const codec_reason reason = codec_read_command(item->data, p->instance, &command);
  if (reason != CODEC_OK) {
    port_refuse(p, reason);
  } else if (port_accept_command(p, command.counter)) {
    input->command = command.command;
    input->command_counter = command.counter;
  }
  return 1;
}

static int port_read_pose(port *p, const queue_item *item, uint32_t hand, port_hand_input *of_hand,
                          fray_input *input) {
  FRAY_ASSERT(hand < FRAY_HANDS && (p->hands >> hand & 1) != 0);
  if (of_hand->poses == PORT_POSES_PER_TICK) return 0;
  fray_pose pose;
  const codec_reason reason = codec_read_pose(item->data, p->instance, hand, &pose);
  if (reason != CODEC_OK) {
    port_refuse(p, reason);
    return 1;
  }
  if (port_accept_pose(p, hand, &pose, of_hand, input)) return 1;
  of_hand->poses = PORT_POSES_PER_TICK; /* keeps those behind it in order */
  return 0;
}

void port_take(port *p, fray_input *input) {
  FRAY_ASSERT(p != NULL && input != NULL);
  bytes_zero(input, sizeof *input);
  port_hand_input hands[FRAY_HANDS] = {{0, 0}, {0, 0}};
  const uint32_t count = p->pending.count < PORT_FRAMES_PER_TICK ? p->pending.count
                                                                 : (uint32_t)PORT_FRAMES_PER_TICK;
  for (uint32_t n = 0; n < count; ++n) {
    queue_item *item = queue_at(&p->pending, n);
    const uint32_t lane = item->lane;
    FRAY_ASSERT(lane < LANES);
    const int taken = lane == LANE_COMMAND
                          ? port_read_command(p, item, input)
                          : port_read_pose(p, item, lane, &hands[lane], input);
    item->keep = taken == 0 ? 1u : 0u;
  }
  queue_drop(&p->pending, count);
}

void port_sender_init(port_sender *s, uint32_t instance, uint32_t hands, uint32_t rate_hz) {
  FRAY_ASSERT(s != NULL);
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES && hands < 1u << FRAY_HANDS && rate_hz > 0);
  bytes_zero(s, sizeof *s);
  s->instance = (uint8_t)(instance & 7u);
  s->hands = (uint8_t)(hands & 3u);
  s->status_ticks = rate_hz < 10 ? 1 : rate_hz / 10;
}

static uint16_t port_saturate16(uint32_t v) { return v > 65535u ? 65535u : (uint16_t)v; }

/* A change of tears or pool fill sends no STATUS: TEAR has the tears, and both may change in every tick of
 * a long tear, when the bus is busiest. By the low word of the tick: where that wraps, one comes early. */
static int port_status_due(const port_sender *s, const codec_status *now, uint32_t tick) {
  FRAY_ASSERT(s->status_ticks > 0);
  return !s->has_sent || now->state != s->sent.state || now->faults != s->sent.faults ||
         tick % s->status_ticks == 0;
}

/* Of the contacts, the pool that fills and empties while a world runs. */
static uint8_t port_fill_percent(const port_sender *s, const fray_output *output) {
  if (s->contacts_max == 0) return 0;
  const uint64_t percent = (uint64_t)output->work.contacts * 100u / s->contacts_max;
  return (uint8_t)(percent < 100u ? percent : 100u);
}

uint32_t port_encode(port_sender *s, const fray_output *output, frame frames[PORT_OUT]) {
  FRAY_ASSERT(s != NULL && output != NULL && frames != NULL);
  FRAY_ASSERT(s->instance < DICTIONARY_INSTANCES);
  uint32_t count = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if ((s->hands & 1u << h) == 0) continue;
    const int16_t *of = output->force[h];
    const codec_force force = {of[0], of[1], of[2], (uint8_t)(output->tick & 15u),
                               output->consumed[h]};
    codec_encode_force(&frames[count], s->instance, h, &force);
    count += 1;
  }
  if (output->answered != FRAY_COMMAND_NONE) {
    const codec_ack ack = {output->answer_counter, output->answered, output->result,
                           (uint32_t)(output->tick & UINT32_MAX)};
    codec_encode_ack(&frames[count], s->instance, &ack);
    count += 1;
  }
  if (output->work.tears > 0) {
    /* of the first event: tears come before cuts; only membranes have tear candidates, and always where they
     * tear */
    const uint8_t kind = output->work.blade_cuts == output->work.tears ? CODEC_TEAR_CUT
                         : output->work.tear_candidates != 0                 ? CODEC_TEAR_TRIANGLES
                                                                   : CODEC_TEAR_STRUCTURAL;
    const codec_tear tear = {kind, port_saturate16(output->work.tears - 1), output->first_tear};
    codec_encode_tear(&frames[count], s->instance, &tear);
    count += 1;
  }
  const codec_status now = {output->state, port_fill_percent(s, output), output->faults, s->overruns,
                            port_saturate16(output->tears_total)};
  if (port_status_due(s, &now, (uint32_t)(output->tick & UINT32_MAX))) {
    codec_encode_status(&frames[count], s->instance, &now);
    bytes_copy(&s->sent, &now, sizeof now);
    s->has_sent = 1;
    count += 1;
  }
  FRAY_ASSERT(count <= PORT_OUT);
  return count;
}
