/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: what a controller calls. See core_poses.h. */
#ifndef ELASTOCAL_CORE_CORRECTION_H
#define ELASTOCAL_CORE_CORRECTION_H

#include "elastocal/runtime/core_follow.h"

/* ---- input ---- */

/* Whether a position, torque or length can be one of a robot: finite, and no garbage of memory. */
static inline int ec_is_sane(double value) { return fabs(value) <= 1e9; }

/* Takes over what is good of the input, and says what is not. `planned`: q are not measured. */
static inline unsigned ec_take(const ec_robot* robot, const double* q, const double* torque,
                               unsigned support, int planned, ec_memory* memory) {
  unsigned status = EC_FINE;
  int c, k;
  memory->sides = &memory->side[planned * robot->shifts];
  for (c = 0; c < robot->coordinates; ++c) {
    if (!ec_is_sane(q[c])) status |= EC_BAD_POSITION;
  }
  if (!(status & EC_BAD_POSITION)) {
    for (c = 0; c < robot->coordinates; ++c) memory->good_q[c] = q[c];
    memory->has_good_q = 1;
    ec_cross_play(robot, memory->good_q, planned, memory);
  } else if (!memory->has_good_q) {
    status |= EC_NOTHING_YET;
  }
  for (k = 0; torque && k < robot->joints; ++k) {
    if (ec_is_sane(torque[k])) {
      double* good = &memory->good_torque[k];
      *good = isfinite(*good) ? *good + robot->torque_gain * (torque[k] - *good) : torque[k];
    } else if (isfinite(memory->good_torque[k])) {
      status |= EC_BAD_TORQUE;
    }
  }
  if (robot->feet < 32 && support >> robot->feet) {
    status |= EC_BAD_SUPPORT;
  } else {
    memory->good_support = support;
  }
  return status;
}

/* ---- what a controller calls ---- */

/* Forgets the last command: the next one is found from its plan alone, as the first one is (and by
   the side of their play on which joints lie). For a controller that starts again from another
   place. */
static inline void ec_forget(ec_memory* memory) { memory->has_last = 0; }

/* From now on a command changes by at most so much from the last one, by coordinate, rad or m (the
   speed of a joint times the time between calls), unless the plan itself does, and beside the plan
   by at most a tenth of it. NULL, or an entry that is negative or not finite: no such limit. */
static inline void ec_limit_changes(const ec_robot* robot, const double* most, ec_memory* memory) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    memory->most_change[c] = most && most[c] >= 0.0 ? most[c] : HUGE_VAL;
  }
}

/* From now on corrections of calls along a motion start and end gently: from rest to the largest
   speed beside the plan, a tenth of the joint's (ec_limit_changes; where that has no limit, the
   joint has none here), takes so many calls, and so does braking. 0, less or not finite: one call.
   */
static inline void ec_ease_changes(double calls, ec_memory* memory) {
  memory->calls_to_pace = calls > 0.0 && ec_is_sane(calls) ? calls : 0.0;
}

/* Forgets all input. To be called once before anything else. Until a good position comes, the
   robot is taken to be at position 0 of all coordinates, within their limits. */
static inline void ec_reset(const ec_robot* robot, ec_memory* memory) {
  int c, k;
  for (c = 0; c < robot->coordinates; ++c) {
    double q = 0.0;
    if (q < robot->lower[c]) q = robot->lower[c];
    if (q > robot->upper[c]) q = robot->upper[c];
    memory->good_q[c] = q;
  }
  for (c = 0; c < robot->coordinates; ++c) {
    memory->stopped[c] = EC_FINE;
    memory->most_change[c] = HUGE_VAL;
    memory->pace[c] = 0.0;
  }
  memory->calls_to_pace = 0.0;
  for (k = 0; k < robot->branches; ++k) memory->search[k].left = 0.0;
  for (k = 0; k < 2 * robot->shifts; ++k) {
    memory->side[k] = 0.0;
    memory->from[k] = nan("");
  }
  for (k = 0; k < robot->joints; ++k) memory->good_torque[k] = nan("");
  memory->good_support = 0;
  memory->has_good_q = 0;
  memory->is_bound = memory->is_settled = memory->had_torque = 0;
  ec_forget(memory);
}

/* Pose of the root link in the frame of the first foot that stands, by the leg between them; a held
   root link is its own reference. Other feet that stand say nothing of it: how they stand against
   the first one nothing tells but the same legs. A nominal robot at these positions has them
   elsewhere, by as much as the legs are off (20 mm of TALOS), whatever the controller plays. */
