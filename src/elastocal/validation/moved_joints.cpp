// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/moved_joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/zero_offset.hpp"
#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/data_information.hpp"

namespace elastocal {
namespace {

// Times the prior: changes may be larger than errors of a new robot.
constexpr double kTimesPrior = 2.0;
/// Combinations of parameters count as told from this ratio on: expected change over its sd by the
/// data.
constexpr double kLeastTold = 1.0;
constexpr double kKnownFreedom = 1e6;
/// Logarithm of the odds against a move before the data: in one of four checks something has moved.
const double kOddsAgainst = std::log(3.0);
/// Factors on the covariance of the earlier calibration that are tried.
constexpr double kWidenings[] = {1.0, 2.0, 4.0, 8.0, 16.0};

struct Quantity {
  std::string name;
  ParameterUnit unit;
  bool offset = false;
  int position = 0;   // index among the unknowns
  double size = 0.0;  // standard deviation of a change, in units of the unknown
};

struct Candidate {
  std::string joint;
  std::vector<Quantity> quantities;
};

/// What the given quantities explain if they may change.
struct Explanation {
  double squares = 0.0;  // chi-squared of the combinations that are told
  int told = 0;
  double evidence = 0.0;  // logarithm of p(s | changed) over p(s | nothing changed)
  Eigen::VectorXd change;
  Eigen::MatrixXd covariance;  // covariance of `change`
  // For a single quantity: expected size of a change, and standard deviation by the data.
  double size = 0.0, sd = 0.0;
};

/// What the data say about changes. All in units of `unit_`.
class Evidence {
 public:
  Evidence(const CalibrationResult& estimate, const DataInformation& data,
           const EarlierEstimate& earlier, const Eigen::VectorXd& size_of_changes)
      : parameters_(data.parameters), unit_(data.unit), information_(data.information) {
    const Eigen::VectorXd mean = MeanBefore(estimate, data, earlier);
    prior_ = CovarianceBefore(estimate, data, earlier);
    score_ = data.vector - data.information * mean;
    unchanged_ = LogEvidence(data, mean, prior_);
    FindCandidates(estimate.model, earlier, size_of_changes);
    Update();
  }

  const std::vector<Candidate>& candidates() const { return candidates_; }
  /// Logarithm of p(s | nothing changed), without a constant of the data.
  double unchanged() const { return unchanged_; }

  /// The same under the condition that these joints may have changed.
  Evidence Beside(const std::vector<std::string>& joints) const {
    Evidence other = *this;
    for (const Candidate& candidate : candidates_) {
      if (std::ranges::count(joints, candidate.joint) > 0) Widen(candidate, other.prior_);
    }
    if (!joints.empty()) other.Update();
    return other;
  }

  Explanation Explain(const std::vector<Quantity>& quantities) const {
    std::vector<int> at;
    Eigen::VectorXd size(static_cast<Eigen::Index>(quantities.size()));
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      at.push_back(quantities[i].position);
      size[static_cast<Eigen::Index>(i)] = quantities[i].size;
    }
    const Eigen::MatrixXd M = size.asDiagonal() * left_(at, at) * size.asDiagonal();
    const Eigen::VectorXd t = size.cwiseProduct(left_score_(at));
    const SymmetricDecomposition eigen = DecomposeSymmetric(M);
    const Eigen::VectorXd z = eigen.vectors.transpose() * t;
    Explanation result;
    Eigen::VectorXd factor(z.size());
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const double told = std::max(0.0, eigen.values[i]);
      factor[i] = 1.0 / (1.0 + told);
      result.evidence += 0.5 * (z[i] * z[i] * factor[i] - std::log1p(told));
      if (told < kLeastTold) continue;
      ++result.told;
      result.squares += z[i] * z[i] / told;
    }
    Eigen::VectorXd unit = size;
    for (std::size_t i = 0; i < at.size(); ++i) unit[static_cast<Eigen::Index>(i)] *= unit_[at[i]];
    result.size = unit[0];
    result.sd = eigen.values[0] > 0.0 ? unit[0] / std::sqrt(eigen.values[0])
                                      : std::numeric_limits<double>::infinity();
    const Eigen::MatrixXd back = unit.asDiagonal() * eigen.vectors;
    result.change = back * factor.cwiseProduct(z);
    result.covariance = back * factor.asDiagonal() * back.transpose();
    return result;
  }

