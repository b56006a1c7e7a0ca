#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Which of the redundant parameters stand for the others.
enum class ExternalPriority {
  /// T0 and marker positions come before the joints': what they can explain is not attributed to
  /// the robot. For a chain it leaves out what the paper holds at zero by hand: the first joint and
  /// the last joint's theta and r.
  kFirst,
  /// The order printed in section 2.1: T0 and marker positions last.
  kLast,
};

struct IdentifiabilityOptions {
  int postures = 1000;  ///< drawn uniformly within the joint limits
  /// A column is dependent when less than this part of its norm is left after projection. At
  /// nominal geometry the gap is wide: anything in 1e-10..1e-3 gives the same result.
  double tolerance = 1e-6;
  std::uint64_t seed = 1;
  ExternalPriority external = ExternalPriority::kFirst;
  /// Name patterns of parameters held at nominal, `*` standing for anything.
  std::vector<std::string> hold = {};
};

/// The identifiable (base) parameters of an error model: decided at nominal geometry, then frozen.
struct BaseParameters {
  /// Indices into the model's parameters, ascending. Elastic ones are among them unless held: the
  /// data decide on these (IsElastic).
  std::vector<int> kept;
  int geometric_count = 0;   ///< of the kept ones, those that are not elastic
  std::vector<int> dropped;  ///< not identifiable beside the kept ones, ascending
  std::vector<int> held;     ///< held by the user's setting, ascending
  /// kept x dropped: what the data determine is delta(kept) + regrouping * delta(dropped).
  Eigen::MatrixXd regrouping;
  double smallest_kept = 1.0;    ///< smallest relative remainder among the kept columns
  double largest_dropped = 0.0;  ///< largest among the dropped ones
  /// 4 R + 2 P + 3 N_M for R revolute and P prismatic joints that move one of the N_M markers,
  /// nothing held and elastic ones not counted (see docs/algorithms.md): a lower count with nothing
  /// held means special marker positions.
  int theoretical_count = 0;
};

/// What of an error of a dropped parameter shows up in a kept one.
struct Share {
  int parameter;       ///< index into the model's parameters
  double coefficient;  ///< units of the kept parameter per unit of the dropped one
};

/// Shares of the kept parameters in a dropped one, an index into `base.dropped`; ascending by
/// parameter, without those that are rounding (below 1e-9 by absolute value).
std::vector<Share> RegroupedInto(const BaseParameters& base, int dropped);

/// Factor (see regressor.hpp) of the regressor over random postures at nominal geometry.
Eigen::MatrixXd NominalFactor(const ErrorModel& model, const IdentifiabilityOptions& options);

/// Finds the base parameters by QR without pivoting over random postures (section 2.1). The paper's
/// priority among joint parameters: theta, then r, d and b, then alpha, beta and gamma.
BaseParameters FindBaseParameters(const ErrorModel& model, const IdentifiabilityOptions& options);

/// The same from a factor that is there already: for other holds or another priority.
BaseParameters FindBaseParameters(const ErrorModel& model, const Eigen::MatrixXd& factor,
                                  const IdentifiabilityOptions& options);

/// Parameters that would be identifiable with generic marker positions but are not with the given
/// ones: found by repeating the decision with the markers moved. Empty when the count is the
/// theoretical one.
std::vector<int> LostBySpecialMarkers(const ErrorModel& model,
                                      const IdentifiabilityOptions& options);

}  // namespace elastocal
