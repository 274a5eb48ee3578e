/* SPDX-License-Identifier: Apache-2.0 */
/* Frames written by hand; their CRCs come from an implementation of its own (a few lines of
 * Python), not from this one. */
#include "rt/wire/codec.h"

#include "rt/wire/dictionary.h"
#include "tests/lib/test.h"

static void check_frame(const frame *f, uint32_t id, const char *data) {
  char text[17];
  for (int n = 0; n < 8; ++n) snprintf(text + 2 * n, 3, "%02X", f->data[n]);
  CHECK_EQ_INT(f->id, id);
  CHECK_EQ_INT(f->length, 8);
  CHECK_EQ_INT(f->extended | f->rtr | f->error | f->fd, 0);
  CHECK_TEXT(text, data);
}

static void ids_of_instances(void) {
  CHECK_EQ_INT(dictionary_id(MESSAGE_SYNC, 7), 0x087);
  CHECK_EQ_INT(dictionary_id(MESSAGE_COMMAND, 7), 0x01E);
  CHECK_EQ_INT(dictionary_id(MESSAGE_ACK, 7), 0x01F);
  CHECK_EQ_INT(dictionary_id(MESSAGE_POSE_LEFT, 7), 0x171);
  CHECK_EQ_INT(dictionary_id(MESSAGE_POSE_RIGHT, 3), 0x132);
  CHECK_EQ_INT(dictionary_id(MESSAGE_FORCE_LEFT, 1), 0x191);
  CHECK_EQ_INT(dictionary_id(MESSAGE_FORCE_RIGHT, 7), 0x1F2);
  CHECK_EQ_INT(dictionary_id(MESSAGE_TEAR, 7), 0x207);
  CHECK_EQ_INT(dictionary_id(MESSAGE_STATUS, 7), 0x708);
  for (uint32_t m = 0; m < (uint32_t)MESSAGES; ++m) {
    for (uint32_t n = 0; n < DICTIONARY_INSTANCES; ++n) {
      const uint32_t id = dictionary_id((dictionary_message)m, n);
      for (uint32_t other = 0; other < DICTIONARY_INSTANCES; ++other) {
        CHECK_EQ_INT(dictionary_find(id, other), other == n ? m : (uint32_t)MESSAGES);
      }
    }
  }
}

static void sync_frames(void) {
  frame f;
  codec_sync out;
  const codec_sync in = {0x00012345, 0xDEADBEEF};
  codec_encode_sync(&f, 2, &in);
  check_frame(&f, 0x082, "45230100EFBEADDE");
  CHECK_EQ_INT(codec_decode_sync(&f, 2, &out), CODEC_OK);
  CHECK_EQ_INT(out.tick, 0x12345);
  CHECK_EQ_INT(out.hash, 0xDEADBEEF);
}

static void pose_frames(void) {
  frame f;
  fray_pose out;
  const fray_pose left = {1, -254, -32768, 3, 10};
  codec_encode_pose(&f, 0, 0, &left);
  check_frame(&f, 0x101, "28A3010002FF0080");
  CHECK_EQ_INT(codec_decode_pose(&f, 0, 0, &out), CODEC_OK);
  CHECK_EQ_INT(out.x, 1);
  CHECK_EQ_INT(out.y, -254);
  CHECK_EQ_INT(out.z, -32768);
  CHECK_EQ_INT(out.counter, 3);
  CHECK_EQ_INT(out.buttons, 10);
  const fray_pose right = {-1, 10, -12, 1, 5};
  codec_encode_pose(&f, 3, 1, &right);
  check_frame(&f, 0x132, "9151FFFF0A00F4FF");
}

static void force_frames(void) {
  frame f;
  codec_force out;
  const codec_force in = {1234, 32767, -32767, 7, 12};
  codec_encode_force(&f, 5, 0, &in);
  check_frame(&f, 0x1D1, "D5C7D204FF7F0180");
  CHECK_EQ_INT(codec_decode_force(&f, 5, 0, &out), CODEC_OK);
  CHECK_EQ_INT(out.x, 1234);
  CHECK_EQ_INT(out.y, 32767);
  CHECK_EQ_INT(out.z, -32767);
  CHECK_EQ_INT(out.counter, 7);
  CHECK_EQ_INT(out.consumed, 12);
  const codec_force zero = {0, 0, 0, 0, 0};
  codec_encode_force(&f, 0, 1, &zero);
  check_frame(&f, 0x182, "6200000000000000");
}

