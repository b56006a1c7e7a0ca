// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/camera_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/math/dense.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastScale = 3e-3;
constexpr double kFalseAlarm = 1e-3;  // probability that a clean recording is accused
// Smallest width of the lengths' scatter, relative to the prior, where many lengths determine the
// width and where some do. Fewer lengths do not determine it.
constexpr double kNarrowestPrior = 0.6, kNarrowestOfSome = 0.4;
constexpr Eigen::Index kManyLengths = 20;
constexpr double kSomeLengths = 8.0;  // number of lengths that the recording determines
constexpr int kRounds = 10;
constexpr int kFewestLengths = 4;
constexpr double kLeastLength = 0.02;  // m: shorter lengths tell nothing about a scale

/// Change of a length of a joint by a displacement `move` of the joint, m. For a general joint the
/// displacement is in its constant frame, in which r, d and b have the directions -y, x and z.
double GeneralLength(const Eigen::Vector3d& move, ParameterKind kind) {
  if (kind == ParameterKind::kR) return -move.y();
  if (kind == ParameterKind::kD) return move.x();
  return move.z();
}

/// Change of a length of a joint if the whole robot is larger by a factor of one (doubled), m.
double NominalLength(const JointPlacement& placement, ParameterKind kind) {
  const Transform& T = placement.T_parent_pre;
  if (placement.general) return GeneralLength(T.linear().transpose() * T.translation(), kind);
  if (kind == ParameterKind::kR) return placement.r;
  return kind == ParameterKind::kD ? placement.d : placement.b;
}

/// Changes of the lengths when the common normal between a joint's axis and the axis that continues
/// the chain is displaced by one along both. The frame of the first joint moves with the normal,
/// and all that the joint carries has to be moved back. `lengths` holds indices of the model's
/// parameters.
Eigen::VectorXd ShiftOfNormal(const ErrorModel& model, const std::vector<int>& lengths, int joint,
                              int next) {
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lengths.size()));
  for (Eigen::Index i = 0; i < shift.size(); ++i) {
    const Parameter& length = model.parameters[Size(lengths[Size(i)])];
    const JointPlacement& placement = model.placements[Size(length.joint)];
    if (length.joint == joint && length.kind == ParameterKind::kR) shift[i] = 1.0;
    if (model.tree.joints[Size(length.joint)].parent_body != joint + 1) continue;
    if (placement.general) {
      const Eigen::Vector3d along = placement.T_parent_pre.linear().row(2).transpose();
      shift[i] = GeneralLength(-along, length.kind);
    } else if (length.joint == next && length.kind == ParameterKind::kR) {
      shift[i] = -std::cos(placement.alpha);
    }
  }
  return shift;
}

/// Covariance of the lengths' single errors in addition to independent errors of one variance, in
/// units of that variance. The common normal of two axes at a small angle is far away, and errors
/// of the axes' positions and directions move it along both axes the more, the smaller the angle
/// is.
Eigen::MatrixXd ShiftsOfNormals(const ErrorModel& model, const std::vector<int>& lengths,
                                const Eigen::VectorXd& prior_sd) {
  const auto count = static_cast<Eigen::Index>(lengths.size());
  Eigen::MatrixXd shifts = Eigen::MatrixXd::Zero(count, count);
  const double unit = prior_sd[lengths.front()];  // the prior is the same for all lengths
  for (std::size_t p = 0; p < model.parameters.size(); ++p) {
    const Parameter& twist = model.parameters[p];
    if (twist.kind != ParameterKind::kAlpha || twist.joint < 0) continue;
    const JointPlacement& placement = model.placements[Size(twist.joint)];
    const int before = model.tree.joints[Size(twist.joint)].parent_body - 1;
    if (placement.general || placement.parallel || before < 0) continue;
    const Eigen::VectorXd shift = ShiftOfNormal(model, lengths, before, twist.joint);
    const double away = std::hypot(model.placements[Size(before)].r, placement.r);
    const double turned = prior_sd[static_cast<Eigen::Index>(p)] * away / unit;
    const double amplified = std::pow(std::tan(placement.alpha), -2);
    shifts += (1.0 + turned * turned) * amplified * shift * shift.transpose();
  }
  return shifts;
}

