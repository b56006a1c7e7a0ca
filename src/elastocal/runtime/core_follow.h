/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: commands that bring the ends of the limbs to their targets, one
   after another along a motion. See core_poses.h. */
#ifndef ELASTOCAL_CORE_FOLLOW_H
#define ELASTOCAL_CORE_FOLLOW_H

#include "elastocal/runtime/core_ease.h"

/* The last command counts while no joint of the plan is further than this from then, rad or m. */
#define EC_NEARBY 0.1
/* From one such command to the next a joint moves as the plan does, or less, and by at most so many
   times the largest change of a joint of the plan and so many radians beside that; a slide by so
   many metres for each of these radians, because slides are slow. */
#define EC_FOLLOW 1.0
#define EC_CREEP 2e-4
#define EC_SLIDE 0.1

/* Makes the last command one beside this plan: as many whole turns of joints that turn without end
   as lie between are no motion, and the command of ec_start_from counts as one for this plan. */
static inline void ec_meet(const ec_robot* robot, const double* nominal, ec_memory* memory) {
  int c, t;
  if (!memory->has_last && !memory->has_start) return;
  for (c = 0; c < robot->coordinates; ++c) {
    const double from = memory->has_start ? memory->given[c] : memory->last_q[c];
    const double turns = ec_whole_turns(robot, c, nominal[c] - from);
    memory->given[c] += turns;
    if (memory->has_start) {
      memory->last_q[c] = nominal[c];
      memory->last_command[c] = memory->given[c];
    } else {
      memory->last_q[c] += turns;
      memory->last_command[c] += turns;
    }
  }
  if (!memory->has_start) return;
  for (t = 0; t < robot->tips; ++t) memory->last_target[t] = memory->target[t];
  memory->is_settled = 0;
  memory->has_last = 1;
}

/* How far the plan is from that of the last command: the largest change of a joint, or of a target
   where `moves` says that these are not the plan's. Negative: they have nothing to do with each
   other. */
static inline double ec_change(const ec_robot* robot, const double* nominal, int moves,
                               const ec_memory* memory) {
  double change = 0.0, error[6];
  int c, t;
  if (!memory->has_last) return -1.0;
  for (c = 0; c < robot->coordinates; ++c) {
    const double moved = fabs(nominal[c] - memory->last_q[c]);
    if (moved > change) change = moved;
  }
  for (t = 0; moves && t < robot->tips; ++t) {
    double moved;
    ec_tip_error(&memory->last_target[t], &memory->target[t], EC_ARM, error);
    moved = sqrt(ec_dot(error, error) + ec_dot(&error[3], &error[3])) / EC_ARM;
    if (moved > change) change = moved;
  }
  return change <= EC_NEARBY ? change : -1.0;
}

/* Whether the last command was of the same feet, and its loads from the same source. */
static inline int ec_is_same(const double* torque, unsigned support, const ec_memory* memory) {
  return !memory->has_start && support == memory->last_support &&
         (torque ? 1 : 0) == memory->had_torque;
}

/* Where to start: the nominal positions with the last correction; a joint that moves no end of a
   limb at its plan. And how far the command may go: it may stay where it was as well as go along
   with the plan, and a little further to both sides; as far as ever where other feet stand than
   then, or loads come from elsewhere, because the corrections then jump. Such a command goes on
   from the one that was given. In no case faster than a joint may move, but for a plan that does.
   */
static inline void ec_stay_near(const ec_robot* robot, const double* nominal, const double* torque,
                                unsigned support, double change, ec_memory* memory) {
  const int same = ec_is_same(torque, support, memory);
  const double room = same ? EC_FOLLOW * change + EC_CREEP : 2.0 * robot->largest_correction;
  int c, k;
  for (c = 0; c < robot->coordinates; ++c) memory->lowest[c] = room;
  for (k = 0; same && k < robot->joints; ++k) {
    if (robot->calibrated[k].prismatic) {
      memory->lowest[robot->calibrated[k].coordinate] = EC_SLIDE * room;
    }
  }
  for (c = 0; c < robot->coordinates; ++c) {
    const double last = same ? memory->last_command[c] : memory->given[c];
    const double gentle = EC_GENTLE * memory->most_change[c];
    const double more = memory->lowest[c] < gentle ? memory->lowest[c] : gentle;
    const double most = ec_most_move(nominal, c, memory);
    double start = nominal[c];
    if (robot->branch_of_coordinate[c] >= 0) {
      start = ec_within(robot, memory, nominal, c, last + (nominal[c] - memory->last_q[c]));
    }
    if (start < last - most) start = last - most;
    if (start > last + most) start = last + most;
    memory->last_command[c] = last;
    memory->start_q[c] = start;
    memory->lowest[c] = (start < last ? start : last) - more;
    memory->highest[c] = (start > last ? start : last) + more;
    if (memory->lowest[c] < last - most) memory->lowest[c] = last - most;
    if (memory->highest[c] > last + most) memory->highest[c] = last + most;
  }
}

