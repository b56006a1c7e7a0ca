/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time: loads and deflections. See core_poses.h. */
#ifndef ELASTOCAL_CORE_STATICS_H
#define ELASTOCAL_CORE_STATICS_H

#include "elastocal/runtime/core_motion.h"

/* Turns (or shifts) the twisted frame by its load (eq. 5). */
static inline void ec_deflect(const ec_robot* robot, const ec_joint* joint, const double* load,
                              ec_pose* frame, unsigned* status) {
  double phi[3], turn[9], turned[9];
  int i;
  if (joint->prismatic) {
    const double shift =
        ec_cut(joint->compliance[2] * load[2], robot->largest_shift, EC_DEFLECTION_CUT, status);
    for (i = 0; i < 3; ++i) frame->p[i] += shift * frame->R[3 * i + 2];
    return;
  }
  for (i = 0; i < 3; ++i) {
    phi[i] = ec_cut(joint->compliance[i] * load[i], robot->largest_turn, EC_DEFLECTION_CUT, status);
  }
  ec_exp(phi, turn);
  ec_multiply(frame->R, turn, turned);
  for (i = 0; i < 3; ++i) {
    frame->p[i] += joint->centre * (frame->R[3 * i + 2] - turned[3 * i + 2]);
  }
  for (i = 0; i < 9; ++i) frame->R[i] = turned[i];
}

/* The root link as a joint on it sees it: turned about its origin by the joint's load. */
static inline void ec_bend_root(const ec_robot* robot, const ec_joint* joint, const double* load,
                                ec_pose* root, unsigned* status) {
  double phi[3];
  int i;
  for (i = 0; i < 3; ++i) {
    phi[i] =
        ec_cut(joint->root_compliance[i] * load[i], robot->largest_turn, EC_DEFLECTION_CUT, status);
    root->p[i] = 0.0;
  }
  ec_exp(phi, root->R);
}

/* Pose of the root link against where it is without load: held by what gives way. */
static inline void ec_sink(const ec_robot* robot, const double* moment, ec_pose* root,
                           unsigned* status) {
  double by[6];
  int i;
  for (i = 0; i < 6; ++i) {
    by[i] = ec_cut(robot->suspension[i] * moment[0] + robot->suspension[6 + i] * moment[1],
                   i < 3 ? robot->largest_shift : robot->largest_turn, EC_DEFLECTION_CUT, status);
  }
  ec_exp(&by[3], root->R);
  for (i = 0; i < 3; ++i) root->p[i] = by[i];
}

/* Poses of all bodies (eq. 3) after ec_move, deflected by the loads in memory if `loaded`. */
static inline void ec_walk(const ec_robot* robot, const ec_joint* joints, int loaded,
                           ec_memory* memory, unsigned* status) {
  int k, i;
  ec_identity(&memory->body[0]);
  if (loaded) ec_sink(robot, memory->root_moment, &memory->body[0], status);
  for (k = 0; k < robot->joints; ++k) {
    const ec_joint* joint = &joints[k];
    const double c = memory->motion[3 * k], s = memory->motion[3 * k + 1];
    ec_pose frame, moved;
    if (loaded && joint->parent == 0) {
      ec_pose root, bent;
      ec_bend_root(robot, joint, &memory->root_load[3 * k], &bent, status);
      ec_compose(&memory->body[0], &bent, &root);
      ec_compose(&root, &joint->twisted, &frame);
    } else {
      ec_compose(&memory->body[joint->parent], &joint->twisted, &frame);
    }
    memory->twisted[k] = frame;
    if (loaded) ec_deflect(robot, joint, &memory->load[3 * k], &frame, status);
    for (i = 0; i < 3; ++i) {
      const double x = frame.R[3 * i], y = frame.R[3 * i + 1], z = frame.R[3 * i + 2];
      moved.R[3 * i] = c * x + s * y;
      moved.R[3 * i + 1] = c * y - s * x;
      moved.R[3 * i + 2] = z;
      moved.p[i] = frame.p[i] + memory->motion[3 * k + 2] * z;
      memory->axis[3 * k + i] = z;
    }
    ec_compose(&moved, &joint->body, &memory->body[k + 1]);
  }
}

/* Direction and size of gravity in the root link's frame. The first foot that stands is flat on a
   level floor; a held root link is as it was when the robot was calibrated. */