static void command_frames(void) {
  frame f;
  codec_command out;
  const codec_command start = {1, FRAY_COMMAND_START, 0};
  codec_encode_command(&f, 0, &start);
  check_frame(&f, 0x010, "EC01010000000000");
  const codec_command in = {15, FRAY_COMMAND_RESET, 0x12345678};
  codec_encode_command(&f, 7, &in);
  check_frame(&f, 0x01E, "CF0F030078563412");
  CHECK_EQ_INT(codec_decode_command(&f, 7, &out), CODEC_OK);
  CHECK_EQ_INT(out.counter, 15);
  CHECK_EQ_INT(out.command, FRAY_COMMAND_RESET);
  CHECK_EQ_INT(out.argument, 0x12345678);
}

static void ack_frames(void) {
  frame f;
  codec_ack out;
  const codec_ack in = {15, FRAY_COMMAND_ZERO, FRAY_RESULT_REFUSED, 20};
  codec_encode_ack(&f, 2, &in);
  check_frame(&f, 0x015, "E7F4040114000000");
  CHECK_EQ_INT(codec_decode_ack(&f, 2, &out), CODEC_OK);
  CHECK_EQ_INT(out.command_counter, 15);
  CHECK_EQ_INT(out.command, FRAY_COMMAND_ZERO);
  CHECK_EQ_INT(out.result, FRAY_RESULT_REFUSED);
  CHECK_EQ_INT(out.tick, 20);
}

static void tear_and_status_frames(void) {
  frame f;
  codec_tear tear;
  codec_status status;
  const codec_tear cut = {CODEC_TEAR_STRUCTURAL, 300, 70000};
  codec_encode_tear(&f, 0, &cut);
  check_frame(&f, 0x200, "01002C0170110100");
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_OK);
  CHECK_EQ_INT(tear.more, 300);
  const codec_tear torn = {CODEC_TEAR_TRIANGLES, 0, 5};
  codec_encode_tear(&f, 0, &torn);
  check_frame(&f, 0x200, "0200000005000000");
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_OK);
  CHECK_EQ_INT(tear.kind, CODEC_TEAR_TRIANGLES);
  const codec_tear slashed = {CODEC_TEAR_CUT, 2, 6};
  codec_encode_tear(&f, 0, &slashed);
  check_frame(&f, 0x200, "0300020006000000");
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_OK);
  CHECK_EQ_INT(tear.kind, CODEC_TEAR_CUT);
  f.data[0] = 4;
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_FIELD);
  codec_encode_tear(&f, 0, &cut);
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_OK);
  CHECK_EQ_INT(tear.element, 70000);
  const codec_status now = {FRAY_SAFE, 100, FRAY_FAULT_STALE_RIGHT | FRAY_FAULT_OUT_OF_WORLD, 258,
                            65535};
  codec_encode_status(&f, 1, &now);
  check_frame(&f, 0x702, "036412000201FFFF");
  CHECK_EQ_INT(codec_decode_status(&f, 1, &status), CODEC_OK);
  CHECK_EQ_INT(status.state, FRAY_SAFE);
  CHECK_EQ_INT(status.fill_percent, 100);
  CHECK_EQ_INT(status.faults, 18);
  CHECK_EQ_INT(status.overruns, 258);
  CHECK_EQ_INT(status.tears, 65535);
}

static void identity_frames(void) {
  frame f;
  codec_identity out;
  const codec_identity in = {0x265C59E9, 3};
  codec_encode_identity(&f, 7, &in);
  check_frame(&f, 0x710, "E9595C2603000000");
  CHECK_EQ_INT(codec_decode_identity(&f, 7, &out), CODEC_OK);
  CHECK_EQ_INT(out.physics, 0x265C59E9);
  CHECK_EQ_INT(out.tick_high, 3);
  CHECK_EQ_INT(codec_decode_identity(&f, 6, &out), CODEC_ID);
  f.length = 7;
  CHECK_EQ_INT(codec_decode_identity(&f, 7, &out), CODEC_LENGTH);
}

