/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: the search for the positions within limits that bring the ends
   of the limbs nearest to their targets. See core_follow.h. */
#ifndef ELASTOCAL_CORE_REACH_H
#define ELASTOCAL_CORE_REACH_H

#include "elastocal/runtime/core_step.h"

/* Most evaluations of the robot from one start; a usual command takes four. */
#define EC_ITERATIONS 16
/* The search ends where a step promises less than this share of the squared error and so many
   square metres. */
#define EC_SHARE_LEFT 1e-3
#define EC_SQUARE_LEFT 2.5e-11
/* The damping of a step becomes so much smaller after a good one and larger after a bad one. Beside
   the last command it stays larger, so that what the ends of the limbs do not determine goes along
   slowly; a search from the plan would take ten steps to have it where it belongs. */
#define EC_EASE 0.1
#define EC_LEAST_DAMPING 0.01
#define EC_LEAST_BESIDE 0.1
#define EC_MOST_DAMPING 1e6
/* A tip is reached within this, m or its arm's radians (0.04 degrees; 0.4 of EC_ARM_OF_FEW). */
#define EC_REACHED 2e-4
/* A second start bends joints that are nearer than this to a limit by as much away from it, rad. */
#define EC_BEND 0.2
/* A branch is opened again where others have made its squared error so many times as large. */
#define EC_GROWN 1.1
/* A second start counts if it leaves less than this share of the squared error of the first. */
#define EC_CLEARLY 0.8
/* Squared error of a branch at q after a walk there: the ends of its limbs, and how far it is from
   `nominal`. `left`: the largest of an end that does not yield. */
static inline double ec_cost(const ec_robot* robot, int branch, const double* nominal,
                             const double* q, const ec_memory* memory, double* left) {
  double cost = 0.0;
  int t, c;
  *left = 0.0;
  for (t = 0; t < robot->tips; ++t) {
    const ec_tip* tip = &robot->tip[t];
    double error[6], square;
    ec_pose now;
    if (tip->branch != branch) continue;
    ec_tip_pose(robot, t, memory, &now);
    ec_tip_error(&now, &memory->target[t], tip->arm, error);
    square = ec_dot(error, error) + ec_dot(&error[3], &error[3]);
    cost += tip->yields ? EC_SHORT * EC_SHORT * square : square;
    if (!tip->yields && square > *left) *left = square;
  }
  for (c = 0; c < robot->coordinates; ++c) {
    if (robot->branch_of_coordinate[c] != branch) continue;
    cost += EC_STAY * EC_STAY * (q[c] - nominal[c]) * (q[c] - nominal[c]);
  }
  return cost;
}

static inline void ec_copy_branch(const ec_robot* robot, int branch, const double* from,
                                  double* to) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    if (robot->branch_of_coordinate[c] == branch) to[c] = from[c];
  }
}

/* After a walk at `command`: takes it as the branch's best if it is better, and makes the next
   command from the best. */
static inline void ec_advance(const ec_robot* robot, int branch, const double* nominal,
                              ec_memory* memory, double* command) {
  ec_search* search = &memory->search[branch];
  double* best = memory->best_q;
  double left, largest = 0.0;
  const double least = memory->is_bound ? EC_LEAST_BESIDE : EC_LEAST_DAMPING;
  const double cost = ec_cost(robot, branch, nominal, command, memory, &left);
  int c;
  /* Loads follow the other branches, so that errors of some micrometres tell nothing of a step. */
  if (search->state == EC_AGAIN || cost < search->cost || left < EC_REACHED * EC_REACHED) {
    const double damping = EC_DAMP * EC_DAMP * search->damping;
    ec_copy_branch(robot, branch, command, best);
    search->cost = cost;
    search->left = left;
    search->bad = 0;
    search->gain = ec_bounded_step(robot, branch, nominal, best, damping, memory, command);
    search->state = EC_TRYING;
    if (search->damping > least) search->damping *= EC_EASE;
    if (search->gain > EC_SHARE_LEFT * cost + EC_SQUARE_LEFT) return;
    search->state = EC_DONE;
    for (c = 0; c < robot->coordinates; ++c) {
      if (robot->branch_of_coordinate[c] != branch) continue;
      if (fabs(command[c] - best[c]) > largest) largest = fabs(command[c] - best[c]);
    }
    /* A short last step is as good as it promises. */
    if (largest < EC_SMALL_STEP) ec_copy_branch(robot, branch, command, best);
  } else if (++search->bad < 3) {
    for (c = 0; c < robot->coordinates; ++c) {
      if (robot->branch_of_coordinate[c] != branch) continue;
      command[c] = best[c] + 0.25 * (command[c] - best[c]);
    }
    search->damping /= EC_EASE;
    return;
  } else if (search->damping < EC_MOST_DAMPING) {
    search->damping *= 16.0;
    search->state = EC_AGAIN; /* the equations there are no longer in memory */
  } else {
    search->state = EC_DONE;
  }
  ec_copy_branch(robot, branch, best, command);
}

