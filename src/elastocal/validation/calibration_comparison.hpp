#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

struct ComparisonOptions {
  /// Chance that any joint of a robot that did not change is called moved all the same.
  double level = 0.05;
};

/// A common quantity in both calibrations, rad, m or whatever its unit says.
struct ParameterDifference {
  std::string name, joint, unit;
  double a = 0.0, b = 0.0;
  double difference = 0.0;          ///< b - a
  double sd = 0.0;                  ///< of the difference
  double degrees_of_freedom = 0.0;  ///< of Student's t for it; infinite: normal
  double half_width = 0.0;          ///< of its 95 % interval, for this parameter alone
  double p = 1.0;                   ///< chance of a difference as large without a change
  std::map<std::string, double> stands_for = {};  ///< see CommonParameter
  /// Parameters of A and B with their weights where it is a combination; else empty.
  std::map<std::string, double> weights_a = {}, weights_b = {};

  bool significant() const { return p < 0.05; }
};

struct JointDifference {
  std::string joint;
  std::vector<int> parameters;  ///< indices into CalibrationComparison::parameters, by p
  DifferenceTest test;
  double p_adjusted = 1.0;  ///< Holm: at or below the level, the joint has moved
  bool moved = false;
};

struct CalibrationComparison {
  std::vector<JointDifference> joints;          ///< the most significant first
  std::vector<ParameterDifference> parameters;  ///< in the order of B
  DifferenceTest overall;                       ///< of all parameters together
  bool changed = false;  ///< some joint has moved, or overall.p is at or below the level
  /// Only where something changed and no joint could be singled out: the joints of which any one
  /// alone, moved, would explain all differences.
  std::vector<std::string> suspects;
  bool with_covariance = false;  ///< whether both covariances were known
  std::vector<NotCompared> not_compared;
  std::vector<std::string> warnings;
};

/// Compares two calibrations of one robot, A and B (paper section 6.1.3, Fig. 7): which joints
/// moved by more than the uncertainty of both.
///
/// **Uncertainty of a difference.** Both estimates are posterior means under a prior around
/// nominal, with posterior covariances S_a and S_b, and the difference is given S_a + S_b.
/// - If the robot before and after are two draws from the prior, that is exactly the posterior
///   covariance of the change. It counts that estimates are pulled towards nominal in directions
///   that the recordings excite badly, so that the change of one joint does not show up as a
///   significant change of another with which it can be confused.
/// - If nothing changed, both are pulled by the same prior P, and the difference scatters with
///   S_a + S_b - S_a P^-1 S_b - S_b P^-1 S_a only, which is less in the mean. So the level is kept,
///   with some to spare where parameters lean on the prior; where the data rule, both agree.
/// The price is power: a change in a badly excited direction is estimated too small, and its
/// interval says so. Errors of the two recordings must be independent.
///
/// **A joint** is tested by all its common quantities together (marginally: whatever else may have
/// moved), by Fisher's F with their number and the degrees of freedom of the noise (Welch and
/// Satterthwaite for two different noises, from the files' interval factors). **Over the joints**
/// Holm's step-down keeps the chance of any false alarm at the level, whatever their correlation.
/// Without covariance of both, a joint's p is the smallest of its parameters' times their number
/// (Bonferroni), and combinations are not compared.
///
/// The uncertainty is that of noise. What neither model has (elasticity, say) makes two recordings
/// of other postures differ by more.
///
/// Two joints that a recording can hardly tell apart may both be insignificant though something
/// changed. Then the test of everything together finds it, and `suspects` are named instead.
///
/// Throws InputError: other nominal robots; nothing in common; a covariance that does not fit.
CalibrationComparison CompareCalibrations(const CalibrationEstimate& a,
                                          const CalibrationEstimate& b,
                                          const ComparisonOptions& options);

}  // namespace elastocal