/* Every way in which a frame can be wrong, on a good COMMAND, ACK, TEAR and STATUS. */
static codec_reason command_of(uint8_t crc, uint8_t one, uint8_t verb, uint8_t reserved) {
  codec_command out;
  const frame f = {0x010, 0, 0, 0, 0, 8, {crc, one, verb, reserved}};
  return codec_decode_command(&f, 0, &out);
}

static void refused_frames(void) {
  codec_command out;
  frame f = {0x010, 0, 0, 0, 0, 8, {0xEC, 0x01, 0x01}};
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_OK);
  f.fd = FRAME_FD;
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_OK);
  CHECK_EQ_INT(codec_decode_command(&f, 1, &out), CODEC_ID);
  f.extended = 1;
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_ID);
  f.extended = 0;
  f.rtr = 1;
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_FLAGS);
  f.rtr = 0;
  f.error = 1;
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_FLAGS);
  f.error = 0;
  f.length = 7;
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_LENGTH);
  f.length = 12;
  CHECK_EQ_INT(codec_decode_command(&f, 0, &out), CODEC_LENGTH);
  CHECK_EQ_INT(command_of(0xED, 0x01, 0x01, 0x00), CODEC_CRC);
}

static void refused_fields(void) {
  codec_ack ack;
  codec_tear tear;
  codec_status status;
  CHECK_EQ_INT(command_of(0x3F, 0x01, 0x01, 0x10), CODEC_RESERVED);
  CHECK_EQ_INT(command_of(0x4E, 0x11, 0x01, 0x00), CODEC_RESERVED);
  CHECK_EQ_INT(command_of(0x18, 0x01, 0x00, 0x00), CODEC_FIELD);
  /* Counter 5 in tick 1; result 3. */
  const frame late = {0x011, 0, 0, 0, 0, 8, {0x67, 0x15, 1, 0, 1, 0, 0, 0}};
  CHECK_EQ_INT(codec_decode_ack(&late, 0, &ack), CODEC_FIELD);
  const frame result = {0x011, 0, 0, 0, 0, 8, {0xDD, 0x11, 1, 3, 1, 0, 0, 0}};
  CHECK_EQ_INT(codec_decode_ack(&result, 0, &ack), CODEC_FIELD);
  frame f = {0x200, 0, 0, 0, 0, 8, {1, 1, 0, 0, 0, 0, 0, 0}};
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_RESERVED);
  f.data[0] = 4;
  f.data[1] = 0;
  CHECK_EQ_INT(codec_decode_tear(&f, 0, &tear), CODEC_FIELD);
  f.id = 0x701;
  f.data[0] = 4;
  CHECK_EQ_INT(codec_decode_status(&f, 0, &status), CODEC_FIELD);
  f.data[0] = 1;
  f.data[1] = 101;
  CHECK_EQ_INT(codec_decode_status(&f, 0, &status), CODEC_FIELD);
}

/* A right POSE is no left one, even under its id. */
static void hands_are_not_exchanged(void) {
  frame f;
  fray_pose pose;
  const fray_pose in = {1, 2, 3, 4, 5};
  codec_encode_pose(&f, 0, 1, &in);
  f.id = dictionary_id(MESSAGE_POSE_LEFT, 0);
  CHECK_EQ_INT(codec_decode_pose(&f, 0, 0, &pose), CODEC_CRC);
}

int main(void) {
  TEST(ids_of_instances);
  TEST(sync_frames);
  TEST(pose_frames);
  TEST(force_frames);
  TEST(command_frames);
  TEST(ack_frames);
  TEST(tear_and_status_frames);
  TEST(identity_frames);
  TEST(refused_frames);
  TEST(refused_fields);
  TEST(hands_are_not_exchanged);
  return test_end();
}
