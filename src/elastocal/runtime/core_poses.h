/* SPDX-License-Identifier: Apache-2.0 */
/* The calibrated robot at run time, in C99 that is C++ as well: the one implementation that both
   the library (compensator.hpp) and the headers of `elastocal export --format c99` compile.

   Units are SI and radians. A pose maps coordinates of its frame to those of its reference. The
   reference of all poses is the root link, unless said otherwise. No function allocates, locks or
   fails; loops are bounded by the sizes in ec_robot. What the model means is in docs/algorithms.md:
   eq. 1, 3, 5 and 6 of Bonnet et al. 2023. */
#ifndef ELASTOCAL_CORE_POSES_H
#define ELASTOCAL_CORE_POSES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* More than any position, torque or limit: none of them. */
#define EC_HUGE 1e300

/* What a call has to say, as bits. 0 is fine. */
enum {
  EC_FINE = 0,
  EC_BAD_POSITION = 1,   /* a position is not finite, or beyond 1e9: the last good positions were
                            used. Or a wanted pose is not finite or its matrix no rotation:
                            those of the nominal robot were used */
  EC_BAD_TORQUE = 2,     /* so is a torque, or their number is wrong: the last good one was used, or
                            else statics */
  EC_BAD_SUPPORT = 4,    /* no such foot: the last good support was used */
  EC_DEFLECTION_CUT = 8, /* a deflection was larger than its limit: cut to it */
  EC_CORRECTION_CUT = 16, /* the limit of corrections, or of their change from the last call, keeps
                             an end of a limb off, or cut one */
  EC_JOINT_LIMIT = 32,    /* the limit of a joint keeps the end of a limb from its place */
  EC_NOTHING_YET = 64 /* bad input before any good one: nominal, no correction; of a command, the
                         one of ec_start_from */
};

typedef struct {
  double R[9]; /* by rows */
  double p[3];
} ec_pose;

/* A joint: parent body -> twisted frame (z on the axis) -> elastic turn -> own motion -> body. */
typedef struct {
  int parent, coordinate, prismatic;
  double multiplier, offset; /* position = multiplier * q[coordinate] + offset */
  ec_pose twisted;
  double theta, r, centre;   /* centre: z of the joint's physical centre in the twisted frame */
  double compliance[3];      /* rad/(N.m); of a prismatic joint along z, m/N */
  double root_compliance[3]; /* of a joint on the root link: of this link about its origin,
                                rad/(N.m) */
  ec_pose body;
} ec_joint;

/* What a joint's position is off by beside its zero: an amount times a function of the posture. */
enum {
  EC_SIN,        /* sine of the joint's position */
  EC_COS,        /* its cosine */
  EC_SIN_TWICE,  /* sine of twice the position */
  EC_COS_TWICE,  /* its cosine */
  EC_GEAR,       /* position of the joint `source` (itself, or a neighbour) less `centre` */
  EC_BACKLASH,   /* sign of the load, smooth below `scale` */
  EC_STIFFENING, /* load times its size, over the square of `scale` */
  EC_HYSTERESIS  /* side of its play on which the joint lies, by the way that it came: -1 to 1 */
};

typedef struct {
  int joint, function, source;
  double amount, centre, scale; /* amount: rad, m or a ratio; scale: N.m or N */
} ec_shift;

typedef struct {
  int body;
  ec_pose pose; /* in the body */
} ec_frame;

typedef struct {
  ec_frame sole;
  double centre[3];     /* of the sole, in its frame */
  double up[3];         /* in its frame, while it is flat on a level floor */
  double compliance[6]; /* of the leg, in the axes of the foot: m/N x 3, rad/(N.m) x 3 */
} ec_foot;

/* The end of a limb, which the corrections put where it belongs. */
typedef struct {
  ec_frame frame;
  int foot;    /* of which leg, or -1 */
  int branch;  /* group of coordinates that move it, see ec_robot */
  int freedom; /* number of these that move it: six and more can give it any pose nearby */
  int yields;  /* it has fewer, and shares some with a limb of six and more */
  double arm;  /* m: at which its turns count; see EC_ARM_OF_FEW */
} ec_tip;

