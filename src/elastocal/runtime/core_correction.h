/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: what a controller calls. See core_poses.h. */
#ifndef ELASTOCAL_CORE_CORRECTION_H
#define ELASTOCAL_CORE_CORRECTION_H

#include "elastocal/runtime/core_input.h"

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
  unsigned status = ec_take(robot, q, torque, support, EC_OF_FORWARD, memory);
  const ec_input* input = &memory->input[EC_OF_FORWARD];
  double gravity[3];
  int i;
  ec_move(robot, robot->calibrated, input->q, memory);
  ec_walk(robot, robot->calibrated, 0, memory, &status);
  ec_settle(robot, input->q, input->support, torque ? input->torque : torque, memory, gravity,
            &status);
  for (i = 0; i < robot->links; ++i) {
    ec_compose(&memory->body[robot->link[i].body], &robot->link[i].pose, &links[i]);
  }
  ec_root_on_first(robot, input->support, memory->sole, root);
  return status;
}

/* Positions with which the joints of a rigid robot stand as the deflected ones do, about their own
   axes: of joints that share a coordinate by least squares, in which a radian of each counts as
   much, and as EC_ARM metres of a slide. Two fingers that both give way by the same angle are a
   change of their common position by this angle, not by twice. */
static inline void ec_deflected_positions(const ec_robot* robot, const double* q, ec_memory* memory,
                                          double* positions, unsigned* status) {
  double *sum = memory->kept_q, *square = memory->best_q;
  int c, k;
  for (c = 0; c < robot->coordinates; ++c) sum[c] = square[c] = 0.0;
  for (k = 0; k < robot->joints; ++k) {
    const ec_joint* joint = &robot->calibrated[k];
    const double weight = joint->prismatic ? 1.0 / (EC_ARM * EC_ARM) : 1.0;
    const double deflection = memory->shift[k] + ec_give_way(robot, k, memory, status);
    sum[joint->coordinate] += weight * joint->multiplier * deflection;
    square[joint->coordinate] += weight * joint->multiplier * joint->multiplier;
  }
  for (c = 0; c < robot->coordinates; ++c) {
    positions[c] = q[c] + (square[c] > 0.0 ? sum[c] / square[c] : 0.0);
  }
}

/* Positions with which the rigid calibrated robot has the ends of its limbs (and so stands) where
   the real one has them at q: `rigid`, by coordinate. One that moves no end of a limb is where its
   joints are (ec_deflected_positions). `displacement`: how far the real root link is
   from that of the rigid calibrated robot at q, on the same feet: translation of its origin [m],
   then rotation vector [rad], in the axes of the first foot that stands. */
