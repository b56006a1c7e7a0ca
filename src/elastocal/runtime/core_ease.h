/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: corrections that start and end gently. See core_poses.h.

   Near a stretched limb the best command (the goal) starts and stops within one call. The command
   that is given follows it: the correction beside the plan has a pace, which changes by at most a
   given amount a call. With half of that all joints of a branch go straight to the goal, as fast as
   they can still brake in time; with the other half each of them goes where the ends of the limbs
   are best on the way. While the goal itself is that gentle, the command is the goal. */
#ifndef ELASTOCAL_CORE_EASE_H
#define ELASTOCAL_CORE_EASE_H

#include "elastocal/runtime/core_reach.h"

/* Beside the plan a joint moves by at most this share of its largest change, where that is known: a
   trunk that leans at full speed for an arm that is too short for a moment throws a robot over. */
#define EC_GENTLE 0.1

/* By how much the pace of coordinate c may change at a call. */
static inline double ec_most_change_of_pace(const ec_memory* memory, int c) {
  return EC_GENTLE * memory->most_change[c] / memory->calls_to_pace;
}

/* How many calls' worth of change are between `wanted` and the pace (or, if not `from_pace`, rest)
   of a branch's coordinates: the most of them. */
static inline double ec_most_calls(const ec_robot* robot, int branch, const double* wanted,
                                   int from_pace, const ec_memory* memory) {
  double most = 0.0;
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    const double change = ec_most_change_of_pace(memory, c);
    const double calls = fabs(wanted[c] - (from_pace ? memory->pace[c] : 0.0)) / change;
    if (robot->branch_of_coordinate[c] == branch && change > 0.0 && calls > most) most = calls;
  }
  return most;
}

/* The fastest pace of coordinate c: that beside a plan, or that of the goal itself. */
static inline double ec_most_pace(const ec_memory* memory, int c) {
  const double most = EC_GENTLE * memory->most_change[c], goal = fabs(memory->kept_q[c]);
  return most > goal ? most : goal;
}

/* The largest share of the way, by coordinate in memory->work_q, that a branch may go in a call: it
   can brake at the goal, and no joint is too fast. */
static inline double ec_share_of_way(const ec_robot* robot, int branch, const ec_memory* memory) {
  const double* way = memory->work_q;
  /* With a pace of n changes, braking takes n (n + 1) / 2 of them. */
  const double far = 2.0 * ec_most_calls(robot, branch, way, 0, memory);
  double share = far > 1.0 ? (sqrt(0.25 + 2.0 * far) - 0.5) / far : 1.0;
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    const double most = ec_most_pace(memory, c);
    if (robot->branch_of_coordinate[c] != branch) continue;
    if (share * fabs(way[c]) > most) share = most / fabs(way[c]);
  }
  return share;
}

/* By how much a joint may move from the last command that was given: as far as its limit, or as its
   own plan does. */
static inline double ec_most_move(const double* nominal, int c, const ec_memory* memory) {
  const double planned = fabs(nominal[c] - memory->last_q[c]);
  return memory->most_change[c] > planned ? memory->most_change[c] : planned;
}

/* Coordinate c goes on with a correction of `pace` further than the last one, as far as limits
   allow: those of the joint, and of its speed but for a plan that is faster. */
static inline double ec_go_on(const ec_robot* robot, const double* nominal, int c, double pace,
                              const ec_memory* memory) {
  const double planned = nominal[c] - memory->last_q[c], last = memory->given[c];
  const double most = ec_most_move(nominal, c, memory);
  double q = last + planned + pace;
  if (q > last + most) q = last + most;
  if (q < last - most) q = last - most;
  return ec_within(robot, memory, nominal, c, q);
}

/* The way of each coordinate from the last command that was given to the goal, beside the plan,
   into memory->work_q; how far the goal went, into memory->kept_q. The goal is remembered. */
static inline void ec_see_goal(const ec_robot* robot, const double* nominal, const double* goal,
                               ec_memory* memory) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    const double planned = nominal[c] - memory->last_q[c];
    memory->work_q[c] = goal[c] - memory->given[c] - planned;
    memory->kept_q[c] = goal[c] - memory->last_command[c] - planned;
    memory->last_command[c] = memory->best_q[c] = goal[c];
  }
}

/* A branch goes on towards the goal in `command`, in place, and may go where memory->lowest and
   highest say. 0: it is at the goal. */