typedef struct {
  int joints, coordinates, links, feet, tips, branches, shifts;
  const ec_joint *nominal, *calibrated;
  const double* mass;     /* by body, kg */
  const double* moment;   /* by body, 3 each: mass times centre of mass in the body, kg.m */
  const int* leg_of_body; /* foot of the leg to which the body belongs, or -1 */
  const ec_frame* link;
  const ec_foot* foot;
  const ec_tip* tip;
  const ec_shift* shift;
  const int* branch_of_coordinate; /* or -1: it moves no tip, and is not corrected */
  const int* column_of_coordinate; /* its place among the coordinates of its branch */
  const int* branch_size;
  const double *lower, *upper; /* limits, by coordinate */
  double total_mass;           /* kg */
  double gravity[3];           /* in the frame of a root link that is held, m/s^2 */
  double suspension[12];       /* displacement of a held root link, m and rad along and about its
                                  axes, by the moment of the weight about its x, then about y */
  double torque_gain;          /* low-pass on torques: share of a new value, in (0, 1]; 1: none */
  double largest_turn;         /* limit of each deflection, rad ... */
  double largest_shift;        /* ... and m */
  double largest_correction;   /* limit of a command's difference to the nominal one, rad or m */
} ec_robot;

/* How far the search for a branch's command is. */
enum { EC_TRYING, EC_AGAIN, EC_DONE };

typedef struct {
  int state, bad;           /* bad: steps that have made it worse, in a row */
  double damping, gain;     /* gain: by how much the next step should lower the cost */
  double cost, left, first; /* squared errors: the best, of its furthest limb, the plan's */
  double kept, kept_left;   /* those of the first start */
  double last_left;         /* what the last command leaves */
} ec_search;

/* The last good input of one function. */
typedef struct {
  double* q;      /* coordinates */
  double* torque; /* joints; EC_UNKNOWN: not known */
  unsigned support;
  int has_q;
} ec_input;

/* Working memory, of the sizes given. From call to call it keeps the last good input, the last
   command and its pace, limits of changes, and the sides of plays. */
typedef struct {
  ec_pose* body;        /* joints + 1 */
  double* motion;       /* 3 x joints: cosine, sine and slide of the joint's own motion */
  ec_pose* twisted;     /* joints: of the last walk, before the elastic turn */
  double* axis;         /* 3 x joints: of the last walk, after the elastic turn */
  double* beyond;       /* 4 x (joints + 1): mass and first moment of each body and all beyond it */
  double* load;         /* 3 x joints, in the twisted frames */
  double* root_load;    /* 3 x joints: of those on the root link, about its origin */
  double* normal;       /* square of the largest branch */
  double* gradient;     /* largest branch */
  double* factor;       /* square of the largest branch: of `normal` */
  double* step;         /* largest branch */
  int* held;            /* largest branch: at which limit, -1, 1, or -2, 2 for the second time */
  int* loosed;          /* largest branch: it was held and let go of */
  double* column;       /* 6 x largest branch: of one tip */
  ec_search* search;    /* branches */
  double* best_q;       /* coordinates: the best so far ... */
  double* kept_q;       /* ... and that of the first start */
  double* start_q;      /* coordinates: the nominal positions with the last correction ... */
  double* lowest;       /* ... and how low and ... */
  double* highest;      /* ... how high a command may be, while `is_bound` */
  double* most_change;  /* coordinates: limits of a command's change, or EC_HUGE */
  double calls_to_pace; /* a correction changes its pace by that beside a plan in so many calls; 0:
                           at once */
  double* last_q;       /* coordinates: nominal positions of the last command ... */
  double* last_command; /* ... the best one, which the search found ... */
  double* given;        /* ... the one that follows it gently ... */
  double* pace;         /* ... and by how much its correction changed */
  ec_pose* last_target; /* tips: what it was for */
  unsigned* stopped;    /* coordinates: EC_JOINT_LIMIT or EC_CORRECTION_CUT where that limit keeps
                           the end of a limb from where it should be, or EC_FINE */
  ec_pose* target;      /* tips */
  double* good_q;       /* 3 x coordinates: those of `input` ... */
  double* good_torque;  /* ... and 3 x joints */
  ec_input input[3];    /* by function, EC_OF_... */
  double* work_q;       /* coordinates */
  double* shift;        /* joints: of their positions, by the calibration's causes */
  double* side; /* 2 x shifts: EC_HYSTERESIS of measured positions, then of those of plans ... */
  double* from; /* 2 x shifts: ... and the position of the joint then; EC_UNKNOWN: none yet */
  const double* sides;   /* of `side`, those of this call */
  double* centre;        /* 3 x feet: of the soles */
  double* share;         /* feet: of the weight */
  ec_pose* sole;         /* feet */
  double root_moment[2]; /* of the weight about x and y of a held root link, N.m */
  double common[3];      /* point of pressure less the centre of the sole, the same for all feet */
  unsigned last_support;
  int has_last, had_torque;
  int has_start;  /* `given` is the command of ec_start_from, and no plan has followed */
  int is_bound;   /* commands are between `lowest` and `highest` */
  int is_settled; /* the last command is at none of them */
} ec_memory;

