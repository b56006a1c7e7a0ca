// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/torque_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "elastocal/calibration/static_torques.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastSpread = 5.0;  // N.m or N: standard deviation of static torques ...
constexpr double kLever = 0.02;  // m: ... or lever by which the carried weight may be displaced
constexpr double kLeastReversed = 1.0;   // instead of 5, where sensors follow statics reversed
constexpr double kLeverReversed = 5e-3;  // instead of 20 mm, where at least ten postures show it
// Sd of the slope of a sensor with less variation, in at least ...
constexpr double kCertainSlopeSd = 0.1;
constexpr std::size_t kManyPairs = 10;  // ... this number of postures
constexpr double kNoSlope = 0.2;
constexpr double kLeastBias = 10.0;       // N.m or N
constexpr double kLeastBiasShare = 0.25;  // share of the largest static torque
constexpr double kLeastSlope = 0.5;
constexpr double kMostSlope = 2.0;
constexpr double kLeastCorrelation = 0.5;
constexpr std::size_t kLeastPairs = 5;
constexpr double kLeftOfExchange = 0.25;  // share of the squares
constexpr double kLeftOfReversal = 0.25;  // share of the squares of all sensors
constexpr std::size_t kManySensors = 3;   // number of sensors that are wrong in the same way
constexpr double kLeastCommon = 1.5;      // factor of all sensors, or its inverse
constexpr double kLeastAlone = 1.5;       // the same for one sensor among others that are right
constexpr double kAlike = 1.25;           // ratio of a sensor's slope to the common one
constexpr double kFollows = 0.9;          // correlation from which a sensor's slope counts

/// Line of measured over static torques, where these vary enough.
struct TorqueLine {
  double slope = 0.0, correlation = 0.0;
};

std::optional<TorqueLine> FitLine(const TorquePairs& pairs) {
  if (pairs.expected.size() < kLeastPairs) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(pairs.expected.size());
  const Eigen::Map<const Eigen::ArrayXd> expected(pairs.expected.data(), count);
  const Eigen::Map<const Eigen::ArrayXd> measured(pairs.measured.data(), count);
  const Eigen::ArrayXd x = expected - expected.mean();
  const Eigen::ArrayXd y = measured - measured.mean();
  const double spread = std::sqrt(x.square().mean());
  const double norm = std::sqrt(x.square().sum() * y.square().sum());
  const TorqueLine line{.slope = (x * y).sum() / x.square().sum(),
                        .correlation = norm > 0.0 ? (x * y).sum() / norm : 0.0};
  // Neither masses nor friction reverse torques, nor does a displaced weight, which adds a constant
  // or something unrelated to statics. But where large loads nearly balance each other, the
  // remaining static torque may be entirely wrong.
  const bool follows_reversed = line.correlation < -kFollows;
  const bool reversed = follows_reversed && pairs.expected.size() >= kManyPairs &&
                        line.slope < -kLeastSlope && line.slope > -kMostSlope;
  const double least = follows_reversed ? kLeastReversed : kLeastSpread;
  const double uncertain = (reversed ? kLeverReversed : kLever) * pairs.weight;
  if (!(spread >= std::max(least, uncertain))) return std::nullopt;
  return line;
}

bool IsWithin(double ratio, double most) { return ratio < most && ratio * most > 1.0; }

/// Line of each joint whose sensor follows statics.
std::vector<std::optional<TorqueLine>> FollowingLines(const std::vector<TorquePairs>& pairs) {
  std::vector<std::optional<TorqueLine>> lines;
  for (const TorquePairs& of : pairs) {
    lines.push_back(FitLine(of));
    if (lines.back() && !(lines.back()->correlation > kFollows)) lines.back().reset();
  }
  return lines;
}

/// The nearest joint towards the root whose sensor follows statics; -1: none.
int NextTowardsRoot(const RobotTree& tree, const std::vector<std::optional<TorqueLine>>& lines,
                    int joint) {
  do {
    joint = tree.joints[joint].parent_body - 1;  // joint k carries body k + 1
  } while (joint >= 0 && !lines[joint]);
  return joint;
}

/// Whether a joint's sensor has a factor that its neighbours on the limb do not have. They carry
/// much of the same load, so that a wrong mass would show in them, too.
bool IsScaledAlone(const RobotTree& tree, const std::vector<std::optional<TorqueLine>>& lines,
                   int joint) {
  if (!lines[joint] || IsWithin(lines[joint]->slope, kLeastAlone)) return false;
  bool any = false;
  for (int other = 0; other < static_cast<int>(lines.size()); ++other) {
    const bool beside = lines[other] && (other == NextTowardsRoot(tree, lines, joint) ||
                                         joint == NextTowardsRoot(tree, lines, other));
    if (!beside) continue;
    const double ratio = lines[joint]->slope / lines[other]->slope;
    if (!IsWithin(lines[other]->slope, kLeastAlone) || IsWithin(ratio, kLeastAlone)) return false;
    any = true;
  }
  return any;
}