static inline unsigned ec_correct(const ec_robot* robot, const double* q, const double* torque,
                                  unsigned support, ec_memory* memory, double* rigid,
                                  double* displacement) {
  unsigned status = ec_take(robot, q, torque, support, EC_OF_CORRECT, memory);
  const ec_input* input = &memory->input[EC_OF_CORRECT];
  double gravity[3], turn[9], *start = memory->work_q;
  ec_pose straight[32], root, rigid_root;
  int c, i;
  q = input->q;
  if (status & EC_NOTHING_YET) {
    for (c = 0; c < robot->coordinates; ++c) rigid[c] = q[c];
    for (i = 0; i < 6; ++i) displacement[i] = 0.0;
    return status;
  }
  ec_move(robot, robot->calibrated, q, memory);
  ec_walk(robot, robot->calibrated, 0, memory, &status);
  ec_place_feet(robot, memory, straight);
  ec_settle(robot, q, input->support, torque ? input->torque : torque, memory, gravity, &status);
  ec_tip_poses(robot, memory, memory->target);
  ec_root_on_first(robot, input->support, memory->sole, &root);
  ec_root_on_feet(robot, input->support, memory->sole, straight, memory->share, &rigid_root);
  for (i = 0; i < 9; ++i) {
    turn[i] = ec_dot(&root.R[3 * (i / 3)], &rigid_root.R[3 * (i % 3)]);
  }
  ec_log(turn, &displacement[3]);
  for (i = 0; i < 3; ++i) displacement[i] = root.p[i] - rigid_root.p[i];
  ec_deflected_positions(robot, q, memory, start, &status);
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

/* Whether rows of a finite matrix are the axes of a right-handed frame: to 5e-3, so that numbers
   with three decimals pass. */
static inline int ec_is_rotation(const double* R) {
  const double most = 5e-3;
  double third[3];
  int i, good;
  ec_cross(R, R + 3, third);
  good = fabs(ec_dot(R, R) - 1.0) <= most && fabs(ec_dot(R + 3, R + 3) - 1.0) <= most &&
         fabs(ec_dot(R, R + 3)) <= most;
  for (i = 0; i < 3; ++i) good = good && fabs(third[i] - R[6 + i]) <= most;
  return good;
}

/* Whether all poses of the ends of limbs are finite, and poses. */
static inline int ec_are_sane(const ec_robot* robot, const ec_pose* targets) {
  int t, i, good = 1;
  for (t = 0; t < robot->tips; ++t) {
    for (i = 0; i < 9; ++i) good = good && ec_is_sane(targets[t].R[i]);
    for (i = 0; i < 3; ++i) good = good && ec_is_sane(targets[t].p[i]);
    good = good && ec_is_rotation(targets[t].R);
  }
  return good;
}

/* ec_command and ec_command_poses: for the poses in memory->target, or those of the nominal robot.
 */
static inline unsigned ec_command_for(const ec_robot* robot, int has_targets, unsigned status,
                                      const double* torque, ec_memory* memory, double* command,
                                      double* residual) {
  const ec_input* input = &memory->input[EC_OF_COMMAND];
  int c;
  if (status & EC_NOTHING_YET) {
    for (c = 0; c < robot->coordinates; ++c) {
      command[c] = memory->has_start ? memory->given[c] : input->q[c];
      memory->stopped[c] = EC_FINE;
    }
    residual[0] = residual[1] = 0.0;
    return status;
  }
  if (!has_targets) {
    ec_move(robot, robot->nominal, input->q, memory);
    ec_walk(robot, robot->nominal, 0, memory, &status);
    ec_place_feet(robot, memory, memory->sole);
    ec_tip_poses(robot, memory, memory->target);
  }
  ec_reach(robot, input->q, torque ? input->torque : torque, input->support, has_targets, memory,
           command, residual, &status);
  return status;
}

/* Commands with which the real robot has hands, feet and waist where the nominal robot has them at
   `nominal`. `torque`: those of the planned motion, by joint, or null: statics. `residual`: largest
   distance [m] and angle [rad] that is left at the end of a limb that does not yield (ec_tip). */
static inline unsigned ec_command(const ec_robot* robot, const double* nominal,
                                  const double* torque, unsigned support, ec_memory* memory,
                                  double* command, double* residual) {
  const unsigned status = ec_take(robot, nominal, torque, support, EC_OF_COMMAND, memory);
  return ec_command_for(robot, 0, status, torque, memory, command, residual);
}

/* The same for poses of the ends of the limbs in the root link's frame, by tip; `nominal` is the
   posture nearby from which redundant joints do not stray. A pose that is not finite, or whose
   matrix is no rotation, is a bad position: the nominal robot's poses are taken. */
static inline unsigned ec_command_poses(const ec_robot* robot, const ec_pose* targets,
                                        const double* nominal, const double* torque,
                                        unsigned support, ec_memory* memory, double* command,
                                        double* residual) {
  unsigned status = ec_take(robot, nominal, torque, support, EC_OF_COMMAND, memory);
  const int good = ec_are_sane(robot, targets);
  int t;
  if (!good) status |= EC_BAD_POSITION;
  for (t = 0; good && t < robot->tips; ++t) memory->target[t] = targets[t];
  return ec_command_for(robot, good, status, torque, memory, command, residual);
}

#endif /* ELASTOCAL_CORE_CORRECTION_H */
