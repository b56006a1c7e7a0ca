/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: the motion of its joints. See core_poses.h. */
#ifndef ELASTOCAL_CORE_MOTION_H
#define ELASTOCAL_CORE_MOTION_H

#include "elastocal/runtime/core_poses.h"

static inline double ec_position(const ec_joint* joint, const double* q) {
  return joint->multiplier * q[joint->coordinate] + joint->offset;
}

#define EC_TURN 6.283185307179586

/* Whether coordinate c turns without end, so that the robot is the same a turn further on: it has
   no limits, all joints that it moves turn by whole turns then, and no error of a gear grows. */
static inline int ec_is_endless(const ec_robot* robot, int c) {
  int k, i;
  if (ec_is_sane(robot->lower[c]) || ec_is_sane(robot->upper[c])) return 0;
  for (k = 0; k < robot->joints; ++k) {
    const ec_joint* joint = &robot->calibrated[k];
    if (joint->coordinate != c) continue;
    if (joint->prismatic || joint->multiplier != floor(joint->multiplier)) return 0;
  }
  for (i = 0; i < robot->shifts; ++i) {
    const ec_shift* shift = &robot->shift[i];
    if (shift->function != EC_GEAR || shift->amount == 0.0) continue;
    if (robot->calibrated[shift->source].coordinate == c) return 0;
  }
  return 1;
}

/* The whole turns in a change of coordinate c, rad: what is left of the change is the shorter way
   round. 0 for a coordinate that does not turn without end. */
static inline double ec_whole_turns(const ec_robot* robot, int c, double change) {
  if (fabs(change) <= 0.5 * EC_TURN || !ec_is_endless(robot, c)) return 0.0;
  return EC_TURN * floor(change / EC_TURN + 0.5);
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
    const ec_joint* joint = &robot->calibrated[shift->joint];
    const double position = ec_position(joint, q);
    if (shift->function != EC_HYSTERESIS || shift->amount == 0.0) continue;
    if (ec_is_sane(from[i]) && joint->multiplier != 0.0) {
      const double change = (position - from[i]) / joint->multiplier;
      const double turns = ec_whole_turns(robot, joint->coordinate, change);
      side[i] += joint->multiplier * (change - turns) / fabs(shift->amount);
    }
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

/* The limit of a joint's deflection about (of a slide, along) its axis. */
static inline double ec_most_deflection(const ec_robot* robot, const ec_joint* joint) {
  return joint->prismatic ? robot->largest_shift : robot->largest_turn;
}

/* How far the load turns (or shifts) joint k by its spring. */
static inline double ec_give_way(const ec_robot* robot, int k, const ec_memory* memory,
                                 unsigned* status) {
  const ec_joint* joint = &robot->calibrated[k];
  return ec_cut(joint->compliance[2] * memory->load[3 * k + 2], ec_most_deflection(robot, joint),
                EC_DEFLECTION_CUT, status);
}

/* What of a shift by the load's square joint k makes beside its spring, so that its whole
   deflection is within the limit. */
static inline double ec_stiffen(const ec_robot* robot, int k, double shift, const ec_memory* memory,
                                unsigned* status) {
  const ec_joint* joint = &robot->calibrated[k];
  const double spring = joint->compliance[2] * memory->load[3 * k + 2];
  unsigned cut = EC_FINE; /* the spring's own is said where it deflects */
  return ec_cut(spring + shift, ec_most_deflection(robot, joint), EC_DEFLECTION_CUT, status) -
         ec_give_way(robot, k, memory, &cut);
}

/* After ec_move of the calibrated joints to q: shifts them by what the calibration found beside
   geometry and springs, under the loads in memory. */
static inline void ec_shift_joints(const ec_robot* robot, const double* q, ec_memory* memory,
                                   unsigned* status) {
  int i, k;
  for (k = 0; k < robot->joints; ++k) memory->shift[k] = 0.0;
  for (i = 0; i < robot->shifts; ++i) {
    double shift = ec_shift_of(robot, i, q, memory);
    k = robot->shift[i].joint;
    if (robot->shift[i].function == EC_STIFFENING) {
      shift = ec_stiffen(robot, k, shift, memory, status);
    }
    memory->shift[k] += shift;
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
