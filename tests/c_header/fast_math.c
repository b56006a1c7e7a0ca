/* SPDX-License-Identifier: Apache-2.0 */
/* Bad input of a header that is compiled as if all numbers were finite, or sums might be ordered
   anew. A robot on one foot also rests where its plan does. Reads one posture of write_header.cpp;
   ends with 1 if something was wrong. */
#include <stdio.h>

#include "robot.h"

static robot_state state;
static const double* none;
static int wrong;

static void expect(int good, const char* what) {
  if (good) return;
  printf("wrong: %s\n", what);
  ++wrong;
}

/* Numbers that the compiler does not know. */
static double number(uint64_t bits) {
  volatile uint64_t hidden = bits;
  const uint64_t seen = hidden;
  double value;
  memcpy(&value, &seen, sizeof value);
  return value;
}

/* By the bits, as the compiler would leave out a test of NaN. */
static int same(const double* a, const double* b) {
  int c, good = 1;
  for (c = 0; c < ROBOT_Q_COUNT; ++c) good = good && ec_is_sane(a[c]) && fabs(a[c] - b[c]) < 1e-9;
  return good;
}

static void positions(double bad, double* q) {
  double first[ROBOT_Q_COUNT], out[ROBOT_Q_COUNT], six[6], residual[2];
  ec_pose links[ROBOT_LINK_COUNT], targets[ROBOT_TIP_COUNT], root;
  const double good = q[3];
  int i;
  robot_init(&state);
  q[3] = bad;
  expect(robot_command(&state, q, none, 1, out, residual) == (EC_BAD_POSITION | EC_NOTHING_YET),
         "status of a first plan");
  q[3] = good;
  expect(!(robot_command(&state, q, none, 1, first, residual) & EC_BAD_POSITION), "a good plan");
  robot_forward(&state, q, none, 1, links, &root);
  robot_correct(&state, q, none, 1, out, six);
  q[3] = bad;
  expect((robot_command(&state, q, none, 1, out, residual) & EC_BAD_POSITION) != 0, "plan");
  expect(same(out, first), "command for a bad plan");
  expect((robot_forward(&state, q, none, 1, links, &root) & EC_BAD_POSITION) != 0, "forward");
  expect((robot_correct(&state, q, none, 1, out, six) & EC_BAD_POSITION) != 0, "correct");
  expect(!robot_start_from(&state, q), "start");
  q[3] = good;
  for (i = 0; i < ROBOT_TIP_COUNT; ++i) targets[i] = root;
  targets[0].p[1] = bad;
  expect((robot_command_poses(&state, targets, q, none, 1, out, residual) & EC_BAD_POSITION) != 0,
         "target");
  expect(same(out, first), "command for a bad target");
  expect(robot_start_from(&state, first), "a good start");
  q[3] = bad;
  expect((robot_command(&state, q, none, 1, out, residual) & EC_NOTHING_YET) != 0, "after a start");
  expect(same(out, first), "the command of the start");
  q[3] = good;
}

static void torques(double bad, const double* q) {
  double torque[ROBOT_JOINT_COUNT];
  ec_pose links[ROBOT_LINK_COUNT], root;
  int k;
  robot_init(&state);
  for (k = 0; k < ROBOT_JOINT_COUNT; ++k) torque[k] = bad;
  expect(robot_forward(&state, q, torque, 1, links, &root) == EC_FINE, "torques never known");
  torque[2] = 1.0;
  robot_forward(&state, q, torque, 1, links, &root);
  torque[2] = bad;
  expect(robot_forward(&state, q, torque, 1, links, &root) == EC_BAD_TORQUE, "a lost torque");
  robot_forward(&state, q, none, 1, links, &root);
  expect(robot_forward(&state, q, torque, 1, links, &root) == EC_BAD_TORQUE, "a forgotten torque");
}

/* Limits that are none, and an easing that is none, change nothing. */
static void choices(double bad, const double* q) {
  double most[ROBOT_Q_COUNT], plan[ROBOT_Q_COUNT], out[2][ROBOT_Q_COUNT], residual[2];
  int c, i, chosen;
  for (c = 0; c < ROBOT_Q_COUNT; ++c) most[c] = bad;
  for (chosen = 0; chosen < 2; ++chosen) {
    robot_init(&state);
    if (chosen) {
      robot_limit_changes(&state, most);
      robot_ease_changes(&state, bad);
    }
    for (i = 0; i < 3; ++i) {
      for (c = 0; c < ROBOT_Q_COUNT; ++c) plan[c] = q[c] + 0.01 * i;
      robot_command(&state, plan, none, 1, out[chosen], residual);
    }
  }
  expect(memcmp(out[0], out[1], sizeof out[0]) == 0, "limits that are none");
}

int main(void) {
  const uint64_t bad[] = {0x7FF8000000000000U, 0xFFF8000000000000U, 0x7FF0000000000000U,
                          0xFFF0000000000000U};
  double q[ROBOT_Q_COUNT];
  unsigned feet;
  int i;
  if (scanf("%u", &feet) != 1) return 1;
  for (i = 0; i < ROBOT_Q_COUNT; ++i) {
    if (scanf("%lf", &q[i]) != 1) return 1;
  }
  for (i = 0; i < 4; ++i) {
    positions(number(bad[i]), q);
    torques(number(bad[i]), q);
    choices(number(bad[i]), q);
  }
  positions(number(0x7E37E43C8800759CU), q); /* 1e300 */
  return wrong != 0;
}