static inline void ec_gravity(const ec_robot* robot, const ec_memory* memory, unsigned support,
                              double* gravity) {
  int f, i;
  for (i = 0; i < 3; ++i) gravity[i] = robot->gravity[i];
  for (f = 0; f < robot->feet; ++f) {
    ec_pose sole;
    if (!(support >> f & 1U)) continue;
    ec_compose(&memory->body[robot->foot[f].sole.body], &robot->foot[f].sole.pose, &sole);
    ec_rotate(sole.R, robot->foot[f].up, gravity);
    for (i = 0; i < 3; ++i) gravity[i] *= -sqrt(ec_dot(robot->gravity, robot->gravity));
    return;
  }
}

/* Two orthogonal horizontal directions. */
static inline void ec_floor_axes(const double* gravity, double* a, double* b) {
  const double size = sqrt(ec_dot(gravity, gravity));
  double length;
  int i;
  for (i = 0; i < 3; ++i) b[i] = 0.0;
  b[fabs(gravity[0]) < 0.7 * size ? 0 : 1] = 1.0;
  ec_cross(gravity, b, a);
  length = sqrt(ec_dot(a, a));
  for (i = 0; i < 3; ++i) a[i] /= length;
  ec_cross(gravity, a, b);
  for (i = 0; i < 3; ++i) b[i] /= size;
}

/* Feet whose second moment is no more, m^2, are at one place (a micrometre apart). */
#define EC_SAME_PLACE 1e-12

/* Slopes of the shares along the two directions: the least shares that put the weight at (x, y)
   from the mean of the feet, whose second moments are xx, xy, yy. Feet in a line have no slope
   across it, and one foot has none: what its moments are beside 0 is rounding, which a compiler
   that orders sums anew (-ffast-math) or fuses products with them leaves there. */
static inline void ec_slopes(double xx, double xy, double yy, double x, double y, double* slope) {
  const double determinant = xx * yy - xy * xy, trace = xx + yy;
  slope[0] = slope[1] = 0.0;
  if (trace <= EC_SAME_PLACE) return;
  if (determinant > 1e-9 * trace * trace) {
    slope[0] = (yy * x - xy * y) / determinant;
    slope[1] = (xx * y - xy * x) / determinant;
  } else {
    slope[0] = (xx * x + xy * y) / (trace * trace);
    slope[1] = (xy * x + yy * y) / (trace * trace);
  }
}

/* Shares of the weight that the standing feet carry at rest, if all press at like points: of two
   feet, by the place of the centre of mass between their centres; of more, those of least norm. */
static inline void ec_shares(const ec_robot* robot, ec_memory* memory, unsigned support,
                             const double* com, const double* gravity) {
  double* common = memory->common;
  double mean[3] = {0.0, 0.0, 0.0}, a[3], b[3], slope[2], from[3];
  double xx = 0.0, xy = 0.0, yy = 0.0, sum = 0.0;
  int f, i, count = 0;
  for (f = 0; f < robot->feet; ++f) {
    double* centre = &memory->centre[3 * f];
    ec_pose sole;
    ec_compose(&memory->body[robot->foot[f].sole.body], &robot->foot[f].sole.pose, &sole);
    ec_rotate(sole.R, robot->foot[f].centre, centre);
    memory->share[f] = 0.0;
    for (i = 0; i < 3; ++i) centre[i] += sole.p[i];
    if (!(support >> f & 1U)) continue;
    ++count;
    for (i = 0; i < 3; ++i) mean[i] += centre[i];
  }
  for (i = 0; i < 3; ++i) {
    mean[i] /= count;
    from[i] = com[i] - mean[i];
    common[i] = com[i];
  }
  ec_floor_axes(gravity, a, b);
  for (f = 0; f < robot->feet; ++f) {
    const double* centre = &memory->centre[3 * f];
    const double u = ec_dot(centre, a) - ec_dot(mean, a), v = ec_dot(centre, b) - ec_dot(mean, b);
    if (!(support >> f & 1U)) continue;
    xx += u * u;
    xy += u * v;
    yy += v * v;
  }
  ec_slopes(xx, xy, yy, ec_dot(from, a), ec_dot(from, b), slope);
  for (f = 0; f < robot->feet; ++f) {
    const double* centre = &memory->centre[3 * f];
    const double u = ec_dot(centre, a) - ec_dot(mean, a), v = ec_dot(centre, b) - ec_dot(mean, b);
    if (!(support >> f & 1U)) continue;
    memory->share[f] = 1.0 / count + slope[0] * u + slope[1] * v;
    if (memory->share[f] < 0.0) memory->share[f] = 0.0; /* a foot does not pull */
    sum += memory->share[f];
  }
  for (f = 0; f < robot->feet; ++f) {
    memory->share[f] /= sum;
    for (i = 0; i < 3; ++i) common[i] -= memory->share[f] * memory->centre[3 * f + i];
  }
}

