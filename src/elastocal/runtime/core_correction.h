/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: what a controller calls. See core_poses.h. */
#ifndef ELASTOCAL_CORE_CORRECTION_H
#define ELASTOCAL_CORE_CORRECTION_H

#include "elastocal/runtime/core_statics.h"

/* Rotations count as the displacement that they give at this distance, m. */
#define EC_ARM 0.3
/* Weights of staying near the reference posture and of a short step, against EC_ARM's metres. What
   the ends of the limbs do not determine (redundant arms) stays at the reference, and what they
   hardly determine (stretched arms and knees) moves little. */
#define EC_STAY 1e-3
#define EC_DAMP 0.02
/* Weight of a limb of fewer than six joints, which cannot keep its pose, where it shares joints
   with one that can (a head on the trunk that carries arms): these do not go far for it. */
#define EC_SHORT 0.05
#define EC_ITERATIONS 4
/* After a step as small as this, rad or m, the next one would change the square of it. */
#define EC_SMALL_STEP 1e-3

/* Adds what tip t asks of its branch to the normal equations. */
static inline void ec_add_tip(const ec_robot* robot, const ec_joint* joints, int t,
                              const ec_pose* now, const ec_pose* target, ec_memory* memory) {
  const ec_tip* tip = &robot->tip[t];
  const int size = robot->branch_size[tip->branch];
  const double share = tip->yields ? EC_SHORT * EC_SHORT : 1.0;
  double error[6], turn[9], *J = memory->column;
  int columns[64], used = 0, body, i, a, b;
  for (i = 0; i < 9; ++i) {
    turn[i] = target->R[3 * (i / 3)] * now->R[3 * (i % 3)] +
              target->R[3 * (i / 3) + 1] * now->R[3 * (i % 3) + 1] +
              target->R[3 * (i / 3) + 2] * now->R[3 * (i % 3) + 2];
  }
  ec_log(turn, &error[3]);
  for (i = 0; i < 3; ++i) {
    error[i] = target->p[i] - now->p[i];
    error[3 + i] *= EC_ARM;
  }
  for (body = tip->frame.body; body > 0 && used < 64; body = joints[body - 1].parent) {
    const ec_joint* joint = &joints[body - 1];
    const double* axis = &memory->axis[3 * (body - 1)];
    double *column = &J[6 * used], lever[3];
    if (robot->branch_of_coordinate[joint->coordinate] != tip->branch) continue;
    for (i = 0; i < 3; ++i) {
      lever[i] = now->p[i] - memory->twisted[body - 1].p[i];
      column[3 + i] = joint->prismatic ? 0.0 : EC_ARM * joint->multiplier * axis[i];
    }
    ec_cross(axis, lever, column);
    for (i = 0; i < 3; ++i)
      column[i] = joint->multiplier * (joint->prismatic ? axis[i] : column[i]);
    columns[used++] = robot->column_of_coordinate[joint->coordinate];
  }
  for (a = 0; a < used; ++a) {
    for (i = 0; i < 6; ++i) memory->gradient[columns[a]] += share * J[6 * a + i] * error[i];
    for (b = 0; b < used; ++b) {
      double sum = 0.0;
      if (columns[b] > columns[a]) continue; /* the lower half */
      for (i = 0; i < 6; ++i) sum += J[6 * a + i] * J[6 * b + i];
      memory->normal[size * columns[a] + columns[b]] += share * sum;
    }
  }
}

/* Solves the normal equations in place by Cholesky's method; the lower half is given. */
static inline void ec_solve(int size, double* normal, double* x) {
  int i, j, k;
  for (j = 0; j < size; ++j) {
    for (i = j; i < size; ++i) {
      double sum = normal[size * i + j];
      for (k = 0; k < j; ++k) sum -= normal[size * i + k] * normal[size * j + k];
      normal[size * i + j] = i == j ? sqrt(sum) : sum / normal[size * j + j];
    }
  }
  for (i = 0; i < size; ++i) {
    for (k = 0; k < i; ++k) x[i] -= normal[size * i + k] * x[k];
    x[i] /= normal[size * i + i];
  }
  for (i = size - 1; i >= 0; --i) {
    for (k = i + 1; k < size; ++k) x[i] -= normal[size * k + i] * x[k];
    x[i] /= normal[size * i + i];
  }
}

