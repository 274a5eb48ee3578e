/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/codec.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/e2e.h"

enum { LENGTH = DICTIONARY_LENGTH };

const char *codec_reason_text(codec_reason reason) {
  switch (reason) {
    case CODEC_OK: return "no error";
    case CODEC_ID: return "another id";
    case CODEC_FLAGS: return "a remote or error frame";
    case CODEC_LENGTH: return "a wrong length";
    case CODEC_CRC: return "a wrong CRC";
    case CODEC_RESERVED: return "a reserved field that is not 0";
    case CODEC_FIELD: return "a field outside its range";
  }
  return "an unknown reason";
}

static int16_t codec_load_signed(const uint8_t *p) { return (int16_t)bytes_load16(p); }

static void codec_store_signed(uint8_t *p, int16_t v) { bytes_store16(p, (uint16_t)v); }

static void codec_begin(frame *f, dictionary_message message, uint32_t instance) {
  FRAY_ASSERT(f != NULL && message < MESSAGES && instance < DICTIONARY_INSTANCES);
  bytes_zero(f, sizeof *f);
  f->id = dictionary_id(message, instance);
  f->length = LENGTH;
}

static uint8_t codec_high(uint8_t nibble) { return (uint8_t)((nibble & 15u) << 4); }

static void codec_protect(frame *f, dictionary_message message, uint32_t instance,
                          uint8_t counter) {
  e2e_protect(f->data, LENGTH, dictionary_e2e_base(message, instance), counter);
}

codec_reason codec_check_frame(const frame *f, uint32_t id) {
  FRAY_ASSERT(f != NULL);
  FRAY_ASSERT(id <= FRAME_ID_MAX);
  if (f->id != id || f->extended) return CODEC_ID;
  if (f->rtr || f->error) return CODEC_FLAGS;
  if (f->length != LENGTH) return CODEC_LENGTH;
  return CODEC_OK;
}

static codec_reason codec_check(const frame *f, dictionary_message message, uint32_t instance) {
  return codec_check_frame(f, dictionary_id(message, instance));
}

static int codec_protected(const uint8_t *data, dictionary_message message, uint32_t instance) {
  return e2e_check(data, LENGTH, dictionary_e2e_base(message, instance));
}

/* SYNC and IDENTITY are two words. */

static void codec_encode_words(frame *f, dictionary_message message, uint32_t instance, uint32_t first,
                               uint32_t second) {
  codec_begin(f, message, instance);
  bytes_store32(f->data, first);
  bytes_store32(f->data + 4, second);
}

static codec_reason codec_decode_words(const frame *f, dictionary_message message, uint32_t instance,
                                       uint32_t *first, uint32_t *second) {
  const codec_reason reason = codec_check(f, message, instance);
  if (reason != CODEC_OK) return reason;
  *first = bytes_load32(f->data);
  *second = bytes_load32(f->data + 4);
  return CODEC_OK;
}

void codec_encode_sync(frame *f, uint32_t instance, const codec_sync *in) {
  FRAY_ASSERT(in != NULL);
  codec_encode_words(f, MESSAGE_SYNC, instance, in->tick, in->hash);
}

codec_reason codec_decode_sync(const frame *f, uint32_t instance, codec_sync *out) {
  FRAY_ASSERT(out != NULL);
  return codec_decode_words(f, MESSAGE_SYNC, instance, &out->tick, &out->hash);
}

void codec_encode_identity(frame *f, uint32_t instance, const codec_identity *in) {
  FRAY_ASSERT(in != NULL);
  codec_encode_words(f, MESSAGE_IDENTITY, instance, in->physics, in->tick_high);
}

codec_reason codec_decode_identity(const frame *f, uint32_t instance, codec_identity *out) {
  FRAY_ASSERT(out != NULL);
  return codec_decode_words(f, MESSAGE_IDENTITY, instance, &out->physics, &out->tick_high);
}

