// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Whether external parameters (T0, marker positions) or joint parameters are kept, where one can
/// stand for the other.
enum class ExternalPriority {
  /// T0 and marker positions come before joint parameters: what they can explain is not attributed
  /// to the robot. For a chain, this drops the parameters that the paper holds at zero by hand:
  /// those of the first joint, and theta and r of the last one.
  kFirst,
  /// The order printed in section 2.1: T0 and marker positions last.
  kLast,
};

/// Whether the root link has one pose in all postures.
enum class RootPose {
  kConstant,  ///< one unknown pose in all postures: T0
  kFree,      ///< an unknown pose of its own in each posture; T0 is no parameter
};

struct IdentifiabilityOptions {
  int postures = 1000;  ///< drawn uniformly within the joint limits
  /// A column is dependent when less than this part of its norm is left after projection. At
  /// nominal geometry the gap is wide: anything in 1e-10..1e-3 gives the same result.
  double tolerance = 1e-6;
  std::uint64_t seed = 1;
  ExternalPriority external = ExternalPriority::kFirst;
  RootPose root = RootPose::kConstant;  ///< with kFree, at most 300 postures are used
  /// Name patterns of parameters held at nominal; `*` stands for any run of characters.
  std::vector<std::string> hold = {};
};

/// The base parameters of an error model (those that are identifiable): chosen at nominal geometry,
/// then frozen.
struct BaseParameters {
  /// Indices into the model's parameters, ascending. Elastic parameters are among them unless held:
  /// the data decide on them (IsElastic).
  std::vector<int> kept;
  int geometric_count = 0;   ///< number of kept parameters that are not elastic
  std::vector<int> dropped;  ///< not identifiable beside the kept ones, ascending
  std::vector<int> held;     ///< held by the user's setting, ascending
  /// kept x dropped: the data determine delta(kept) + regrouping * delta(dropped).
  Eigen::MatrixXd regrouping;
  double smallest_kept = 1.0;    ///< smallest relative remainder among the kept columns
  double largest_dropped = 0.0;  ///< largest relative remainder among the dropped columns
  /// 4 R + 2 P + 3 N_M for R revolute and P prismatic joints that move one of the N_M markers (see
  /// docs/algorithms.md). With a free root 4 R + 2 P + 3 N_M - 6, for joints that move some of the
  /// markers but not all. It is valid if no parameter is held, and does not count elastic
  /// parameters. If fewer are kept and none is held, the marker positions are special, or (with a
  /// free root) a body has too few markers. The kept parameters of linkages are added to the count,
  /// because no formula gives theirs.
  int theoretical_count = 0;
};

/// The part of an error of a dropped parameter that shows up in a kept one.
struct Share {
  int parameter;       ///< index into the model's parameters
  double coefficient;  ///< units of the kept parameter per unit of the dropped one
};

/// Shares of a dropped parameter in the kept ones, ascending by kept parameter; `dropped` is an
/// index into `base.dropped`. Shares below 1e-9 by absolute value are rounding and left out.
std::vector<Share> RegroupedInto(const BaseParameters& base, int dropped);

/// Factor (see regressor.hpp) of the regressor over random postures at nominal geometry.
Eigen::MatrixXd NominalFactor(const ErrorModel& model, const IdentifiabilityOptions& options);

/// Factor of the regressor over the postures in the rows of `q`; with a free root, over the first
/// 300 of them.
Eigen::MatrixXd NominalFactor(const ErrorModel& model, const Eigen::MatrixXd& q, RootPose root);

/// Finds the base parameters by QR without pivoting over random postures (section 2.1). Joint
/// parameters have the paper's priority: theta, then r, d and b, then alpha, beta and gamma.
BaseParameters FindBaseParameters(const ErrorModel& model, const IdentifiabilityOptions& options);

/// Finds the base parameters from a factor that NominalFactor returned, for other holds or another
/// priority.
BaseParameters FindBaseParameters(const ErrorModel& model, const Eigen::MatrixXd& factor,
                                  const IdentifiabilityOptions& options);

/// Parameters that would be identifiable with generic marker positions but are not with the given
/// ones. They are found by a second choice with the markers moved. Empty if the count is the
/// theoretical one.
std::vector<int> LostBySpecialMarkers(const ErrorModel& model,
                                      const IdentifiabilityOptions& options);

}  // namespace elastocal