 private:
  void FindCandidates(const ErrorModel& model, const EarlierEstimate& earlier,
                      const Eigen::VectorXd& size_of_changes) {
    std::map<std::string, double> sizes;
    for (std::size_t i = 0; i < earlier.names.size(); ++i) {
      sizes[earlier.names[i]] = size_of_changes[static_cast<Eigen::Index>(i)];
    }
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const Parameter& parameter = model.parameters[parameters_[i]];
      const auto size = sizes.find(parameter.name);
      if (size == sizes.end() || size->second <= 0.0) continue;
      const std::string joint = OwnerName(parameter.name);
      auto candidate = std::find_if(candidates_.begin(), candidates_.end(),
                                    [&](const Candidate& one) { return one.joint == joint; });
      if (candidate == candidates_.end()) {
        candidate = candidates_.insert(candidate, {.joint = joint, .quantities = {}});
      }
      candidate->quantities.push_back({parameter.name, parameter.unit,
                                       IsZeroOffset(parameter, model.tree), static_cast<int>(i),
                                       size->second / unit_[static_cast<Eigen::Index>(i)]});
    }
  }

  static void Widen(const Candidate& candidate, Eigen::MatrixXd& prior) {
    for (const Quantity& one : candidate.quantities) {
      prior(one.position, one.position) += one.size * one.size;
    }
  }

  /// Removes from information and score what the prior leaves open.
  void Update() {
    const Eigen::MatrixXd covariance =
        InverseOfInformation(information_ + InverseOfInformation(prior_));
    const Eigen::MatrixXd open = information_ * covariance;
    left_ = information_ - open * information_;
    left_score_ = score_ - open * score_;
  }

  std::vector<int> parameters_;  // indices in the model
  Eigen::VectorXd unit_, score_, left_score_;
  Eigen::MatrixXd information_, prior_, left_;
  std::vector<Candidate> candidates_;
  double unchanged_ = 0.0;
};

/// Logarithm of the mean of two numbers that are given by their logarithms.
double LogMean(double a, double b) {
  const double most = std::max(a, b);
  return most + std::log(0.5 * std::exp(a - most) + 0.5 * std::exp(b - most));
}

DifferenceTest TestOf(const Explanation& explanation, double freedom) {
  DifferenceTest test{.parameters = explanation.told, .degrees_of_freedom = freedom};
  if (explanation.told == 0) return test;
  test.statistic = explanation.squares / explanation.told;
  test.p = FisherUpperTail(test.statistic, explanation.told, freedom);
  return test;
}

/// Judges a joint by a change of its zero alone and by a change of all its parameters.
JointSuspect Judge(const Evidence& evidence, const Candidate& candidate, double freedom) {
  Candidate offset{.joint = candidate.joint, .quantities = {}};
  std::copy_if(candidate.quantities.begin(), candidate.quantities.end(),
               std::back_inserter(offset.quantities),
               [](const Quantity& one) { return one.offset; });
  JointSuspect suspect{.joint = candidate.joint, .test = {}, .changes = {}};
  Explanation best = evidence.Explain(candidate.quantities);
  suspect.test = TestOf(best, freedom);
  suspect.log_evidence = best.evidence;
  if (!offset.quantities.empty()) {
    const Explanation zero = evidence.Explain(offset.quantities);
    const DifferenceTest test = TestOf(zero, freedom);
    suspect.zero_told = zero.told > 0;
    suspect.zero_is_length = offset.quantities.front().unit == ParameterUnit::kMetre;
    suspect.smallest_seen = SmallestChange(zero.sd, zero.size, evidence.candidates().size());
    suspect.zero_alone = zero.evidence >= best.evidence;
    if (offset.quantities.size() < candidate.quantities.size()) {
      if (test.p < suspect.test.p) suspect.test = test;
      suspect.test.p = std::min(1.0, 2.0 * suspect.test.p);  // the smaller of two p values
      suspect.log_evidence = LogMean(zero.evidence, best.evidence);
    }
    if (suspect.zero_alone) best = zero;
  }
  const std::vector<Quantity>& changed =
      suspect.zero_alone ? offset.quantities : candidate.quantities;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    suspect.changes.push_back(
        {changed[i].name, changed[i].unit, best.change[at], std::sqrt(best.covariance(at, at))});
  }
  return suspect;
}