/* The deflected robot at `command`: poses under the loads of the posture before, then its loads. */
static inline void ec_walk_command(const ec_robot* robot, const double* command,
                                   const double* torque, unsigned support, ec_memory* memory,
                                   unsigned* status) {
  double gravity[3];
  ec_move(robot, robot->calibrated, command, memory);
  ec_shift_joints(robot, command, memory, status);
  ec_walk(robot, robot->calibrated, 1, memory, status);
  ec_loads(robot, robot->calibrated, support, torque, memory, gravity);
  ec_sole_poses(robot, 1, gravity, memory, status);
}

static inline void ec_begin(ec_search* search) {
  search->state = EC_AGAIN;
  search->damping = 1.0;
  search->bad = 0;
}

/* Whether a branch is not done, after a walk at `command`. It is opened again where the others have
   moved so much since that the weight on its joints is another. */
static inline int ec_is_open(const ec_robot* robot, int branch, const double* nominal,
                             ec_memory* memory, const double* command) {
  ec_search* search = &memory->search[branch];
  double left;
  if (search->state == EC_DONE) {
    const double cost = ec_cost(robot, branch, nominal, command, memory, &left);
    if (left <= EC_REACHED * EC_REACHED || cost <= EC_GROWN * search->cost) return 0;
    ec_begin(search);
  }
  return 1;
}

/* From `command`, the branches that are not done: their best commands nearby. */
static inline void ec_search_all(const ec_robot* robot, const double* nominal, const double* torque,
                                 unsigned support, ec_memory* memory, double* command) {
  int branch, i, more = 1;
  for (i = 0; i < EC_ITERATIONS && more; ++i) {
    unsigned cut = EC_FINE; /* only what holds at the end counts */
    ec_walk_command(robot, command, torque, support, memory, &cut);
    more = 0;
    for (branch = 0; branch < robot->branches; ++branch) {
      if (!ec_is_open(robot, branch, nominal, memory, command)) continue;
      ec_advance(robot, branch, nominal, memory, command);
      if (memory->search[branch].state != EC_DONE) more = 1;
      if (memory->search[branch].first < 0.0) {
        memory->search[branch].first = memory->search[branch].cost;
      }
    }
  }
  for (branch = 0; branch < robot->branches; ++branch) {
    ec_copy_branch(robot, branch, memory->best_q, command);
    memory->search[branch].state = EC_DONE;
  }
}

/* A stretched limb can bend to two sides, and the first search may have gone to the one that a
   limit ends, or have stayed between them: bends the turning joints that are near a limit, in the
   plan or in `command`, towards the middle of their range. 0: none is. */
static inline int ec_bend(const ec_robot* robot, int branch, const double* nominal,
                          ec_memory* memory, double* command) {
  int k, bent = 0;
  ec_copy_branch(robot, branch, nominal, memory->work_q);
  for (k = 0; k < robot->joints; ++k) {
    const int c = robot->calibrated[k].coordinate;
    const double low = command[c] < nominal[c] ? command[c] : nominal[c];
    const double high = command[c] > nominal[c] ? command[c] : nominal[c];
    const int up = robot->upper[c] - nominal[c] > nominal[c] - robot->lower[c];
    if (robot->branch_of_coordinate[c] != branch || robot->calibrated[k].prismatic) continue;
    if (low - robot->lower[c] >= EC_BEND && robot->upper[c] - high >= EC_BEND) continue;
    memory->work_q[c] =
        ec_within(robot, memory, nominal, c, nominal[c] + (up ? EC_BEND : -EC_BEND));
    bent = 1;
  }
  if (bent) ec_copy_branch(robot, branch, memory->work_q, command);
  return bent;
}