/* After a walk at the last command for the plan of then: whether it still does what it did, so that
   a robot that shall stand stands. */
static inline int ec_still_does(const ec_robot* robot, const ec_memory* memory) {
  const double most = EC_REACHED * EC_REACHED;
  int branch;
  for (branch = 0; branch < robot->branches; ++branch) {
    const ec_search* search = &memory->search[branch];
    if (search->left <= 0.01 * most) continue;
    if (!memory->is_settled || search->last_left > most) return 0;
    if (search->left > 1.2 * search->last_left) return 0;
  }
  return 1;
}

/* Beside the last command: the same solution a little further on. */
static inline unsigned ec_follow(const ec_robot* robot, const double* nominal, const double* torque,
                                 unsigned support, double change, ec_memory* memory,
                                 double* command, unsigned* status) {
  unsigned at_end = EC_FINE;
  int c;
  for (c = 0; c < robot->coordinates; ++c) command[c] = memory->start_q[c];
  ec_start(robot, torque, support, memory, command, status);
  memory->is_bound = 1;
  if (!(change > 0.0) && !memory->has_start && support == memory->last_support) {
    unsigned cut = EC_FINE;
    ec_walk_command(robot, command, torque, support, memory, &cut); /* loads as deflected */
    ec_walk_command(robot, command, torque, support, memory, &at_end);
    ec_all_cost(robot, nominal, command, memory);
    if (ec_still_does(robot, memory)) return at_end;
    at_end = EC_FINE;
  }
  ec_search_all(robot, nominal, torque, support, memory, command);
  ec_walk_command(robot, command, torque, support, memory, &at_end);
  ec_all_cost(robot, nominal, command, memory);
  return at_end;
}

/* Commands with which the real robot has the ends of its limbs at the targets in memory, or as near
   as limits allow. `moves`: the targets are not those of the plan. */
static inline void ec_reach(const ec_robot* robot, const double* nominal, const double* torque,
                            unsigned support, int moves, ec_memory* memory, double* command,
                            double* residual, unsigned* status) {
  double change;
  unsigned at_end;
  int c, t, is_goal;
  ec_meet(robot, nominal, memory);
  change = ec_change(robot, nominal, moves, memory);
  is_goal = change < 0.0 || !ec_is_same(torque, support, memory) || !(memory->calls_to_pace > 0.0);
  memory->is_bound = 0;
  if (change < 0.0) {
    at_end = ec_search_anew(robot, nominal, torque, support, memory, command, status);
    memory->is_settled = 1;
  } else {
    ec_stay_near(robot, nominal, torque, support, change, memory);
    at_end = ec_follow(robot, nominal, torque, support, change, memory, command, status);
    memory->is_settled = 1;
    for (c = 0; c < robot->coordinates; ++c) {
      if (command[c] <= memory->lowest[c] || command[c] >= memory->highest[c]) {
        memory->is_settled = 0;
      }
    }
  }
  for (t = 0; t < robot->branches; ++t) memory->search[t].last_left = memory->search[t].left;
  if (!is_goal) ec_ease(robot, nominal, torque, support, memory, command, &at_end);
  if (memory->has_last) {
    ec_hold_back(robot, nominal, torque, support, change >= 0.0, memory, command, &at_end);
  }
  ec_give(robot, nominal, is_goal, command, memory);
  *status |= at_end | ec_in_the_way(robot, nominal, command, memory);
  ec_residual(robot, memory, residual);
  for (c = 0; c < robot->coordinates; ++c) memory->last_q[c] = nominal[c];
  for (t = 0; t < robot->tips; ++t) memory->last_target[t] = memory->target[t];
  memory->last_support = support;
  memory->had_torque = torque ? 1 : 0;
  memory->has_last = 1;
  memory->has_start = 0;
}

#endif /* ELASTOCAL_CORE_FOLLOW_H */