/* One Gauss-Newton step of all branches: moves q so that the ends of the limbs come to the targets
   in memory. Positions stay near `reference`. Returns the largest change. */
static inline double ec_step(const ec_robot* robot, const double* reference, double* q,
                             ec_memory* memory) {
  double largest = 0.0;
  int branch, t, c, i;
  for (branch = 0; branch < robot->branches; ++branch) {
    const int size = robot->branch_size[branch];
    for (i = 0; i < size * size; ++i) memory->normal[i] = 0.0;
    for (c = 0; c < robot->coordinates; ++c) {
      const int column = robot->column_of_coordinate[c];
      if (robot->branch_of_coordinate[c] != branch) continue;
      memory->normal[(size + 1) * column] = EC_STAY * EC_STAY + EC_DAMP * EC_DAMP;
      memory->gradient[column] = EC_STAY * EC_STAY * (reference[c] - q[c]);
    }
    for (t = 0; t < robot->tips; ++t) {
      ec_pose now;
      if (robot->tip[t].branch != branch) continue;
      ec_tip_pose(robot, t, memory, &now);
      ec_add_tip(robot, robot->calibrated, t, &now, &memory->target[t], memory);
    }
    ec_solve(size, memory->normal, memory->gradient);
    for (c = 0; c < robot->coordinates; ++c) {
      double change;
      if (robot->branch_of_coordinate[c] != branch) continue;
      change = memory->gradient[robot->column_of_coordinate[c]];
      q[c] += change;
      if (fabs(change) > largest) largest = fabs(change);
    }
  }
  return largest;
}

/* Largest distance [m] and angle [rad] of the ends of limbs to their targets, but for those that
   yield. */
static inline void ec_residual(const ec_robot* robot, const ec_memory* memory, double* residual) {
  int t, i;
  residual[0] = residual[1] = 0.0;
  for (t = 0; t < robot->tips; ++t) {
    const ec_pose* target = &memory->target[t];
    ec_pose now;
    double turn[9], v[3], distance = 0.0, angle;
    if (robot->tip[t].yields) continue;
    ec_tip_pose(robot, t, memory, &now);
    for (i = 0; i < 3; ++i) {
      distance += (target->p[i] - now.p[i]) * (target->p[i] - now.p[i]);
    }
    for (i = 0; i < 9; ++i) {
      turn[i] = target->R[3 * (i / 3)] * now.R[3 * (i % 3)] +
                target->R[3 * (i / 3) + 1] * now.R[3 * (i % 3) + 1] +
                target->R[3 * (i / 3) + 2] * now.R[3 * (i % 3) + 2];
    }
    ec_log(turn, v);
    distance = sqrt(distance);
    angle = sqrt(ec_dot(v, v));
    if (distance > residual[0]) residual[0] = distance;
    if (angle > residual[1]) residual[1] = angle;
  }
}

/* ---- input ---- */

