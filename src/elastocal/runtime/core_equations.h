/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: what brings the ends of the limbs to their targets, as linear
   equations. See core_poses.h. */
#ifndef ELASTOCAL_CORE_EQUATIONS_H
#define ELASTOCAL_CORE_EQUATIONS_H

#include "elastocal/runtime/core_statics.h"

/* Rotations count as the displacement that they give at this distance, m. */
#define EC_ARM 0.3
/* The same for arms that have too few joints for place and attitude: the place comes first. */
#define EC_ARM_OF_FEW (0.1 * EC_ARM)
/* Weights of staying near the reference posture and of a short step, against EC_ARM's metres. What
   the ends of the limbs do not determine (redundant arms) stays at the reference, and what they
   hardly determine (stretched arms and knees) moves little. */
#define EC_STAY 1e-3
#define EC_DAMP 0.02
/* Weight of a limb of fewer than six joints, which cannot keep its pose, where it shares joints
   with one that can (a head on the trunk that carries arms): these do not go far for it. */
#define EC_SHORT 0.05
/* After a step as small as this, rad or m, the next one would change the square of it. */
#define EC_SMALL_STEP 1e-3

/* How far a tip is from its target: metres, then radians times `arm`. */
static inline void ec_tip_error(const ec_pose* now, const ec_pose* target, double arm,
                                double* error) {
  double turn[9];
  int i;
  for (i = 0; i < 9; ++i) {
    turn[i] = target->R[3 * (i / 3)] * now->R[3 * (i % 3)] +
              target->R[3 * (i / 3) + 1] * now->R[3 * (i % 3) + 1] +
              target->R[3 * (i / 3) + 2] * now->R[3 * (i % 3) + 2];
  }
  ec_log(turn, &error[3]);
  for (i = 0; i < 3; ++i) {
    error[i] = target->p[i] - now->p[i];
    error[3 + i] *= arm;
  }
}

/* Adds what tip t asks of its branch to the normal equations. */
static inline void ec_add_tip(const ec_robot* robot, const ec_joint* joints, int t,
                              const ec_pose* now, ec_memory* memory) {
  const ec_tip* tip = &robot->tip[t];
  const int size = robot->branch_size[tip->branch];
  const double share = tip->yields ? EC_SHORT * EC_SHORT : 1.0;
  double error[6], *J = memory->column;
  int columns[64], used = 0, body, i, a, b;
  ec_tip_error(now, &memory->target[t], tip->arm, error);
  for (body = tip->frame.body; body > 0 && used < 64; body = joints[body - 1].parent) {
    const ec_joint* joint = &joints[body - 1];
    const double* axis = &memory->axis[3 * (body - 1)];
    double *column = &J[6 * used], lever[3];
    if (robot->branch_of_coordinate[joint->coordinate] != tip->branch) continue;
    for (i = 0; i < 3; ++i) {
      lever[i] = now->p[i] - memory->twisted[body - 1].p[i];
      column[3 + i] = joint->prismatic ? 0.0 : tip->arm * joint->multiplier * axis[i];
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

/* The normal equations of a branch at q, after a walk there and ec_sole_poses: their lower half,
   and the gradient. Positions stay near `reference`. */
static inline void ec_equations(const ec_robot* robot, int branch, const double* reference,
                                const double* q, ec_memory* memory) {
  const int size = robot->branch_size[branch];
  int t, c, i;
  for (i = 0; i < size * size; ++i) memory->normal[i] = 0.0;
  for (c = 0; c < robot->coordinates; ++c) {
    const int column = robot->column_of_coordinate[c];
    if (robot->branch_of_coordinate[c] != branch) continue;
    memory->normal[(size + 1) * column] = EC_STAY * EC_STAY;
    memory->gradient[column] = EC_STAY * EC_STAY * (reference[c] - q[c]);
  }
  for (t = 0; t < robot->tips; ++t) {
    ec_pose now;
    if (robot->tip[t].branch != branch) continue;
    ec_tip_pose(robot, t, memory, &now);
    ec_add_tip(robot, robot->calibrated, t, &now, memory);
  }
}

/* One damped Gauss-Newton step of all branches: moves q so that the ends of the limbs come to the
   targets in memory. Positions stay near `reference`. Returns the largest change. What a coordinate
   moves by less than EC_ARM a radian, or counts less (EC_ARM_OF_FEW, EC_SHORT), is damped less. */
static inline double ec_step(const ec_robot* robot, const double* reference, double* q,
                             ec_memory* memory) {
  double largest = 0.0;
  int branch, c, i;
  for (branch = 0; branch < robot->branches; ++branch) {
    const int size = robot->branch_size[branch];
    ec_equations(robot, branch, reference, q, memory);
    for (i = 0; i < size; ++i) {
      double* square = &memory->normal[(size + 1) * i];
      const double share = *square / (EC_ARM * EC_ARM);
      *square += EC_DAMP * EC_DAMP * (share < 1.0 ? share : 1.0);
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

#endif /* ELASTOCAL_CORE_EQUATIONS_H */