/* POSE */

void codec_encode_pose(frame *f, uint32_t instance, uint32_t hand, const fray_pose *in) {
  FRAY_ASSERT(in != NULL && in->counter <= 15 && in->buttons <= 15);
  const dictionary_message message = dictionary_pose(hand);
  codec_begin(f, message, instance);
  f->data[1] = codec_high(in->buttons);
  codec_store_signed(f->data + 2, in->x);
  codec_store_signed(f->data + 4, in->y);
  codec_store_signed(f->data + 6, in->z);
  codec_protect(f, message, instance, in->counter);
}

codec_reason codec_read_pose(const uint8_t *data, uint32_t instance, uint32_t hand,
                             fray_pose *out) {
  FRAY_ASSERT(data != NULL && out != NULL);
  if (!codec_protected(data, dictionary_pose(hand), instance)) return CODEC_CRC;
  out->counter = data[1] & 15u;
  out->buttons = (uint8_t)(data[1] >> 4);
  out->x = codec_load_signed(data + 2);
  out->y = codec_load_signed(data + 4);
  out->z = codec_load_signed(data + 6);
  return CODEC_OK;
}

codec_reason codec_decode_pose(const frame *f, uint32_t instance, uint32_t hand, fray_pose *out) {
  const codec_reason reason = codec_check(f, dictionary_pose(hand), instance);
  return reason != CODEC_OK ? reason : codec_read_pose(f->data, instance, hand, out);
}

/* FORCE */

void codec_encode_force(frame *f, uint32_t instance, uint32_t hand, const codec_force *in) {
  FRAY_ASSERT(in != NULL && in->counter <= 15 && in->consumed <= 15);
  const dictionary_message message = dictionary_force(hand);
  codec_begin(f, message, instance);
  f->data[1] = codec_high(in->consumed);
  codec_store_signed(f->data + 2, in->x);
  codec_store_signed(f->data + 4, in->y);
  codec_store_signed(f->data + 6, in->z);
  codec_protect(f, message, instance, in->counter);
}

codec_reason codec_decode_force(const frame *f, uint32_t instance, uint32_t hand,
                                codec_force *out) {
  FRAY_ASSERT(out != NULL);
  const codec_reason reason = codec_check(f, dictionary_force(hand), instance);
  if (reason != CODEC_OK) return reason;
  if (!codec_protected(f->data, dictionary_force(hand), instance)) return CODEC_CRC;
  out->counter = f->data[1] & 15u;
  out->consumed = (uint8_t)(f->data[1] >> 4);
  out->x = codec_load_signed(f->data + 2);
  out->y = codec_load_signed(f->data + 4);
  out->z = codec_load_signed(f->data + 6);
  return CODEC_OK;
}

/* COMMAND */

void codec_encode_command(frame *f, uint32_t instance, const codec_command *in) {
  FRAY_ASSERT(in != NULL && in->counter <= 15);
  codec_begin(f, MESSAGE_COMMAND, instance);
  f->data[2] = in->command;
  bytes_store32(f->data + 4, in->argument);
  codec_protect(f, MESSAGE_COMMAND, instance, in->counter);
}

codec_reason codec_read_command(const uint8_t *data, uint32_t instance, codec_command *out) {
  FRAY_ASSERT(data != NULL && out != NULL);
  if (!codec_protected(data, MESSAGE_COMMAND, instance)) return CODEC_CRC;
  if ((data[1] & 0xF0u) != 0 || data[3] != 0) return CODEC_RESERVED;
  if (data[2] == FRAY_COMMAND_NONE) return CODEC_FIELD;
  out->counter = data[1] & 15u;
  out->command = data[2];
  out->argument = bytes_load32(data + 4);
  return CODEC_OK;
}

codec_reason codec_decode_command(const frame *f, uint32_t instance, codec_command *out) {
  const codec_reason reason = codec_check(f, MESSAGE_COMMAND, instance);
  return reason != CODEC_OK ? reason : codec_read_command(f->data, instance, out);
}