/* Whether a position, torque or length can be one of a robot: finite, and no garbage of memory. By
   the bits, which are ordered as the sizes are: compilers that are told that all numbers are finite
   (-ffast-math) leave out any test of the number itself. */
static inline int ec_is_sane(double value) {
  const double most = 1e9;
  uint64_t bits, most_bits;
  memcpy(&bits, &value, sizeof bits);
  memcpy(&most_bits, &most, sizeof most_bits);
  return (bits & (UINT64_MAX >> 1)) <= most_bits;
}

/* ---- poses ---- */

static inline void ec_rotate(const double* R, const double* v, double* out) {
  const double x = v[0], y = v[1], z = v[2];
  out[0] = R[0] * x + R[1] * y + R[2] * z;
  out[1] = R[3] * x + R[4] * y + R[5] * z;
  out[2] = R[6] * x + R[7] * y + R[8] * z;
}

static inline void ec_rotate_back(const double* R, const double* v, double* out) {
  const double x = v[0], y = v[1], z = v[2];
  out[0] = R[0] * x + R[3] * y + R[6] * z;
  out[1] = R[1] * x + R[4] * y + R[7] * z;
  out[2] = R[2] * x + R[5] * y + R[8] * z;
}

static inline void ec_cross(const double* a, const double* b, double* out) {
  const double x = a[1] * b[2] - a[2] * b[1];
  const double y = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
  out[0] = x;
  out[1] = y;
}

static inline double ec_dot(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = A B; out is neither of them. */
static inline void ec_multiply(const double* A, const double* B, double* out) {
  int i, j;
  for (i = 0; i < 3; ++i) {
    for (j = 0; j < 3; ++j) {
      out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
    }
  }
}

static inline void ec_compose(const ec_pose* a, const ec_pose* b, ec_pose* out) {
  int i;
  ec_multiply(a->R, b->R, out->R);
  ec_rotate(a->R, b->p, out->p);
  for (i = 0; i < 3; ++i) out->p[i] += a->p[i];
}

static inline void ec_invert(const ec_pose* a, ec_pose* out) {
  int i, j;
  ec_rotate_back(a->R, a->p, out->p);
  for (i = 0; i < 3; ++i) {
    out->p[i] = -out->p[i];
    for (j = 0; j < 3; ++j) out->R[3 * i + j] = a->R[3 * j + i];
  }
}

static inline void ec_identity(ec_pose* out) {
  int i;
  for (i = 0; i < 9; ++i) out->R[i] = i % 4 == 0 ? 1.0 : 0.0;
  for (i = 0; i < 3; ++i) out->p[i] = 0.0;
}

/* Rotation by a small vector: series of sin(t)/t and (1-cos t)/t^2, exact to rounding below 0.3. */
static inline void ec_exp(const double* v, double* R) {
  const double t = ec_dot(v, v);
  const double s =
      1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0 * (1.0 - t / 110.0))));
  const double c = 0.5 * (1.0 - t / 12.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0 * (1.0 - t / 90.0))));
  R[0] = 1.0 - c * (v[1] * v[1] + v[2] * v[2]);
  R[4] = 1.0 - c * (v[0] * v[0] + v[2] * v[2]);
  R[8] = 1.0 - c * (v[0] * v[0] + v[1] * v[1]);
  R[1] = c * v[0] * v[1] - s * v[2];
  R[3] = c * v[0] * v[1] + s * v[2];
  R[2] = c * v[0] * v[2] + s * v[1];
  R[6] = c * v[0] * v[2] - s * v[1];
  R[5] = c * v[1] * v[2] - s * v[0];
  R[7] = c * v[1] * v[2] + s * v[0];
}

/* Rotation vector of a small rotation (below a right angle). */
static inline void ec_log(const double* R, double* v) {
  double s, c, scale;
  v[0] = 0.5 * (R[7] - R[5]);
  v[1] = 0.5 * (R[2] - R[6]);
  v[2] = 0.5 * (R[3] - R[1]);
  s = sqrt(ec_dot(v, v));
  c = 0.5 * (R[0] + R[4] + R[8] - 1.0);
  scale = s > 1e-9 ? atan2(s, c) / s : 1.0;
  v[0] *= scale;
  v[1] *= scale;
  v[2] *= scale;
}

static inline double ec_cut(double value, double limit, unsigned bit, unsigned* status) {
  if (value > limit) {
    *status |= bit;
    return limit;
  }
  if (value < -limit) {
    *status |= bit;
    return -limit;
  }
  return value;
}

#endif /* ELASTOCAL_CORE_POSES_H */