static inline int ec_ease_branch(const ec_robot* robot, int branch, const double* nominal,
                                 ec_memory* memory, double* command) {
  double *way = memory->work_q, *pace = memory->pace, share, calls;
  int c;
  if (ec_most_calls(robot, branch, way, 1, memory) <= 1.0) return 0;
  share = ec_share_of_way(robot, branch, memory);
  for (c = 0; c < robot->coordinates; ++c) {
    if (robot->branch_of_coordinate[c] == branch) way[c] *= share;
  }
  calls = 2.0 * ec_most_calls(robot, branch, way, 1, memory);
  if (calls < 1.0) calls = 1.0;
  for (c = 0; c < robot->coordinates; ++c) {
    const double half = 0.5 * ec_most_change_of_pace(memory, c), most = ec_most_pace(memory, c);
    double slow, fast;
    if (robot->branch_of_coordinate[c] != branch) continue;
    pace[c] += (way[c] - pace[c]) / calls;
    slow = pace[c] - half < -most ? -most : pace[c] - half;
    fast = pace[c] + half > most ? most : pace[c] + half;
    command[c] = ec_go_on(robot, nominal, c, pace[c], memory);
    memory->lowest[c] = ec_go_on(robot, nominal, c, slow < pace[c] ? slow : pace[c], memory);
    memory->highest[c] = ec_go_on(robot, nominal, c, fast > pace[c] ? fast : pace[c], memory);
  }
  return 1;
}

/* Takes the command from the goal in `command` to one that follows it gently, in place. Where it is
   not the goal, this ends with a walk there, which says in `status` what of the robot was cut. */
static inline void ec_ease(const ec_robot* robot, const double* nominal, const double* torque,
                           unsigned support, ec_memory* memory, double* command, unsigned* status) {
  int branch, eased = 0;
  ec_see_goal(robot, nominal, command, memory);
  memory->is_bound = 0; /* the joints' own limits alone */
  for (branch = 0; branch < robot->branches; ++branch) {
    memory->search[branch].state = EC_DONE;
    memory->search[branch].cost = EC_HUGE;
    if (!ec_ease_branch(robot, branch, nominal, memory, command)) continue;
    ec_begin(&memory->search[branch]);
    eased = 1;
  }
  memory->is_bound = 1;
  if (eased) {
    *status = EC_FINE;
    ec_search_all(robot, nominal, torque, support, memory, command);
    ec_walk_command(robot, command, torque, support, memory, status);
    ec_all_cost(robot, nominal, command, memory);
  }
}

/* Where `command` moves joints further than they may: no further, in place, and the others do for
   their branches what they can; beside a plan that is `near` the last one, as gently as else. Then
   it ends with a walk there, as ec_ease. */
static inline void ec_hold_back(const ec_robot* robot, const double* nominal, const double* torque,
                                unsigned support, int near, ec_memory* memory, double* command,
                                unsigned* status) {
  int branch, c, held = 0;
  for (branch = 0; branch < robot->branches; ++branch) memory->search[branch].state = EC_DONE;
  for (c = 0; c < robot->coordinates; ++c) {
    const double most = ec_most_move(nominal, c, memory), last = memory->given[c];
    double q = command[c];
    if (q > last + most) q = last + most;
    if (q < last - most) q = last - most;
    memory->best_q[c] = q;
    if (q == command[c]) continue;
    held = 1;
    branch = robot->branch_of_coordinate[c];
    if (branch >= 0) ec_begin(&memory->search[branch]);
  }
  if (!held) return;
  for (c = 0; c < robot->coordinates; ++c) {
    const double most = ec_most_move(nominal, c, memory), last = memory->given[c];
    const double planned = nominal[c] - memory->last_q[c];
    const double gentle = EC_GENTLE * memory->most_change[c];
    const double low = last + (planned < 0.0 ? planned : 0.0) - gentle;
    const double high = last + (planned > 0.0 ? planned : 0.0) + gentle;
    command[c] = memory->best_q[c];
    memory->lowest[c] = last - most;
    memory->highest[c] = last + most;
    if (!near) continue;
    if (memory->lowest[c] < low) memory->lowest[c] = low;
    if (memory->highest[c] > high) memory->highest[c] = high;
    if (memory->lowest[c] > command[c]) memory->lowest[c] = command[c];
    if (memory->highest[c] < command[c]) memory->highest[c] = command[c];
  }
  memory->is_bound = 1;
  memory->is_settled = 0;
  *status = EC_FINE;
  ec_search_all(robot, nominal, torque, support, memory, command);
  ec_walk_command(robot, command, torque, support, memory, status);
  ec_all_cost(robot, nominal, command, memory);
}

/* Remembers the command that is given. `is_goal`: later ones go on from it, and not from a better
   one that it follows. */
static inline void ec_give(const ec_robot* robot, const double* nominal, int is_goal,
                           const double* command, ec_memory* memory) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    const double planned = nominal[c] - memory->last_q[c];
    memory->pace[c] = is_goal ? 0.0 : command[c] - memory->given[c] - planned;
    memory->given[c] = command[c];
    if (is_goal) memory->last_command[c] = command[c];
  }
}

#endif /* ELASTOCAL_CORE_EASE_H */