/* ACK */

void codec_encode_ack(frame *f, uint32_t instance, const codec_ack *in) {
  FRAY_ASSERT(in != NULL && in->command_counter <= 15);
  codec_begin(f, MESSAGE_ACK, instance);
  f->data[1] = codec_high(in->command_counter);
  f->data[2] = in->command;
  f->data[3] = in->result;
  bytes_store32(f->data + 4, in->tick);
  codec_protect(f, MESSAGE_ACK, instance, (uint8_t)(in->tick & 15u));
}

codec_reason codec_decode_ack(const frame *f, uint32_t instance, codec_ack *out) {
  FRAY_ASSERT(out != NULL);
  const codec_reason reason = codec_check(f, MESSAGE_ACK, instance);
  if (reason != CODEC_OK) return reason;
  if (!codec_protected(f->data, MESSAGE_ACK, instance)) return CODEC_CRC;
  const uint32_t tick = bytes_load32(f->data + 4);
  if ((f->data[1] & 15u) != (tick & 15u)) return CODEC_FIELD;
  if (f->data[2] == FRAY_COMMAND_NONE || f->data[3] > FRAY_RESULT_UNKNOWN) return CODEC_FIELD;
  out->command_counter = (uint8_t)(f->data[1] >> 4);
  out->command = f->data[2];
  out->result = f->data[3];
  out->tick = tick;
  return CODEC_OK;
}

/* TEAR */

void codec_encode_tear(frame *f, uint32_t instance, const codec_tear *in) {
  FRAY_ASSERT(in != NULL && in->kind >= CODEC_TEAR_STRUCTURAL && in->kind <= CODEC_TEAR_CUT);
  codec_begin(f, MESSAGE_TEAR, instance);
  f->data[0] = in->kind;
  bytes_store16(f->data + 2, in->more);
  bytes_store32(f->data + 4, in->element);
}

codec_reason codec_decode_tear(const frame *f, uint32_t instance, codec_tear *out) {
  FRAY_ASSERT(out != NULL);
  const codec_reason reason = codec_check(f, MESSAGE_TEAR, instance);
  if (reason != CODEC_OK) return reason;
  if (f->data[1] != 0) return CODEC_RESERVED;
  if (f->data[0] < CODEC_TEAR_STRUCTURAL || f->data[0] > CODEC_TEAR_CUT) return CODEC_FIELD;
  out->kind = f->data[0];
  out->more = bytes_load16(f->data + 2);
  out->element = bytes_load32(f->data + 4);
  return CODEC_OK;
}

/* STATUS */

void codec_encode_status(frame *f, uint32_t instance, const codec_status *in) {
  FRAY_ASSERT(in != NULL && in->state <= FRAY_SAFE && in->fill_percent <= 100);
  FRAY_ASSERT((in->faults & ~(uint32_t)FRAY_FAULTS_ALL) == 0);
  codec_begin(f, MESSAGE_STATUS, instance);
  f->data[0] = in->state;
  f->data[1] = in->fill_percent;
  bytes_store16(f->data + 2, in->faults);
  bytes_store16(f->data + 4, in->overruns);
  bytes_store16(f->data + 6, in->tears);
}

codec_reason codec_decode_status(const frame *f, uint32_t instance, codec_status *out) {
  FRAY_ASSERT(out != NULL);
  const codec_reason reason = codec_check(f, MESSAGE_STATUS, instance);
  if (reason != CODEC_OK) return reason;
  if (f->data[0] > FRAY_SAFE || f->data[1] > 100) return CODEC_FIELD;
  out->state = f->data[0];
  out->fill_percent = f->data[1];
  out->faults = bytes_load16(f->data + 2);
  out->overruns = bytes_load16(f->data + 4);
  out->tears = bytes_load16(f->data + 6);
  return CODEC_OK;
}