/// Judges all candidates that are not in `moved`, the most probable first.
std::vector<JointSuspect> JudgeAll(const Evidence& evidence, const std::vector<std::string>& moved,
                                   double freedom) {
  std::vector<JointSuspect> joints;
  std::vector<double> logs;
  for (const Candidate& candidate : evidence.candidates()) {
    if (std::ranges::count(moved, candidate.joint) > 0) continue;
    joints.push_back(Judge(evidence, candidate, freedom));
    logs.push_back(joints.back().log_evidence);
  }
  std::vector<double> p;
  for (const JointSuspect& joint : joints) {
    if (joint.told()) p.push_back(joint.test.p);
  }
  const std::vector<double> adjusted = HolmAdjusted(p);
  const double most = logs.empty() ? 0.0 : *std::max_element(logs.begin(), logs.end());
  double total = 0.0;
  for (double log : logs) total += std::exp(log - most);
  std::size_t next = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].probability = std::exp(logs[i] - most) / total;
    if (joints[i].told()) joints[i].p_adjusted = adjusted[next++];
  }
  std::stable_sort(joints.begin(), joints.end(), [](const JointSuspect& a, const JointSuspect& b) {
    return a.probability > b.probability;
  });
  return joints;
}

/// Search for the joints that have moved, for one covariance of the earlier calibration.
class MoveSearch {
 public:
  MoveSearch(const Evidence& as_calibrated, double freedom, const JointCheckOptions& options)
      : as_calibrated_(as_calibrated),
        freedom_(freedom),
        options_(options),
        // All joints are equally likely to have moved.
        choice_(std::log(static_cast<double>(as_calibrated.candidates().size()))) {}

  JointCheck Find() const {
    JointCheck check;
    for (const JointSuspect& joint : Beside({})) {
      if (!joint.zero_told) check.not_told.push_back(joint.joint);
    }
    const std::vector<std::string> found = WithoutNeedless(Forward());
    check.log_evidence = EvidenceOf(found);
    std::vector<std::string> certain;
    for (const std::string& joint : found) {
      const std::vector<JointSuspect> joints = Beside(Others(found, joint));
      if (joints.front().joint == joint && joints.front().probability >= options_.certainty) {
        check.moved.push_back(joints.front());
        certain.push_back(joint);
      } else {
        AddSuspects(joints, check.suspects);
      }
    }
    check.joints = Beside(certain);
    return check;
  }

 private:
  bool Significant(const JointSuspect& joint) const {
    return joint.p_adjusted <= options_.level && joint.log_evidence > choice_ + kOddsAgainst;
  }

  std::vector<JointSuspect> Beside(const std::vector<std::string>& moved) const {
    return JudgeAll(as_calibrated_.Beside(moved), moved, freedom_);
  }

  static std::vector<std::string> Others(std::vector<std::string> joints, const std::string& but) {
    std::erase(joints, but);
    return joints;
  }

  /// Adds the most probable significant joint, beside it the next one, until none is significant.
  std::vector<std::string> Forward() const {
    std::vector<std::string> found;
    while (true) {
      const std::vector<JointSuspect> joints = Beside(found);
      const auto next = std::ranges::find_if(
          joints, [&](const JointSuspect& joint) { return Significant(joint); });
      if (next == joints.end()) return found;
      found.push_back(next->joint);
    }
  }

