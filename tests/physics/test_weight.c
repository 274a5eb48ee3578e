/* SPDX-License-Identifier: Apache-2.0 */
/* tests/scenes/weight.scene: a hand carries a strip with 10 g at its end and must feel 98.1 mN
 * within 1 %, beside the strip's own weight: the particles that neither body holds (those that the
 * holder grips are the hand's, those that the weight grips are the weight's; see haptics/haptic_force.c). */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { REST_TICKS = 3000, MEAN_TICKS = 500 };

static void the_hand_feels_the_weight(void) {
  fixture_scoped f = {0};
  double raw[3] = {0, 0, 0};
  double sent[3] = {0, 0, 0};
  double least = 1e9;
  double most = -1e9;
  double speed = 0;
  fixture_file(&f, "tests/scenes/weight.scene", NULL);
  fray_world *w = f.w;
  fray_output out = fixture_start_hands(&f, REST_TICKS);
  static const int32_t origin[FRAY_HANDS][3];
  CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
  for (uint32_t tick = 0; tick < MEAN_TICKS; ++tick) {
    const fray_input input = fixture_poses(&f, origin, tick);
    out = fixture_tick(&f, &input);
    for (uint32_t n = 0; n < 3; ++n) {
      raw[n] += out.force_unlimited[0][n] * 0.5 / MEAN_TICKS;
      sent[n] += out.force[0][n] * 0.5 / MEAN_TICKS;
    }
    least = fmin(least, out.force_unlimited[0][1] * 0.5);
    most = fmax(most, out.force_unlimited[0][1] * 0.5);
    for (uint32_t b = 0; b < f.facts.bodies; ++b)
      if (w->rigid.bodies[b].motion == FRAY_FREE)
        for (uint32_t n = 0; n < 3; ++n)
          speed = fmax(speed, fabs(w->rigid.states[b].velocity[n] * fixture_speed(&f)));
  }
  const uint32_t free_particles = (uint32_t)(w->params->particles - w->params->attached);
  const double strip = free_particles * fixture_mass_g(&f) * 981 * 0.01; /* dyn to mN: 0.01 */
  const double net = -raw[1] - strip;
  figure("weight_substeps", f.facts.substeps, "", "printed");
  figure("weight_strip_free_particles", free_particles, "", "printed");
  figure("weight_raw_y", raw[1], "mN", "printed");
  figure("weight_raw_y_least", least, "mN", "printed");
  figure("weight_raw_y_most", most, "mN", "printed");
  figure("weight_sent_y", sent[1], "mN", "as raw");
  figure("weight_strip", strip, "mN", "printed");
  figure("weight_net", net, "mN", "98.1 within 1 %");
  figure("weight_net_error", 100 * (net / 98.1 - 1), "%", "within 1");
  figure("weight_speed_left", speed, "cm/s", "printed");
  CHECK(fabs(net - 98.1) <= 0.981);
  /* the last stage lets all of it out: only halves of a step may be lost */
  CHECK(fabs(sent[1] - raw[1]) <= 0.5);
  CHECK(fabs(raw[0]) <= 0.981);
  CHECK(fabs(raw[2]) <= 0.981);
}

int main(void) {
  TEST(the_hand_feels_the_weight);
  return test_end();
}