/* Takes over what is good of the input, and says what is not. */
static inline unsigned ec_take(const ec_robot* robot, const double* q, const double* torque,
                               unsigned support, ec_memory* memory) {
  unsigned status = EC_FINE;
  int c, k;
  for (c = 0; c < robot->coordinates; ++c) {
    if (!isfinite(q[c])) status |= EC_BAD_POSITION;
  }
  if (!(status & EC_BAD_POSITION)) {
    for (c = 0; c < robot->coordinates; ++c) memory->good_q[c] = q[c];
    memory->has_good_q = 1;
  } else if (!memory->has_good_q) {
    status |= EC_NOTHING_YET;
  }
  for (k = 0; torque && k < robot->joints; ++k) {
    if (isfinite(torque[k])) {
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
  for (k = 0; k < robot->joints; ++k) memory->good_torque[k] = NAN;
  memory->good_support = 0;
  memory->has_good_q = 0;
}

/* Where the nominal robot at the good positions has its feet: from `body` after a nominal walk. */
static inline void ec_place_feet(const ec_robot* robot, const ec_memory* memory, ec_pose* placed) {
  int f;
  for (f = 0; f < robot->feet; ++f) {
    ec_compose(&memory->body[robot->foot[f].sole.body], &robot->foot[f].sole.pose, &placed[f]);
  }
}

/* Poses of all links in the root link's frame, with deflection, and of the root link on its feet
   (ec_root_on_feet). `support`: bit f is set where foot f stands; 0: the root link is held.
   `torque` by joint as sensors report it (it balances the load), or null: statics. */
static inline unsigned ec_forward(const ec_robot* robot, const double* q, const double* torque,
                                  unsigned support, ec_memory* memory, ec_pose* links,
                                  ec_pose* root) {
  unsigned status = ec_take(robot, q, torque, support, memory);
  double gravity[3];
  ec_pose placed[32];
  int i;
  ec_move(robot, robot->nominal, memory->good_q, memory);
  ec_walk(robot, robot->nominal, 0, memory, &status);
  ec_place_feet(robot, memory, placed);
  ec_move(robot, robot->calibrated, memory->good_q, memory);
  ec_walk(robot, robot->calibrated, 0, memory, &status);
  ec_settle(robot, memory->good_q, memory->good_support, torque ? memory->good_torque : 0, memory,
            gravity, &status);
  for (i = 0; i < robot->links; ++i) {
    ec_compose(&memory->body[robot->link[i].body], &robot->link[i].pose, &links[i]);
  }
  ec_root_on_feet(robot, memory->good_support, placed, memory->sole, memory->share, root);
  return status;
}

/* Positions with which the rigid calibrated robot has the ends of its limbs (and so stands) where
   the real one has them at q: `rigid`, by coordinate. `displacement`: how far the real root link is
   from that of the rigid calibrated robot at q, on the same feet: translation of its origin [m],
   then rotation vector [rad], in the axes of the first foot that stands. */
static inline unsigned ec_correct(const ec_robot* robot, const double* q, const double* torque,
                                  unsigned support, ec_memory* memory, double* rigid,
                                  double* displacement) {
  unsigned status = ec_take(robot, q, torque, support, memory);
  double gravity[3], turn[9], *start = memory->work_q;
  ec_pose placed[32], straight[32], root, rigid_root;
  int c, i, k;
  q = memory->good_q;
  if (status & EC_NOTHING_YET) {
    for (c = 0; c < robot->coordinates; ++c) rigid[c] = q[c];
    for (i = 0; i < 6; ++i) displacement[i] = 0.0;
    return status;
  }
  if (memory->good_support & (memory->good_support - 1U)) { /* more than one foot */
    ec_move(robot, robot->nominal, q, memory);
    ec_walk(robot, robot->nominal, 0, memory, &status);
  }
  ec_place_feet(robot, memory, placed); /* not used of one foot */
  ec_move(robot, robot->calibrated, q, memory);
  ec_walk(robot, robot->calibrated, 0, memory, &status);
  ec_place_feet(robot, memory, straight);
  ec_settle(robot, q, memory->good_support, torque ? memory->good_torque : 0, memory, gravity,
            &status);
  ec_tip_poses(robot, memory, memory->target);
  ec_root_on_feet(robot, memory->good_support, placed, memory->sole, memory->share, &root);
  ec_root_on_feet(robot, memory->good_support, placed, straight, memory->share, &rigid_root);
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

/* Cuts a command to what is allowed. */
static inline void ec_limit(const ec_robot* robot, const double* nominal, double* command,
                            unsigned* status) {
  int c;
  for (c = 0; c < robot->coordinates; ++c) {
    command[c] = nominal[c] + ec_cut(command[c] - nominal[c], robot->largest_correction,
                                     EC_CORRECTION_CUT, status);
    /* A command that the nominal plan had beyond the limits is not moved. */
    if (command[c] < robot->lower[c] && command[c] < nominal[c]) {
      command[c] = nominal[c] < robot->lower[c] ? nominal[c] : robot->lower[c];
      *status |= EC_JOINT_LIMIT;
    }
    if (command[c] > robot->upper[c] && command[c] > nominal[c]) {
      command[c] = nominal[c] > robot->upper[c] ? nominal[c] : robot->upper[c];
      *status |= EC_JOINT_LIMIT;
    }
  }
}

/* Commands with which the real robot has the ends of its limbs at the targets in memory. */
static inline void ec_reach(const ec_robot* robot, const double* nominal, const double* torque,
                            unsigned support, ec_memory* memory, double* command, double* residual,
                            unsigned* status) {
  double gravity[3];
  int c, i;
  for (c = 0; c < robot->coordinates; ++c) command[c] = nominal[c];
  ec_move(robot, robot->calibrated, command, memory);
  ec_walk(robot, robot->calibrated, 0, memory, status);
  ec_loads(robot, robot->calibrated, support, torque, memory, gravity);
  for (i = 0; i < EC_ITERATIONS; ++i) {
    unsigned cut = EC_FINE; /* only what holds at the end counts */
    ec_move(robot, robot->calibrated, command, memory);
    ec_shift_joints(robot, command, memory);
    ec_walk(robot, robot->calibrated, 1, memory, &cut);
    ec_loads(robot, robot->calibrated, support, torque, memory, gravity);
    ec_sole_poses(robot, 1, gravity, memory, &cut);
    ec_step(robot, nominal, command, memory);
    ec_limit(robot, nominal, command, i + 1 == EC_ITERATIONS ? status : &cut);
  }
  ec_move(robot, robot->calibrated, command, memory);
  ec_shift_joints(robot, command, memory);
  ec_walk(robot, robot->calibrated, 1, memory, status);
  ec_sole_poses(robot, 1, gravity, memory, status);
  ec_residual(robot, memory, residual);
}

/* Commands with which the real robot has hands, feet and waist where the nominal robot has them at
   `nominal`. `torque`: those of the planned motion, by joint, or null: statics. `residual`: largest
   distance [m] and angle [rad] that is left at the end of a limb that does not yield (ec_tip). */
static inline unsigned ec_command(const ec_robot* robot, const double* nominal,
                                  const double* torque, unsigned support, ec_memory* memory,
                                  double* command, double* residual) {
  unsigned status = ec_take(robot, nominal, torque, support, memory);
  ec_pose placed[32];
  int f, c;
  if (status & EC_NOTHING_YET) {
    for (c = 0; c < robot->coordinates; ++c) command[c] = memory->good_q[c];
    residual[0] = residual[1] = 0.0;
    return status;
  }
  ec_move(robot, robot->nominal, memory->good_q, memory);
  ec_walk(robot, robot->nominal, 0, memory, &status);
  ec_place_feet(robot, memory, placed);
  for (f = 0; f < robot->feet; ++f) memory->sole[f] = placed[f];
  ec_tip_poses(robot, memory, memory->target);
  ec_reach(robot, memory->good_q, torque ? memory->good_torque : 0, memory->good_support, memory,
           command, residual, &status);
  return status;
}

/* The same for poses of the ends of the limbs in the root link's frame, by tip; `nominal` is the
   posture nearby from which redundant joints do not stray. A pose that is not finite is a bad
   position: the nominal robot's poses are taken. */
static inline unsigned ec_command_poses(const ec_robot* robot, const ec_pose* targets,
                                        const double* nominal, const double* torque,
                                        unsigned support, ec_memory* memory, double* command,
                                        double* residual) {
  unsigned status = ec_take(robot, nominal, torque, support, memory);
  int t, i, good = 1;
  for (t = 0; t < robot->tips; ++t) {
    for (i = 0; i < 9; ++i) good = good && isfinite(targets[t].R[i]);
    for (i = 0; i < 3; ++i) good = good && isfinite(targets[t].p[i]);
  }
  if (!good)
    return ec_command(robot, memory->good_q, torque, support, memory, command, residual) |
           EC_BAD_POSITION;
  for (t = 0; t < robot->tips; ++t) memory->target[t] = targets[t];
  ec_reach(robot, memory->good_q, torque ? memory->good_torque : 0, memory->good_support, memory,
           command, residual, &status);
  return status;
}

#endif /* ELASTOCAL_CORE_CORRECTION_H */