/// Judges a joint whose load varies too little for the usual rules, if the scatter about its line
/// determines the slope to a tenth: its torques are reversed, or do not follow statics at all.
/// Nothing: they may follow.
std::optional<TorqueContradiction> CertainContradiction(const TorquePairs& pairs) {
  const auto count = static_cast<Eigen::Index>(pairs.expected.size());
  if (pairs.expected.size() < kManyPairs) return std::nullopt;
  const Eigen::Map<const Eigen::ArrayXd> expected(pairs.expected.data(), count);
  const Eigen::Map<const Eigen::ArrayXd> measured(pairs.measured.data(), count);
  const Eigen::ArrayXd x = expected - expected.mean();
  const Eigen::ArrayXd y = measured - measured.mean();
  const double squares = x.square().sum();
  if (!(std::sqrt(x.square().mean()) >= kLever * pairs.weight) || squares == 0.0)
    return std::nullopt;
  const double slope = (x * y).sum() / squares;
  const double scatter = (y - slope * x).square().sum() / static_cast<double>(count - 2);
  if (!(scatter < kCertainSlopeSd * kCertainSlopeSd * squares)) return std::nullopt;
  if (slope < -kLeastSlope) return TorqueContradiction::kReversed;
  if (std::abs(slope) < kNoSlope) return TorqueContradiction::kUnrelated;
  return std::nullopt;
}

std::optional<ContradictoryTorque> Judge(int joint, const TorquePairs& pairs,
                                         bool is_scaled_alone) {
  const auto count = static_cast<Eigen::Index>(pairs.expected.size());
  if (pairs.expected.size() < kLeastPairs) return std::nullopt;
  const Eigen::Map<const Eigen::ArrayXd> expected(pairs.expected.data(), count);
  const Eigen::Map<const Eigen::ArrayXd> measured(pairs.measured.data(), count);
  ContradictoryTorque found{.joint = joint, .bias = (measured - expected).mean()};
  const double uncertain = kLever * pairs.weight;
  if (const auto line = FitLine(pairs)) {
    found.slope = line->slope;
    if (line->correlation < -kLeastCorrelation) {
      found.kind = TorqueContradiction::kReversed;
      return found;
    }
    if (line->correlation < kLeastCorrelation) return found;  // kUnrelated, the default
    if (found.slope < kLeastSlope || found.slope > kMostSlope || is_scaled_alone) {
      found.kind = TorqueContradiction::kScaled;
      return found;
    }
  } else if (const auto kind = CertainContradiction(pairs)) {
    found.kind = *kind;
    return found;
  }
  const double largest = expected.abs().maxCoeff();
  if (std::abs(found.bias) < std::max({kLeastBias, kLeastBiasShare * largest, uncertain}))
    return std::nullopt;
  found.kind = TorqueContradiction::kBiased;
  return found;
}

/// Residuals of the measured torques of one joint with the static torques of another, in the
/// postures of both, without the means: sum of squares; also with the first joint's own static
/// torques.
struct SensorFit {
  double squares = 0.0, own = 0.0;
  double reversed = 0.0;  ///< with its own static torques of opposite sign
  Eigen::Index count = 0;
};

