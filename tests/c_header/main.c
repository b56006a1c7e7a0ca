/* SPDX-License-Identifier: Apache-2.0 */
/* Reads postures and prints the results of the header for them, like write_header.cpp. */
#include <stdio.h>

#include "robot.h"

static robot_state state;
static const double* none; /* no torques: statics */

static void print(const double* values, int count) {
  int i;
  for (i = 0; i < count; ++i) printf("%a\n", values[i]);
}

int main(void) {
  double q[ROBOT_Q_COUNT], out[ROBOT_Q_COUNT], most[ROBOT_Q_COUNT], six[6], residual[2];
  ec_pose links[ROBOT_LINK_COUNT], root;
  unsigned feet;
  int c;
  robot_init(&state);
  for (c = 0; c < ROBOT_Q_COUNT; ++c) most[c] = c % 2 ? 0.005 : -1.0;
  robot_limit_changes(&state, most);
  robot_ease_changes(&state, 4.0);
  for (c = 0; c < ROBOT_Q_COUNT; ++c) out[c] = 0.01 * c;
  if (!robot_start_from(&state, out)) return 1;
  while (scanf("%u", &feet) == 1) {
    int i;
    for (i = 0; i < ROBOT_Q_COUNT; ++i) {
      if (scanf("%lf", &q[i]) != 1) return 1;
    }
    robot_forward(&state, q, none, feet, links, &root);
    print(links[5].p, 3);
    print(root.p, 3);
    robot_correct(&state, q, none, feet, out, six);
    print(out, ROBOT_Q_COUNT);
    print(six, 6);
    robot_command(&state, q, none, feet, out, residual);
    print(out, ROBOT_Q_COUNT);
    print(residual, 1);
  }
  return 0;
}