/* Mass and first moment of each body and of all beyond it. */
static inline void ec_gather(const ec_robot* robot, ec_memory* memory) {
  double* beyond = memory->beyond;
  int k, i;
  for (k = 0; k <= robot->joints; ++k) {
    const double mass = robot->mass[k];
    ec_rotate(memory->body[k].R, &robot->moment[3 * k], &beyond[4 * k + 1]);
    beyond[4 * k] = mass;
    for (i = 0; i < 3; ++i) beyond[4 * k + 1 + i] += mass * memory->body[k].p[i];
  }
}

static inline void ec_accumulate(const ec_robot* robot, const ec_joint* joints, ec_memory* memory) {
  int k, i;
  for (k = robot->joints - 1; k >= 0; --k) {
    for (i = 0; i < 4; ++i) {
      memory->beyond[4 * joints[k].parent + i] += memory->beyond[4 * (k + 1) + i];
    }
  }
}

/* The floor holds the feet up: for a joint that is the same as negative mass at the point of
   pressure. One foot presses under the centre of mass. */
static inline void ec_stand(const ec_robot* robot, ec_memory* memory, unsigned support,
                            const double* gravity) {
  double com[3] = {0.0, 0.0, 0.0};
  int k, f, i;
  for (f = 0; f < robot->feet; ++f) memory->share[f] = 0.0;
  if (support == 0 || !(robot->total_mass > 0.0)) return;
  for (k = 0; k <= robot->joints; ++k) {
    for (i = 0; i < 3; ++i) com[i] += memory->beyond[4 * k + 1 + i];
  }
  for (i = 0; i < 3; ++i) com[i] /= robot->total_mass;
  ec_shares(robot, memory, support, com, gravity);
  for (f = 0; f < robot->feet; ++f) {
    double* foot = &memory->beyond[4 * robot->foot[f].sole.body];
    const double held = memory->share[f] * robot->total_mass;
    if (held == 0.0) continue;
    foot[0] -= held;
    for (i = 0; i < 3; ++i) foot[1 + i] -= held * (memory->centre[3 * f + i] + memory->common[i]);
  }
}

/* Loads of all joints (JointLoads in robot/kinematics.hpp) in the posture of the last walk, from
   statics, and about the axes from the torques that are given. `torque` may be null, and its
   entries EC_UNKNOWN. */
static inline void ec_loads(const ec_robot* robot, const ec_joint* joints, unsigned support,
                            const double* torque, ec_memory* memory, double* gravity) {
  int k, i;
  ec_gather(robot, memory);
  ec_gravity(robot, memory, support, gravity);
  ec_stand(robot, memory, support, gravity);
  ec_accumulate(robot, joints, memory);
  {
    double moment[3];
    ec_cross(&memory->beyond[1], gravity, moment);
    for (i = 0; i < 2; ++i) memory->root_moment[i] = support == 0 ? moment[i] : 0.0;
  }
  for (k = 0; k < robot->joints; ++k) {
    const ec_pose* twisted = &memory->twisted[k];
    const double* beyond = &memory->beyond[4 * (k + 1)];
    double* load = &memory->load[3 * k];
    double moment[3];
    if (joints[k].parent == 0) ec_cross(&beyond[1], gravity, &memory->root_load[3 * k]);
    if (joints[k].prismatic) {
      load[0] = load[1] = 0.0;
      load[2] = beyond[0] * (twisted->R[2] * gravity[0] + twisted->R[5] * gravity[1] +
                             twisted->R[8] * gravity[2]);
    } else {
      for (i = 0; i < 3; ++i) {
        const double centre = twisted->p[i] + joints[k].centre * twisted->R[3 * i + 2];
        moment[i] = beyond[1 + i] - beyond[0] * centre;
      }
      ec_cross(moment, gravity, moment);
      ec_rotate_back(twisted->R, moment, load);
    }
    if (torque && ec_is_sane(torque[k])) load[2] = -torque[k];
  }
}

