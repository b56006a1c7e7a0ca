/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: one step of a branch towards its targets, within the limits of
   its joints. See core_poses.h. */
#ifndef ELASTOCAL_CORE_STEP_H
#define ELASTOCAL_CORE_STEP_H

#include "elastocal/runtime/core_equations.h"

/* Most solutions of one step's equations, each with another set of joints at their limits. */
#define EC_PASSES 16

/* Lowest and highest command of a coordinate, and the bit that says which of its limits that is. A
   plan beyond the joint's limits is not moved, but gets no further. */
static inline double ec_bound(const ec_robot* robot, const ec_memory* memory, const double* nominal,
                              int c, int side, unsigned* bit) {
  const double limit = side < 0 ? robot->lower[c] : robot->upper[c];
  const double most = nominal[c] + side * robot->largest_correction;
  double bound = side * (nominal[c] - limit) > 0.0 ? nominal[c] : limit;
  *bit = side * (bound - most) > 0.0 ? EC_CORRECTION_CUT : EC_JOINT_LIMIT;
  if (*bit == EC_CORRECTION_CUT) bound = most;
  if (memory->is_bound) {
    /* How far a command may go from the last one comes before all else. */
    const double low = memory->lowest[c], high = memory->highest[c];
    if (bound < low || bound > high) *bit = EC_CORRECTION_CUT;
    if (bound < low) bound = low;
    if (bound > high) bound = high;
  }
  return bound;
}

static inline double ec_within(const ec_robot* robot, const ec_memory* memory,
                               const double* nominal, int c, double q) {
  unsigned bit;
  const double low = ec_bound(robot, memory, nominal, c, -1, &bit);
  const double high = ec_bound(robot, memory, nominal, c, 1, &bit);
  return q < low ? low : q > high ? high : q;
}

/* The step of the equations in memory with the positions of `held` columns given in memory->step:
   all others, into memory->step. */
static inline void ec_solve_others(int size, double damping, ec_memory* memory) {
  const double* normal = memory->normal;
  double *factor = memory->factor, *step = memory->step;
  int i, j;
  for (i = 0; i < size; ++i) {
    if (memory->held[i]) continue;
    step[i] = memory->gradient[i];
    for (j = 0; j < size; ++j) {
      if (memory->held[j]) step[i] -= normal[i > j ? size * i + j : size * j + i] * step[j];
    }
  }
  for (i = 0; i < size; ++i) {
    for (j = 0; j < i; ++j) {
      factor[size * i + j] = memory->held[i] || memory->held[j] ? 0.0 : normal[size * i + j];
    }
    factor[(size + 1) * i] = memory->held[i] ? 1.0 : normal[(size + 1) * i] + damping;
  }
  ec_solve(size, factor, step);
}

/* What the equations still pull at column i after the step. */
static inline double ec_pull(int size, int i, double damping, const ec_memory* memory) {
  const double* normal = memory->normal;
  double pull = memory->gradient[i] - damping * memory->step[i];
  int j;
  for (j = 0; j < size; ++j) {
    pull -= normal[i > j ? size * i + j : size * j + i] * memory->step[j];
  }
  return pull;
}

/* Of the coordinates of a branch: holds at its limit the one that the step from q takes beyond it
   first; or, where there is none, lets go of one that is held against its will. 0: neither. */
static inline int ec_change_held(const ec_robot* robot, int branch, const double* nominal,
                                 const double* q, double damping, ec_memory* memory) {
  const int size = robot->branch_size[branch];
  double first = 2.0, change = 0.0, most = 0.0;
  int column = -1, loose = -1, side = 0, c;
  for (c = 0; c < robot->coordinates; ++c) {
    const int i = robot->column_of_coordinate[c];
    const int up = memory->step[i] > 0.0 ? 1 : -1;
    double room, share;
    unsigned bit;
    if (robot->branch_of_coordinate[c] != branch) continue;
    if (memory->held[i]) {
      /* 2 and -2: it was let go of once, and comes to stay. */
      const double pull = memory->held[i] * ec_pull(size, i, damping, memory);
      if (memory->held[i] * memory->held[i] == 1 && pull < most) {
        most = pull;
        loose = i;
      }
      continue;
    }
    room = ec_bound(robot, memory, nominal, c, up, &bit) - q[c];
    if (up * (memory->step[i] - room) <= 0.0) continue;
    share = room / memory->step[i];
    if (share >= first) continue;
    first = share;
    column = i;
    change = room;
    side = up;
  }
  if (column >= 0) {
    memory->held[column] = memory->loosed[column] ? 2 * side : side;
    memory->step[column] = change;
    return 1;
  }
  if (loose < 0) return 0;
  memory->held[loose] = 0;
  memory->loosed[loose] = 1;
  return 1;
}

/* Moves the coordinates of a branch from q by a damped Gauss-Newton step within their limits, into
   `command`. What is held at a limit leaves the equations, so that the others take over. Returns by
   how much the squared error should fall. */
static inline double ec_bounded_step(const ec_robot* robot, int branch, const double* nominal,
                                     const double* q, double damping, ec_memory* memory,
                                     double* command) {
  const int size = robot->branch_size[branch];
  double gain = 0.0;
  int pass, c, i;
  ec_equations(robot, branch, nominal, q, memory);
  for (i = 0; i < size; ++i) memory->held[i] = memory->loosed[i] = 0;
  for (pass = 0; pass < EC_PASSES; ++pass) {
    ec_solve_others(size, damping, memory);
    if (!ec_change_held(robot, branch, nominal, q, damping, memory)) break;
  }
  for (c = 0; c < robot->coordinates; ++c) {
    if (robot->branch_of_coordinate[c] != branch) continue;
    i = robot->column_of_coordinate[c];
    command[c] = ec_within(robot, memory, nominal, c, q[c] + memory->step[i]);
    memory->step[i] = command[c] - q[c];
  }
  for (i = 0; i < size; ++i) {
    gain += memory->step[i] * (memory->gradient[i] + ec_pull(size, i, 0.0, memory));
  }
  return gain;
}

#endif /* ELASTOCAL_CORE_STEP_H */