/// Information of the data about the joints' lengths, in units of their prior, after all other
/// parameters are eliminated.
struct KnownLengths {
  std::vector<int> parameters;  ///< indices in the model
  Eigen::MatrixXd information;  ///< of the data alone, as is `b`
  Eigen::VectorXd b;            ///< information times the estimate
  Eigen::VectorXd pattern;  ///< changes of the lengths if the robot is larger by a factor of one
};

/// Nothing where too few lengths could determine a scale.
std::optional<KnownLengths> LengthsOf(const CalibrationResult& result) {
  const ErrorModel& model = result.model;
  const std::vector<int>& fitted = result.posterior.parameters;
  const auto count = static_cast<Eigen::Index>(fitted.size());
  const Eigen::VectorXd unit = result.prior_sd(fitted);
  KnownLengths known;
  std::vector<double> pattern;
  std::vector<Eigen::Index> lengths, others;
  int told = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = model.parameters[Size(fitted[Size(i)])];
    if (parameter.joint < 0 || GroupOf(parameter.kind) != PriorGroup::kLengths) {
      others.push_back(i);
      continue;
    }
    lengths.push_back(i);
    known.parameters.push_back(fitted[Size(i)]);
    const double length = NominalLength(model.placements[Size(parameter.joint)], parameter.kind);
    pattern.push_back(length / unit[i]);
    told += std::abs(length) > kLeastLength ? 1 : 0;
  }
  if (told < kFewestLengths) return std::nullopt;
  known.pattern = Eigen::Map<const Eigen::VectorXd>(pattern.data(), std::ssize(pattern));
  const Eigen::VectorXd x = result.delta(fitted).cwiseQuotient(unit);
  Eigen::MatrixXd A = unit.asDiagonal() * result.posterior.data_information * unit.asDiagonal();
  const Eigen::VectorXd b = A * x + x;  // of the data alone
  // All parameters but the lengths keep their own prior, whatever that of the lengths is, and are
  // eliminated.
  A.diagonal() += Eigen::VectorXd::Ones(count);
  const Eigen::MatrixXd across = A(others, lengths);
  Eigen::MatrixXd both(across.rows(), across.cols() + 1);
  both << across, b(others);
  const Eigen::MatrixXd eliminated =
      across.transpose() * SolvePositive(Eigen::MatrixXd(A(others, others)), both);
  known.information = A(lengths, lengths);
  known.information.diagonal().array() -= 1.0;
  known.information -= eliminated.leftCols(across.cols());
  known.b = b(lengths) - eliminated.rightCols<1>();
  return known;
}

/// Estimates the scale together with the width of the lengths' prior. (The prior was widened with
/// the pattern in it; small robots and industrial arms are made more exactly than it expects.)
/// `first` is the width of the prior before it was widened; `own_weight` is the weight of the prior
/// for a width of one. Nothing where the lengths do not determine a scale.
std::optional<CommonScale> ScaleBeside(const KnownLengths& lengths,
                                       const Eigen::MatrixXd& own_weight, double first) {
  const Eigen::Index count = lengths.pattern.size();
  double width = first;
  CommonScale scale;
  for (int round = 0; round < kRounds; ++round) {
    const double weight = 1.0 / (width * width);
    const Eigen::MatrixXd information = lengths.information + weight * own_weight;
    const Eigen::MatrixXd covariance = InverseOfPositive(information);
    const Eigen::VectorXd pull = weight * (own_weight * lengths.pattern);
    const double known = pull.dot(lengths.pattern) - pull.dot(covariance * pull);
    if (!(known > 0.0)) return std::nullopt;
    scale.size = pull.dot(covariance * lengths.b) / known;
    scale.sd = 1.0 / std::sqrt(known);
    const Eigen::VectorXd own =
        covariance * (lengths.b + scale.size * pull) - scale.size * lengths.pattern;
    const double squares = weight * own.dot(own_weight * own);
    const double determined =
        static_cast<double>(count) - weight * own_weight.cwiseProduct(covariance).sum();
    scale.degrees_of_freedom = std::max(1.0, determined);
    if (determined < 1.0) break;
    double narrowest = count >= kManyLengths ? kNarrowestPrior * first : first;
    if (count < kManyLengths && determined >= kSomeLengths) {
      narrowest = kNarrowestOfSome * first;
      scale.degrees_of_freedom -= 1.0;  // one is the scale's own
    }
    width = std::max(narrowest, width * std::sqrt(squares / determined));
  }
  return scale;
}