  /// Removes joints that are not significant beside the others, in whose place they were found.
  std::vector<std::string> WithoutNeedless(std::vector<std::string> found) const {
    for (std::size_t i = 0; i < found.size();) {
      const std::vector<std::string> others = Others(found, found[i]);
      const std::vector<JointSuspect> joints = Beside(others);
      const auto own = std::ranges::find(joints, found[i], &JointSuspect::joint);
      if (Significant(*own)) {
        ++i;
      } else {
        found = others;
        i = 0;
      }
    }
    return found;
  }

  double EvidenceOf(const std::vector<std::string>& found) const {
    double evidence = 0.0;
    std::vector<std::string> before;
    for (const std::string& joint : found) {
      const std::vector<JointSuspect> joints = Beside(before);
      evidence += std::ranges::find(joints, joint, &JointSuspect::joint)->log_evidence - choice_;
      before.push_back(joint);
    }
    return evidence;
  }

  /// Adds the most probable joints whose probabilities sum up to the certainty.
  void AddSuspects(const std::vector<JointSuspect>& joints,
                   std::vector<std::string>& suspects) const {
    double sum = 0.0;
    for (const JointSuspect& joint : joints) {
      if (sum >= options_.certainty) break;
      if (std::ranges::count(suspects, joint.joint) == 0) suspects.push_back(joint.joint);
      sum += joint.probability;
    }
  }

  const Evidence& as_calibrated_;
  double freedom_;
  const JointCheckOptions& options_;
  double choice_;
};

}  // namespace

double SmallestChange(double sd, double size, std::size_t joints) {
  constexpr double kNineInTen = 1.28;  // standard deviations
  const double told = size * size / (sd * sd);
  if (!(told >= kLeastTold)) return std::numeric_limits<double>::infinity();
  // Solves for z: evidence z^2 told / (1 + told) / 2 - log(1 + told) / 2, of one of two changes.
  const double needed = std::log(2.0 * static_cast<double>(joints)) + kOddsAgainst;
  const double z = std::sqrt((2.0 * needed + std::log1p(told)) * (1.0 + told) / told);
  return sd * (z + kNineInTen);
}

Eigen::VectorXd SizeOfChanges(const EarlierEstimate& earlier, const ErrorModel& model,
                              const Prior& prior) {
  std::map<std::string, double> sizes;
  for (const Parameter& parameter : model.parameters) {
    const bool of_robot = parameter.joint >= 0 || parameter.linkage >= 0;
    if (!of_robot || IsElastic(parameter.kind)) continue;
    sizes[parameter.name] = kTimesPrior * prior.Of(model.tree, parameter);
  }
  Eigen::VectorXd result(static_cast<Eigen::Index>(earlier.names.size()));
  for (std::size_t i = 0; i < earlier.names.size(); ++i) {
    const auto size = sizes.find(earlier.names[i]);
    result[static_cast<Eigen::Index>(i)] = size == sizes.end() ? 0.0 : size->second;
  }
  return result;
}

JointCheck FindMovedJoints(const CalibrationResult& estimate, const EarlierEstimate& fitted_with,
                           const EarlierEstimate& earlier, const Eigen::VectorXd& size_of_changes,
                           const JointCheckOptions& options) {
  const double t = std::max(1.96, estimate.interval_factor);
  const double freedom = t < 1.9600001 ? kKnownFreedom : StudentDegreesOfFreedom(0.975, t);
  const DataInformation data = InformationOfData(estimate, fitted_with);
  JointCheck best;
  double unchanged = 0.0;  // logarithm of p(data | nothing has moved, covariance times 1)
  for (const double widened : kWidenings) {
    EarlierEstimate wider = earlier;
    wider.covariance *= widened;
    const Evidence evidence(estimate, data, wider, size_of_changes);
    if (widened == 1.0) unchanged = evidence.unchanged();
    JointCheck check = MoveSearch(evidence, freedom, options).Find();
    check.widened = widened;
    // A covariance four times as large is half as likely beforehand.
    check.log_evidence += evidence.unchanged() - unchanged - 0.5 * std::log(widened);
    if (widened > 1.0 && !(check.log_evidence > best.log_evidence)) continue;
    best = std::move(check);
  }
  return best;
}

}  // namespace elastocal
