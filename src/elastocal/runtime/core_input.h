/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: what a controller gives. See core_poses.h. */
#ifndef ELASTOCAL_CORE_INPUT_H
#define ELASTOCAL_CORE_INPUT_H

#include "elastocal/runtime/core_follow.h"

/* The functions that take input. Each has its own last good input: what one of them measured is no
   plan of another, and a low-pass sees each torque once. */
enum { EC_OF_FORWARD, EC_OF_CORRECT, EC_OF_COMMAND };

/* In place of a torque: none was ever given, and none is given any more. */
#define EC_UNKNOWN EC_HUGE
#define EC_FORGOTTEN (-EC_HUGE)

/* Positions that the robot is taken to be at before any good ones. */
static inline void ec_zero_posture(const ec_robot* robot, double* q) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    q[c] = 0.0;
    if (q[c] < robot->lower[c]) q[c] = robot->lower[c];
    if (q[c] > robot->upper[c]) q[c] = robot->upper[c];
  }
}

/* A later call does not know torques of now: its low-pass begins anew. */
static inline void ec_forget_torques(const ec_robot* robot, ec_input* input) {
  int k;
  for (k = 0; k < robot->joints; ++k) {
    if (ec_is_sane(input->torque[k])) input->torque[k] = EC_FORGOTTEN;
  }
}

/* Takes over the torques that are good. One that never was is not missed. */
static inline unsigned ec_take_torques(const ec_robot* robot, const double* torque,
                                       ec_input* input) {
  unsigned status = EC_FINE;
  int k;
  for (k = 0; k < robot->joints; ++k) {
    double* good = &input->torque[k];
    if (ec_is_sane(torque[k])) {
      *good = ec_is_sane(*good) ? *good + robot->torque_gain * (torque[k] - *good) : torque[k];
    } else if (*good != EC_UNKNOWN) {
      status |= EC_BAD_TORQUE;
    }
  }
  return status;
}

/* Takes over what is good of the input of a function (EC_OF_...), and says what is not. */
static inline unsigned ec_take(const ec_robot* robot, const double* q, const double* torque,
                               unsigned support, int function, ec_memory* memory) {
  const int planned = function == EC_OF_COMMAND;
  ec_input* input = &memory->input[function];
  unsigned status = EC_FINE;
  int c;
  memory->sides = &memory->side[planned * robot->shifts];
  for (c = 0; c < robot->coordinates; ++c) {
    if (!ec_is_sane(q[c])) status |= EC_BAD_POSITION;
  }
  if (!(status & EC_BAD_POSITION)) {
    for (c = 0; c < robot->coordinates; ++c) input->q[c] = q[c];
    input->has_q = 1;
    ec_cross_play(robot, input->q, planned, memory);
  } else if (!input->has_q) {
    status |= EC_NOTHING_YET;
  }
  if (torque) {
    status |= ec_take_torques(robot, torque, input);
  } else {
    ec_forget_torques(robot, input);
  }
  if (robot->feet < 32 && support >> robot->feet) {
    status |= EC_BAD_SUPPORT;
  } else {
    input->support = support;
  }
  return status;
}

/* ---- what a controller chooses ---- */

/* Forgets the last command and all input: the next command is found from its plan alone, as the
   first one is (and by the side of their play on which joints lie), wherever the robot then is. For
   calls that are no motion; a robot that moves begins again with ec_start_from. */
static inline void ec_forget(const ec_robot* robot, ec_memory* memory) {
  int i;
  for (i = EC_OF_FORWARD; i <= EC_OF_COMMAND; ++i) {
    ec_input* input = &memory->input[i];
    ec_zero_posture(robot, input->q);
    ec_forget_torques(robot, input);
    input->support = 0;
    input->has_q = 0;
  }
  memory->has_last = memory->has_start = 0;
}

/* Begins a motion from the command at which the drives are now, by coordinate: limits of changes
   (ec_limit_changes) hold from the next command on, as if `command` had been given the call before
   for the same plan. Forgets what ec_forget does. 0: an entry is not finite, and nothing is
   changed. */
static inline int ec_start_from(const ec_robot* robot, const double* command, ec_memory* memory) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    if (!ec_is_sane(command[c])) return 0;
  }
  ec_forget(robot, memory);
  for (c = 0; c < robot->coordinates; ++c) memory->given[c] = command[c];
  memory->has_start = 1;
  return 1;
}

/* From now on a command changes by at most so much from the last one, by coordinate, rad or m (the
   speed of a joint times the time between calls), unless the plan itself does, and beside the plan
   by at most a tenth of it. NULL, or an entry that is negative or not finite: no such limit. */
static inline void ec_limit_changes(const ec_robot* robot, const double* most, ec_memory* memory) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    memory->most_change[c] = most && ec_is_sane(most[c]) && most[c] >= 0.0 ? most[c] : EC_HUGE;
  }
}

/* From now on corrections of calls along a motion start and end gently: from rest to the largest
   speed beside the plan, a tenth of the joint's (ec_limit_changes; where that has no limit, the
   joint has none here), takes so many calls, and so does braking. 0, less or not finite: one call.
   */
static inline void ec_ease_changes(double calls, ec_memory* memory) {
  memory->calls_to_pace = ec_is_sane(calls) && calls > 0.0 ? calls : 0.0;
}

/* Forgets everything. To be called once before anything else. Until a good position comes, the
   robot is taken to be at position 0 of all coordinates, within their limits. */
static inline void ec_reset(const ec_robot* robot, ec_memory* memory) {
  int c, k, i;
  for (i = EC_OF_FORWARD; i <= EC_OF_COMMAND; ++i) {
    ec_input* input = &memory->input[i];
    input->q = &memory->good_q[i * robot->coordinates];
    input->torque = &memory->good_torque[i * robot->joints];
    for (k = 0; k < robot->joints; ++k) input->torque[k] = EC_UNKNOWN;
  }
  for (c = 0; c < robot->coordinates; ++c) {
    memory->stopped[c] = EC_FINE;
    memory->most_change[c] = EC_HUGE;
    memory->pace[c] = memory->given[c] = memory->last_q[c] = 0.0;
  }
  memory->calls_to_pace = 0.0;
  for (k = 0; k < robot->branches; ++k) memory->search[k].left = 0.0;
  for (k = 0; k < 2 * robot->shifts; ++k) {
    memory->side[k] = 0.0;
    memory->from[k] = EC_UNKNOWN;
  }
  memory->is_bound = memory->is_settled = memory->had_torque = 0;
  ec_forget(robot, memory);
}

#endif /* ELASTOCAL_CORE_INPUT_H */
