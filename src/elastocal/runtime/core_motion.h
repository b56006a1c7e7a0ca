/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: the motion of its joints. See core_poses.h. */
#ifndef ELASTOCAL_CORE_MOTION_H
#define ELASTOCAL_CORE_MOTION_H

#include "elastocal/runtime/core_poses.h"

static inline double ec_position(const ec_joint* joint, const double* q) {
  return joint->multiplier * q[joint->coordinate] + joint->offset;
}

/* The joints' own motion at the positions q, for the walks that follow. */
static inline void ec_move(const ec_robot* robot, const ec_joint* joints, const double* q,
                           ec_memory* memory) {
  int k;
  for (k = 0; k < robot->joints; ++k) {
    const ec_joint* joint = &joints[k];
    const double position = ec_position(joint, q);
    const double theta = joint->theta + (joint->prismatic ? 0.0 : position);
    memory->motion[3 * k] = cos(theta);
    memory->motion[3 * k + 1] = sin(theta);
    memory->motion[3 * k + 2] = joint->r + (joint->prismatic ? position : 0.0);
  }
}

/* Follows the joints through their play. A joint whose motion turns round first crosses it, twice
   |amount| of its encoder, while what it moves lags behind (or runs ahead, by the amount's sign).
   `planned`: q are those of a plan, which does not know what was measured, nor the other way. */
static inline void ec_cross_play(const ec_robot* robot, const double* q, int planned,
                                 ec_memory* memory) {
  double* side = &memory->side[planned * robot->shifts];
  double* from = &memory->from[planned * robot->shifts];
  int i;
  for (i = 0; i < robot->shifts; ++i) {
    const ec_shift* shift = &robot->shift[i];
    const double position = ec_position(&robot->calibrated[shift->joint], q);
    if (shift->function != EC_HYSTERESIS || shift->amount == 0.0) continue;
    if (ec_is_sane(from[i])) side[i] += (position - from[i]) / fabs(shift->amount);
    if (side[i] > 1.0) side[i] = 1.0;
    if (side[i] < -1.0) side[i] = -1.0;
    from[i] = position;
  }
}

static inline double ec_shift_of(const ec_robot* robot, int i, const double* q,
                                 const ec_memory* memory) {
  const ec_shift* shift = &robot->shift[i];
  const double position = ec_position(&robot->calibrated[shift->source], q);
  const double load = memory->load[3 * shift->joint + 2];
  switch (shift->function) {
    case EC_SIN:
      return shift->amount * sin(position);
    case EC_COS:
      return shift->amount * cos(position);
    case EC_SIN_TWICE:
      return shift->amount * sin(2.0 * position);
    case EC_COS_TWICE:
      return shift->amount * cos(2.0 * position);
    case EC_GEAR:
      return shift->amount * (position - shift->centre);
    case EC_BACKLASH:
      return shift->amount * tanh(load / shift->scale);
    case EC_HYSTERESIS:
      return shift->amount * memory->sides[i];
    default:
      return shift->amount * load * fabs(load) / (shift->scale * shift->scale);
  }
}

/* After ec_move of the calibrated joints to q: shifts them by what the calibration found beside
   geometry and springs, under the loads in memory. */
static inline void ec_shift_joints(const ec_robot* robot, const double* q, ec_memory* memory) {
  int i, k;
  for (k = 0; k < robot->joints; ++k) memory->shift[k] = 0.0;
  for (i = 0; i < robot->shifts; ++i) {
    memory->shift[robot->shift[i].joint] += ec_shift_of(robot, i, q, memory);
  }
  for (k = 0; k < robot->joints; ++k) {
    const ec_joint* joint = &robot->calibrated[k];
    double position;
    if (memory->shift[k] == 0.0) continue;
    position = ec_position(joint, q) + memory->shift[k];
    if (joint->prismatic) {
      memory->motion[3 * k + 2] = joint->r + position;
    } else {
      memory->motion[3 * k] = cos(joint->theta + position);
      memory->motion[3 * k + 1] = sin(joint->theta + position);
    }
  }
}

#endif /* ELASTOCAL_CORE_MOTION_H */