SensorFit Beside(const TorquePairs& measured, const TorquePairs& expected) {
  std::vector<double> m, e, own;
  for (std::size_t i = 0, j = 0; i < measured.posture.size() && j < expected.posture.size();) {
    if (measured.posture[i] == expected.posture[j]) {
      m.push_back(measured.measured[i]);
      own.push_back(measured.expected[i++]);
      e.push_back(expected.expected[j++]);
    } else if (measured.posture[i] < expected.posture[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  const auto count = static_cast<Eigen::Index>(m.size());
  if (count == 0) return {};
  const auto centred = [&](const std::vector<double>& values) -> Eigen::ArrayXd {
    const Eigen::Map<const Eigen::ArrayXd> all(values.data(), count);
    return all - all.mean();
  };
  return {(centred(m) - centred(e)).square().sum(), (centred(m) - centred(own)).square().sum(),
          (centred(m) + centred(own)).square().sum(), count};
}

/// Whether the sensors of two joints are exchanged. Joints of one limb carry a similar load: two
/// reversed sensors may follow each other's statics better than their own, but follow their own
/// reversed best.
bool AreExchanged(const TorquePairs& a, const TorquePairs& b) {
  const SensorFit with_b = Beside(a, b);
  const SensorFit with_a = Beside(b, a);
  if (static_cast<std::size_t>(with_b.count) < kLeastPairs) return false;
  const double left = with_b.squares + with_a.squares;
  const double own = with_b.own + with_a.own;
  const double least = 2.0 * kLeastSpread * kLeastSpread * static_cast<double>(with_b.count);
  const double reversed = with_b.reversed + with_a.reversed;
  return own > least && left < kLeftOfExchange * own && left < reversed;
}

/// Whether all sensors together have the opposite sign of statics.
bool AllReversed(const std::vector<TorquePairs>& pairs) {
  double as_is = 0.0, reversed = 0.0;
  std::size_t sensors = 0;
  for (const TorquePairs& of : pairs) {
    if (of.posture.size() >= kLeastPairs) ++sensors;
    for (std::size_t i = 0; i < of.measured.size(); ++i) {
      as_is += std::pow(of.measured[i] - of.expected[i], 2);
      reversed += std::pow(of.measured[i] + of.expected[i], 2);
    }
  }
  return sensors >= kManySensors && reversed < kLeftOfReversal * as_is;
}

/// The factor that most sensors have in common, if it is far from one: masses of links are not off
/// by that much.
std::optional<double> CommonFactor(const std::vector<std::optional<TorqueLine>>& lines) {
  std::vector<double> slopes;
  for (const auto& line : lines) {
    if (line) slopes.push_back(line->slope);
  }
  if (slopes.size() < kManySensors) return std::nullopt;
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  const double factor = *middle;
  if (IsWithin(factor, kLeastCommon)) return std::nullopt;
  const auto alike = std::count_if(slopes.begin(), slopes.end(),
                                   [&](double slope) { return IsWithin(slope / factor, kAlike); });
  if (4 * alike < 3 * std::ssize(slopes)) return std::nullopt;
  return factor;
}

}  // namespace

std::vector<ContradictoryTorque> FindContradictoryTorques(const ErrorModel& model,
                                                          const Recording& recording,
                                                          double slip_m) {
  if (recording.trials.empty() || recording.torques.rows() == 0) return {};
  if (!(TotalMass(model.tree) > 0.0)) return {};
  const std::vector<TorquePairs> pairs =
      PairTorques(model, recording, RegisterPlacement(model, recording, slip_m));
  const std::size_t joints = pairs.size();
  std::vector<ContradictoryTorque> found;
  const auto all_are = [&](TorqueContradiction kind, double slope) {
    for (std::size_t k = 0; k < joints; ++k) {
      if (pairs[k].measured.empty()) continue;
      found.push_back({.joint = static_cast<int>(k), .kind = kind, .slope = slope});
    }
    return found;
  };
  if (AllReversed(pairs)) return all_are(TorqueContradiction::kReversed, -1.0);
  const std::vector<std::optional<TorqueLine>> lines = FollowingLines(pairs);
  if (const auto factor = CommonFactor(lines))
    return all_are(TorqueContradiction::kScaled, *factor);
  std::vector<char> exchanged(joints, 0);
  for (std::size_t a = 0; a < joints; ++a) {
    for (std::size_t b = a + 1; b < joints; ++b) {
      if (exchanged[a] != 0 || exchanged[b] != 0 || !AreExchanged(pairs[a], pairs[b])) continue;
      exchanged[a] = exchanged[b] = 1;
      for (const auto& [joint, other] : {std::pair(a, b), std::pair(b, a)}) {
        found.push_back({.joint = static_cast<int>(joint),
                         .kind = TorqueContradiction::kExchanged,
                         .other = static_cast<int>(other)});
      }
    }
  }
  for (int k = 0; k < static_cast<int>(joints); ++k) {
    if (exchanged[k] != 0) continue;
    const bool scaled = IsScaledAlone(model.tree, lines, k);
    if (const auto one = Judge(k, pairs[k], scaled)) found.push_back(*one);
  }
  return found;
}

std::string Describe(const ContradictoryTorque& found, const RobotTree& tree) {
  char text[120];
  switch (found.kind) {
    case TorqueContradiction::kReversed:
      std::snprintf(text, sizeof text, "have the opposite sign of those of statics");
      break;
    case TorqueContradiction::kScaled:
      std::snprintf(text, sizeof text, "are %.3g times those of statics", found.slope);
      break;
    case TorqueContradiction::kBiased:
      std::snprintf(text, sizeof text, "are off by %.3g from those of statics", found.bias);
      break;
    case TorqueContradiction::kUnrelated:
      std::snprintf(text, sizeof text, "do not follow those of statics");
      break;
    case TorqueContradiction::kExchanged:
      return tree.joints[found.joint].name + ": its torques are exchanged with those of " +
             tree.joints[found.other].name;
  }
  return tree.joints[found.joint].name + ": its torques " + text;
}

void HideTorques(const std::vector<ContradictoryTorque>& found, Recording& recording) {
  for (const ContradictoryTorque& one : found) {
    if (recording.torques.rows() == 0) continue;
    recording.torques.col(one.joint).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace elastocal