/// Estimates the scale where one of the lengths may have any error (-1: none). Nothing where the
/// lengths do not determine a scale.
std::optional<CommonScale> ScaleWithFree(Eigen::Index free, const KnownLengths& lengths,
                                         const CalibrationResult& result) {
  constexpr double kAnyError = 1e4;  // variance, in units of the prior's
  const Eigen::Index count = lengths.pattern.size();
  Eigen::MatrixXd own = Eigen::MatrixXd::Identity(count, count) +
                        ShiftsOfNormals(result.model, lengths.parameters, result.prior_sd);
  if (free >= 0) own(free, free) += kAnyError;
  return ScaleBeside(lengths, InverseOfPositive(own),
                     1.0 / result.prior_scale[PriorGroup::kLengths]);
}

/// Whether a clean recording hardly ever has such a scale.
bool IsOfNoRobot(const CommonScale& scale) {
  return std::abs(scale.size) > kLeastScale &&
         StudentTwoSidedTail(scale.size / scale.sd, scale.degrees_of_freedom) < kFalseAlarm;
}

/// Whether a single length is off, not all: if it may have any error, the others tell plainly
/// another scale, which a robot may have. The three largest errors are tried.
bool IsOfOneLength(const CommonScale& scale, const KnownLengths& lengths,
                   const CalibrationResult& result) {
  constexpr double kPlainly = 2.0;  // standard deviations
  constexpr std::size_t kMostTried = 3;
  std::vector<Eigen::Index> order(lengths.parameters.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, std::greater(), [&](Eigen::Index i) {
    return std::abs(result.delta[lengths.parameters[Size(i)]]);
  });
  order.resize(std::min(order.size(), kMostTried));
  return std::ranges::any_of(order, [&](Eigen::Index i) {
    const auto others = ScaleWithFree(i, lengths, result);
    return others && !IsOfNoRobot(*others) &&
           std::abs(others->size - scale.size) > kPlainly * others->sd;
  });
}

}  // namespace

std::optional<CommonScale> EstimateCommonScale(const CalibrationResult& result,
                                               const CalibrationOptions& options) {
  if (KnowsRobot(options.earlier)) return std::nullopt;
  const std::optional<KnownLengths> lengths = LengthsOf(result);
  if (!lengths) return std::nullopt;
  std::optional<CommonScale> scale = ScaleWithFree(-1, *lengths, result);
  if (scale && IsOfNoRobot(*scale)) {
    scale->of_one_length = IsOfOneLength(*scale, *lengths, result);
  }
  return scale;
}

std::pair<double, double> CompatibleScales(const CommonScale& scale) {
  const double width = StudentQuantile(0.975, scale.degrees_of_freedom) * scale.sd;
  return {scale.size - width, scale.size + width};
}

bool IsDoubtful(const CommonScale& scale) {
  constexpr double kOneInFifty = 0.02;
  return std::abs(scale.size) > kLeastScale && !scale.of_one_length &&
         StudentTwoSidedTail(scale.size / scale.sd, scale.degrees_of_freedom) < kOneInFifty;
}

std::string DescribeDoubt(const CommonScale& scale) {
  char text[400];
  std::snprintf(
      text, sizeof text,
      "the cameras' positions may be %.4f +- %.4f times the true ones in all trials: all lengths "
      "of "
      "the robot are off by as much, which is not certain enough to object to (one robot in fifty "
      "is of such a size); a bar of known length beside the robot tells "
      "(recording.reference_lengths)",
      1.0 + scale.size, scale.sd);
  return text;
}

std::optional<CommonScale> FindWrongScale(const CalibrationResult& result,
                                          const CalibrationOptions& options) {
  const auto scale = EstimateCommonScale(result, options);
  return scale && !scale->of_one_length && IsOfNoRobot(*scale) ? scale : std::nullopt;
}

std::string Describe(const CommonScale& scale) {
  char text[400];
  std::snprintf(
      text, sizeof text,
      "the cameras' positions seem %.4f +- %.4f times the true ones in all trials, since all "
      "lengths of the robot are off by as much: calibrate the cameras again with the right "
      "wand, or describe the robot with its own size (--accept scale=%.5f corrects it)",
      1.0 + scale.size, scale.sd, 1.0 + scale.size);
  return text;
}

}  // namespace elastocal