static inline void ec_root_on_first(const ec_robot* robot, unsigned support, const ec_pose* sole,
                                    ec_pose* root) {
  int f;
  ec_identity(root);
  for (f = 0; f < robot->feet; ++f) {
    if (!(support >> f & 1U)) continue;
    ec_invert(&sole[f], root);
    return;
  }
}

/* The same of a robot whose legs do not close on the feet as they stand (`placed`, by foot, in the
   frame of any one link): each leg counts by its foot's share of the weight. */
static inline void ec_root_on_feet(const ec_robot* robot, unsigned support, const ec_pose* placed,
                                   const ec_pose* sole, const double* share, ec_pose* root) {
  ec_pose first, back, by;
  double twist[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, R[9], v[3];
  int f, i, begun = 0;
  ec_identity(root);
  for (f = 0; f < robot->feet; ++f) {
    if (!(support >> f & 1U)) continue;
    ec_invert(&sole[f], &by);
    if (!begun) {
      ec_invert(&placed[f], &first);
      *root = by;
      begun = 1;
      continue;
    }
    ec_compose(&first, &placed[f], &back);
    {
      const ec_pose foot = by;
      ec_compose(&back, &foot, &by);
    }
    /* How the second foot would have the root link, against the first. */
    for (i = 0; i < 9; ++i) {
      R[i] = by.R[3 * (i / 3)] * root->R[3 * (i % 3)] +
             by.R[3 * (i / 3) + 1] * root->R[3 * (i % 3) + 1] +
             by.R[3 * (i / 3) + 2] * root->R[3 * (i % 3) + 2];
    }
    ec_log(R, v);
    for (i = 0; i < 3; ++i) {
      twist[i] += share[f] * (by.p[i] - root->p[i]);
      twist[3 + i] += share[f] * v[i];
    }
  }
  ec_exp(&twist[3], R);
  by = *root;
  ec_multiply(R, by.R, root->R);
  for (i = 0; i < 3; ++i) root->p[i] += twist[i];
}

/* Where a robot has its feet, without deflection: from `body` after a walk. */
static inline void ec_place_feet(const ec_robot* robot, const ec_memory* memory, ec_pose* placed) {
  int f;
  for (f = 0; f < robot->feet; ++f) {
    ec_compose(&memory->body[robot->foot[f].sole.body], &robot->foot[f].sole.pose, &placed[f]);
  }
}

/* Poses of all links in the root link's frame, with deflection, and of the root link on its feet
   (ec_root_on_first). `support`: bit f is set where foot f stands; 0: the root link is held.
   `torque` by joint as sensors report it (it balances the load), or null: statics. */
static inline unsigned ec_forward(const ec_robot* robot, const double* q, const double* torque,
                                  unsigned support, ec_memory* memory, ec_pose* links,
                                  ec_pose* root) {
  unsigned status = ec_take(robot, q, torque, support, 0, memory);
  double gravity[3];
  int i;
  ec_move(robot, robot->calibrated, memory->good_q, memory);
  ec_walk(robot, robot->calibrated, 0, memory, &status);
  ec_settle(robot, memory->good_q, memory->good_support, torque ? memory->good_torque : torque,
            memory, gravity, &status);
  for (i = 0; i < robot->links; ++i) {
    ec_compose(&memory->body[robot->link[i].body], &robot->link[i].pose, &links[i]);
  }
  ec_root_on_first(robot, memory->good_support, memory->sole, root);
  return status;
}

/* Positions with which the rigid calibrated robot has the ends of its limbs (and so stands) where
   the real one has them at q: `rigid`, by coordinate. `displacement`: how far the real root link is
   from that of the rigid calibrated robot at q, on the same feet: translation of its origin [m],
   then rotation vector [rad], in the axes of the first foot that stands. */
static inline unsigned ec_correct(const ec_robot* robot, const double* q, const double* torque,
                                  unsigned support, ec_memory* memory, double* rigid,
                                  double* displacement) {
  unsigned status = ec_take(robot, q, torque, support, 0, memory);
  double gravity[3], turn[9], *start = memory->work_q;
  ec_pose straight[32], root, rigid_root;
  int c, i, k;
  q = memory->good_q;
  if (status & EC_NOTHING_YET) {
    for (c = 0; c < robot->coordinates; ++c) rigid[c] = q[c];
    for (i = 0; i < 6; ++i) displacement[i] = 0.0;
    return status;
  }
  ec_move(robot, robot->calibrated, q, memory);
  ec_walk(robot, robot->calibrated, 0, memory, &status);
  ec_place_feet(robot, memory, straight);
  ec_settle(robot, q, memory->good_support, torque ? memory->good_torque : torque, memory, gravity,
            &status);
  ec_tip_poses(robot, memory, memory->target);
  ec_root_on_first(robot, memory->good_support, memory->sole, &root);
  ec_root_on_feet(robot, memory->good_support, memory->sole, straight, memory->share, &rigid_root);
  for (i = 0; i < 9; ++i) {
    turn[i] = ec_dot(&root.R[3 * (i / 3)], &rigid_root.R[3 * (i % 3)]);
  }
  ec_log(turn, &displacement[3]);
  for (i = 0; i < 3; ++i) displacement[i] = root.p[i] - rigid_root.p[i];
  /* What turns about the joints' own axes is a change of position; the rest is fitted. */
  for (c = 0; c < robot->coordinates; ++c) start[c] = q[c];
  for (k = 0; k < robot->joints; ++k) {
    const ec_joint* joint = &robot->calibrated[k];
    if (joint->multiplier != 1.0) continue;
    start[joint->coordinate] +=
        memory->shift[k] + ec_cut(joint->compliance[2] * memory->load[3 * k + 2],
                                  joint->prismatic ? robot->largest_shift : robot->largest_turn,
                                  EC_DEFLECTION_CUT, &status);
  }
  for (c = 0; c < robot->coordinates; ++c) rigid[c] = start[c];
  for (i = 0; i < 2; ++i) {
    ec_move(robot, robot->calibrated, rigid, memory);
    ec_walk(robot, robot->calibrated, 0, memory, &status);
    ec_sole_poses(robot, 0, gravity, memory, &status);
    if (ec_step(robot, start, rigid, memory) < EC_SMALL_STEP) break;
  }
  for (c = 0; c < robot->coordinates; ++c) {
    rigid[c] =
        q[c] + ec_cut(rigid[c] - q[c], robot->largest_correction, EC_CORRECTION_CUT, &status);
  }
  return status;
}

/* Commands with which the real robot has hands, feet and waist where the nominal robot has them at
   `nominal`. `torque`: those of the planned motion, by joint, or null: statics. `residual`: largest
   distance [m] and angle [rad] that is left at the end of a limb that does not yield (ec_tip). */
static inline unsigned ec_command(const ec_robot* robot, const double* nominal,
                                  const double* torque, unsigned support, ec_memory* memory,
                                  double* command, double* residual) {
  unsigned status = ec_take(robot, nominal, torque, support, 1, memory);
  ec_pose placed[32];
  int f, c;
  if (status & EC_NOTHING_YET) {
    for (c = 0; c < robot->coordinates; ++c) {
      command[c] = memory->good_q[c];
      memory->stopped[c] = EC_FINE;
    }
    residual[0] = residual[1] = 0.0;
    return status;
  }
  ec_move(robot, robot->nominal, memory->good_q, memory);
  ec_walk(robot, robot->nominal, 0, memory, &status);
  ec_place_feet(robot, memory, placed);
  for (f = 0; f < robot->feet; ++f) memory->sole[f] = placed[f];
  ec_tip_poses(robot, memory, memory->target);
  ec_reach(robot, memory->good_q, torque ? memory->good_torque : torque, memory->good_support, 0,
           memory, command, residual, &status);
  return status;
}

/* The same for poses of the ends of the limbs in the root link's frame, by tip; `nominal` is the
   posture nearby from which redundant joints do not stray. A pose that is not finite is a bad
   position: the nominal robot's poses are taken. */
static inline unsigned ec_command_poses(const ec_robot* robot, const ec_pose* targets,
                                        const double* nominal, const double* torque,
                                        unsigned support, ec_memory* memory, double* command,
                                        double* residual) {
  unsigned status = ec_take(robot, nominal, torque, support, 1, memory);
  int t, i, good = 1;
  for (t = 0; t < robot->tips; ++t) {
    for (i = 0; i < 9; ++i) good = good && ec_is_sane(targets[t].R[i]);
    for (i = 0; i < 3; ++i) good = good && ec_is_sane(targets[t].p[i]);
  }
  if (!good)
    return ec_command(robot, memory->good_q, torque, support, memory, command, residual) |
           EC_BAD_POSITION;
  for (t = 0; t < robot->tips; ++t) memory->target[t] = targets[t];
  ec_reach(robot, memory->good_q, torque ? memory->good_torque : torque, memory->good_support, 1,
           memory, command, residual, &status);
  return status;
}

#endif /* ELASTOCAL_CORE_CORRECTION_H */