/* What the waist puts on the leg of foot f: force and moment at the root link's origin, in its
   axes. The opposite is borne by the floor, or is the leg's own weight. A leg that is lifted hangs
   on what gives way in it, and the geometry has it as it hangs. From there on each spring of it
   bears what the floor bears, so that half the weight deflects it by half as much: its own weight
   counts by the share of the foot, all of it on one foot as where it was calibrated. */
static inline void ec_leg_load(const ec_robot* robot, int f, const double* gravity,
                               const ec_memory* memory, double* force, double* moment) {
  const double share = memory->share[f], held = share * robot->total_mass;
  double mass = -held, first[3], turned[3];
  int k, i;
  for (i = 0; i < 3; ++i) {
    first[i] = -held * (memory->centre[3 * f + i] + memory->common[i]);
  }
  for (k = 0; k <= robot->joints; ++k) {
    if (robot->leg_of_body[k] != f) continue;
    ec_rotate(memory->body[k].R, &robot->moment[3 * k], turned);
    mass += share * robot->mass[k];
    for (i = 0; i < 3; ++i) {
      first[i] += share * (turned[i] + robot->mass[k] * memory->body[k].p[i]);
    }
  }
  ec_cross(gravity, first, moment);
  for (i = 0; i < 3; ++i) force[i] = -mass * gravity[i];
}

/* Pose of foot f with the leg's lumped compliance (eq. 6). */
static inline void ec_sole_pose(const ec_robot* robot, int elastic, int f, const double* gravity,
                                ec_memory* memory, unsigned* status) {
  const ec_foot* foot = &robot->foot[f];
  ec_pose* sole = &memory->sole[f];
  double force[3], moment[3], turn[9];
  ec_pose rigid, back, bent;
  int i;
  ec_compose(&memory->body[foot->sole.body], &foot->sole.pose, sole);
  if (!elastic || memory->share[f] == 0.0) return;
  rigid = *sole;
  ec_leg_load(robot, f, gravity, memory, force, moment);
  ec_rotate_back(rigid.R, force, force);
  ec_rotate_back(rigid.R, moment, moment);
  ec_invert(&rigid, &back);
  for (i = 0; i < 3; ++i) {
    bent.p[i] = back.p[i] + ec_cut(foot->compliance[i] * force[i], robot->largest_shift,
                                   EC_DEFLECTION_CUT, status);
    moment[i] =
        ec_cut(foot->compliance[3 + i] * moment[i], robot->largest_turn, EC_DEFLECTION_CUT, status);
  }
  ec_exp(moment, turn);
  ec_multiply(turn, back.R, bent.R);
  ec_invert(&bent, sole);
}

static inline void ec_sole_poses(const ec_robot* robot, int elastic, const double* gravity,
                                 ec_memory* memory, unsigned* status) {
  int f;
  for (f = 0; f < robot->feet; ++f) {
    ec_sole_pose(robot, elastic, f, gravity, memory, status);
  }
}

/* The end of a limb, after ec_sole_poses. */
static inline void ec_tip_pose(const ec_robot* robot, int t, const ec_memory* memory,
                               ec_pose* pose) {
  const ec_tip* tip = &robot->tip[t];
  if (tip->foot >= 0) {
    *pose = memory->sole[tip->foot];
  } else {
    ec_compose(&memory->body[tip->frame.body], &tip->frame.pose, pose);
  }
}

static inline void ec_tip_poses(const ec_robot* robot, const ec_memory* memory, ec_pose* poses) {
  int t;
  for (t = 0; t < robot->tips; ++t) ec_tip_pose(robot, t, memory, &poses[t]);
}

/* The calibrated robot at rest at q, after an unloaded walk there: loads, deflections and loads of
   the deflected robot (a third time changes nothing, see docs/algorithms.md). Leaves body, twisted,
   axis, load and sole in memory. */
static inline void ec_settle(const ec_robot* robot, const double* q, unsigned support,
                             const double* torque, ec_memory* memory, double* gravity,
                             unsigned* status) {
  int i;
  for (i = 0; i < 2; ++i) {
    ec_loads(robot, robot->calibrated, support, torque, memory, gravity);
    ec_shift_joints(robot, q, memory, status);
    ec_walk(robot, robot->calibrated, 1, memory, status);
  }
  ec_sole_poses(robot, 1, gravity, memory, status);
}

#endif /* ELASTOCAL_CORE_STATICS_H */