/* Starts again from bent limbs where a limb is not where it should be. */
static inline void ec_search_bent(const ec_robot* robot, const double* nominal,
                                  const double* torque, unsigned support, ec_memory* memory,
                                  double* command) {
  int branch, any = 0;
  for (branch = 0; branch < robot->branches; ++branch) {
    ec_search* search = &memory->search[branch];
    ec_copy_branch(robot, branch, command, memory->kept_q);
    search->kept = -1.0;
    if (search->left <= EC_REACHED * EC_REACHED) continue;
    if (!ec_bend(robot, branch, nominal, memory, command)) continue;
    search->kept = search->cost;
    search->kept_left = search->left;
    ec_begin(search);
    any = 1;
  }
  if (!any) return;
  ec_search_all(robot, nominal, torque, support, memory, command);
  for (branch = 0; branch < robot->branches; ++branch) {
    ec_search* search = &memory->search[branch];
    if (search->kept < 0.0) continue;
    if (search->cost < EC_CLEARLY * search->kept) continue;
    ec_copy_branch(robot, branch, memory->kept_q, command);
    ec_copy_branch(robot, branch, memory->kept_q, memory->best_q);
    search->cost = search->kept;
    search->left = search->kept_left;
  }
  ec_search_all(robot, nominal, torque, support, memory, command);
}

/* Which limits keep the ends of limbs from their targets: those that coordinates are at and that
   the equations pull them beyond, into memory->stopped. All of them together. */
static inline unsigned ec_in_the_way(const ec_robot* robot, const double* nominal,
                                     const double* command, ec_memory* memory) {
  unsigned status = EC_FINE, bit;
  int branch, c, side;
  for (c = 0; c < robot->coordinates; ++c) memory->stopped[c] = EC_FINE;
  for (branch = 0; branch < robot->branches; ++branch) {
    if (memory->search[branch].left <= EC_REACHED * EC_REACHED) continue;
    ec_equations(robot, branch, nominal, command, memory);
    for (c = 0; c < robot->coordinates; ++c) {
      if (robot->branch_of_coordinate[c] != branch) continue;
      side = memory->gradient[robot->column_of_coordinate[c]] > 0.0 ? 1 : -1;
      if (side * (command[c] - ec_bound(robot, memory, nominal, c, side, &bit)) < 0.0) continue;
      memory->stopped[c] = bit;
      status |= bit;
    }
  }
  return status;
}

static inline double ec_all_cost(const ec_robot* robot, const double* nominal,
                                 const double* command, ec_memory* memory) {
  double cost = 0.0;
  int branch;
  for (branch = 0; branch < robot->branches; ++branch) {
    ec_search* search = &memory->search[branch];
    cost += ec_cost(robot, branch, nominal, command, memory, &search->left);
  }
  return cost;
}

/* Begins at `command`: with the loads there, all branches. */
static inline void ec_start(const ec_robot* robot, const double* torque, unsigned support,
                            ec_memory* memory, const double* command, unsigned* status) {
  double gravity[3];
  int branch;
  ec_move(robot, robot->calibrated, command, memory);
  ec_walk(robot, robot->calibrated, 0, memory, status);
  ec_loads(robot, robot->calibrated, support, torque, memory, gravity);
  for (branch = 0; branch < robot->branches; ++branch) {
    ec_begin(&memory->search[branch]);
    memory->search[branch].first = -1.0;
  }
}

/* From the plan: the best commands nearby, never worse than the plan itself. Ends with a walk
   there; returns what of the robot was cut in it. */
static inline unsigned ec_search_anew(const ec_robot* robot, const double* nominal,
                                      const double* torque, unsigned support, ec_memory* memory,
                                      double* command, unsigned* status) {
  double uncorrected = 0.0;
  unsigned at_end = EC_FINE;
  int c, branch;
  for (c = 0; c < robot->coordinates; ++c) command[c] = nominal[c];
  ec_start(robot, torque, support, memory, command, status);
  ec_search_all(robot, nominal, torque, support, memory, command);
  ec_search_bent(robot, nominal, torque, support, memory, command);
  for (branch = 0; branch < robot->branches; ++branch) uncorrected += memory->search[branch].first;
  ec_walk_command(robot, command, torque, support, memory, &at_end);
  if (!(ec_all_cost(robot, nominal, command, memory) <= uncorrected)) {
    for (c = 0; c < robot->coordinates; ++c) command[c] = nominal[c];
    at_end = EC_FINE;
    ec_walk_command(robot, command, torque, support, memory, &at_end);
    ec_all_cost(robot, nominal, command, memory);
  }
  return at_end;
}

#endif /* ELASTOCAL_CORE_REACH_H */
