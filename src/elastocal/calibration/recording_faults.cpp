// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/recording_faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/variances.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"

namespace elastocal {
namespace {

constexpr double kStep = 1e-6;  // of a derivative by differences: rad, m, relative
constexpr double kLeastExplained = 0.06;
constexpr double kLeastOfChains = 0.5;  // of what is left of the chains that it is in
constexpr double kLeastSds = 6.0;
constexpr int kLeastSide = 3;    // postures before and after it
constexpr int kSplits = 12;      // of the recording, after which an offset of a joint may begin
constexpr int kTrialSplits = 6;  // of a trial, after which one may begin that ends with the trial

/// Sizes from which a fault is none that a good robot and good cameras may have.
double LeastSize(FaultKind kind, bool slides) {
  if (kind == FaultKind::kJointGain) return 0.005;
  if (kind == FaultKind::kCameraScale) return 0.0015;
  return slides ? 1e-3 : 0.25 * M_PI / 180.0;
}

/// Sizes beyond which a fault is none: where a joint moves no marker, rounding would explain
/// anything with a size large enough.
double LargestSize(FaultKind kind, bool slides) {
  if (kind == FaultKind::kJointGain) return 1.0;
  if (kind == FaultKind::kCameraScale) return 0.5;
  return slides ? 1.0 : M_PI;
}

using Blocks = std::vector<Eigen::VectorXd>;

class FaultSearch {
 public:
  FaultSearch(const CalibrationResult& result, const Recording& recording,
              const CalibrationOptions& options)
      : result_(result),
        recording_(recording),
        options_(options),
        selection_(SelectAll(result.model, recording)) {
    fit_.delta = result.delta;
    fit_.placement = result.placement;
    fit_.noise = result.noise;
    fit_.prior_scale = result.prior_scale;
    // A fault may be what the fit left out as outliers: all observations take part, but each by a
    // limited weight.
    fit_.weights = Weights();
    FitResiduals residuals(Problem(recording), selection_, result.posterior.parameters, fit_);
    BodyResiduals& body = residuals.body;
    body.Evaluate(body.Start(), true);
    posture_.assign(body.residual_blocks.size(), -1);
    for (int b = 0; b < body.body_count(); ++b) posture_[b] = selection_.bodies[b].posture;
    for (std::size_t t = 0; t < body.tied_postures().size(); ++t) {
      posture_[body.TieBlock(static_cast<int>(t))] = body.tied_postures()[t];
    }
    at_ = Residuals(body);
    for (std::size_t b = 0; b < at_.size(); ++b) {
      if (body.residual_blocks[b].active) squares_ += at_[b].squaredNorm();
    }
    const NormalEquations equations(body);
    const Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
    for (const int coordinate : Coordinates()) TryJoint(equations, covariance, coordinate);
    const std::vector<Linkage>& linkages = result.model.tree.linkages;
    for (std::size_t k = 0; k < linkages.size(); ++k) {
      for (std::size_t rod = 0; rod < linkages[k].rods.size(); ++rod) {
        TryMotor(equations, covariance, {static_cast<int>(k), static_cast<int>(rod)});
      }
    }
    TryScale(equations, covariance);
    std::stable_sort(
        found_.begin(), found_.end(),
        [](const RecordingFault& a, const RecordingFault& b) { return a.share > b.share; });
  }

  std::vector<RecordingFault> found() && { return std::move(found_); }

 private:
  FitProblem Problem(const Recording& recording) const {
    return {result_.model, recording, options_, result_.group};
  }

  RobustWeights Weights() const {
    FitResiduals residuals(Problem(recording_), selection_, result_.posterior.parameters, fit_);
    residuals.body.Evaluate(residuals.body.Start(), false);
    return EstimateWeights(Problem(recording_), selection_, fit_.noise, residuals.body,
                           Robustness::kMedians);
  }

  /// Of observations and constraints.
  Blocks Residuals(const BodyResiduals& body) const {
    Blocks residuals(posture_.size());
    for (std::size_t b = 0; b < posture_.size(); ++b) {
      if (posture_[b] >= 0) residuals[b] = body.Residual(static_cast<int>(b));
    }
    return residuals;
  }

  /// Change of the residuals by a change of the recording, over kStep.
  Blocks Derivative(const Recording& changed) const {
    FitResiduals residuals(Problem(changed), selection_, result_.posterior.parameters, fit_);
    residuals.body.Evaluate(residuals.body.Start(), false);
    Blocks derivative = Residuals(residuals.body);
    for (std::size_t b = 0; b < derivative.size(); ++b)
      derivative[b] = (derivative[b] - at_[b]) / kStep;
    return derivative;
  }

  std::set<int> Coordinates() const {
    std::set<int> coordinates;
    for (const int joint : result_.model.active_joints) {
      if (IsMovedByRods(result_.model.tree, joint)) continue;  // its motors are logged
      coordinates.insert(result_.model.tree.joints[joint].coordinate);
    }
    return coordinates;
  }

  /// What is tried: a fault, whose effect is a derivative times a factor of each posture.
  struct Trial {
    RecordingFault fault;
    Eigen::VectorXd factor;
  };

  template <typename Factor>
  Trial MakeTrial(const RecordingFault& fault, const Factor& factor) const {
    Trial trial{fault, Eigen::VectorXd(recording_.posture_count())};
    for (int i = 0; i < recording_.posture_count(); ++i) trial.factor[i] = factor(i);
    return trial;
  }

  /// Of the chains (CalibrationResult::group) in whose postures a trial does anything.
  double SquaresOfChains(const Blocks& derivative, const Eigen::VectorXd& factor) const {
    std::set<int> chains;
    for (std::size_t b = 0; b < posture_.size(); ++b) {
      const int i = posture_[b];
      if (i < 0 || factor[i] == 0.0 || derivative[b].isZero(0.0)) continue;
      chains.insert(result_.group[i]);
    }
    double squares = 0.0;
    for (std::size_t b = 0; b < posture_.size(); ++b) {
      if (posture_[b] >= 0 && chains.contains(result_.group[posture_[b]])) {
        squares += at_[b].squaredNorm();
      }
    }
    return squares;
  }

  void Try(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
           const Blocks& derivative, const std::vector<Trial>& trials, bool slides) {
    Eigen::MatrixXd factors(recording_.posture_count(), static_cast<Eigen::Index>(trials.size()));
    for (std::size_t k = 0; k < trials.size(); ++k) {
      factors.col(static_cast<Eigen::Index>(k)) = trials[k].factor;
    }
    const auto additions = equations.Add(derivative, posture_, factors, covariance);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      RecordingFault fault = trials[k].fault;
      // What has to be added to the recording is what it lacks.
      fault.size = -additions[k].value;
      fault.sd = std::sqrt(additions[k].variance * std::max(1.0, result_.posterior.cluster_factor));
      fault.share = additions[k].gain / squares_;
      const bool certain = std::abs(fault.size) > kLeastSds * fault.sd;
      const bool matters = std::abs(fault.size) > LeastSize(fault.kind, slides) &&
                           std::abs(fault.size) < LargestSize(fault.kind, slides);
      if (!certain || !matters) continue;
      const bool explains =
          fault.share > kLeastExplained ||
          additions[k].gain > kLeastOfChains * SquaresOfChains(derivative, trials[k].factor);
      if (explains) found_.push_back(fault);
    }
  }

  void TryJoint(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                int coordinate) {
    Recording changed = recording_;
    changed.q.col(coordinate).array() += kStep;
    const Blocks derivative = Derivative(changed);
    const std::vector<Joint>& joints = result_.model.tree.joints;
    const auto joint = std::find_if(joints.begin(), joints.end(), [&](const Joint& candidate) {
      return candidate.coordinate == coordinate;
    });
    const bool slides = joint->type == JointType::kPrismatic;
    RecordingFault fault;
    fault.coordinate = coordinate;
    Try(equations, covariance, derivative,
        {MakeTrial(fault, [&](int i) { return recording_.q(i, coordinate); })}, slides);
    TryOffsets(equations, covariance, derivative, fault, slides);
  }

  void TryMotor(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                const MotorIndex& motor) {
    const RobotTree& tree = result_.model.tree;
    const Linkage& linkage = tree.linkages[static_cast<std::size_t>(motor.linkage)];
    Recording changed = recording_;
    const std::vector<int> joints = CoordinatesOf(tree, linkage);
    for (int i = 0; i < recording_.posture_count(); ++i) {
      const Eigen::VectorXd at = recording_.q(i, joints).transpose();
      const auto motors = MotorPositions(tree, linkage, at);
      if (!motors) continue;
      if (const auto closure = CloseLinkage(tree, linkage, *motors, {}, at)) {
        changed.q(i, joints) += kStep * closure->by_motors.col(motor.rod).transpose();
      }
    }
    RecordingFault fault;
    fault.coordinate = motor.rod;
    fault.linkage = motor.linkage;
    TryOffsets(equations, covariance, Derivative(changed), fault,
               linkage.rods[static_cast<std::size_t>(motor.rod)].actuator);
  }

  /// Of a joint or motor, by the derivative of its position.
  void TryOffsets(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                  const Blocks& derivative, const RecordingFault& of, bool slides) {
    std::vector<Trial> trials;
    const auto add = [&](int trial, int posture, const auto& factor) {
      RecordingFault fault = of;
      fault.kind = FaultKind::kJointOffset;
      fault.trial = trial;
      fault.posture = posture;
      trials.push_back(MakeTrial(fault, factor));
    };
    const auto try_all = [&] {
      Try(equations, covariance, derivative, trials, slides);
      trials.clear();
    };
    const int count = recording_.posture_count();
    const int stride = std::max(1, count / kSplits);
    const auto add_split = [&](int split) {
      // Nearly all postures, or nearly none: an error of the robot, or one bad posture.
      if (split < kLeastSide || split > count - kLeastSide) return;
      add(-1, split, [&](int i) { return i >= split ? 1.0 : 0.0; });
    };
    // Every so many splits, and then all between the best of them and its neighbours.
    const auto try_splits = [&](int begin, int end, int step, const auto& add_at) {
      const std::size_t before = found_.size();
      for (int split = begin + step; split < end; split += step) add_at(split);
      try_all();
      if (found_.size() == before) return;
      const auto best = std::max_element(
          found_.begin() + static_cast<std::ptrdiff_t>(before), found_.end(),
          [](const RecordingFault& a, const RecordingFault& b) { return a.share < b.share; });
      const int around = best->posture;
      for (int off = 1; off < step; ++off) {
        add_at(around - off);
        add_at(around + off);
      }
      try_all();
    };
    try_splits(0, count, stride, add_split);
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      const auto first = std::find(recording_.trial.begin(), recording_.trial.end(), trial);
      if (first == recording_.trial.end()) continue;
      const int begin = static_cast<int>(first - recording_.trial.begin());
      const int end = begin + static_cast<int>(std::count(first, recording_.trial.end(), trial));
      add(trial, begin, [&](int i) { return recording_.trial[i] == trial ? 1.0 : 0.0; });
      try_all();
      if (end == count) continue;  // to the end of the trial is to the end of the recording
      try_splits(begin, end, std::max(1, (end - begin) / kTrialSplits), [&](int split) {
        if (split < begin + kLeastSide || split > end - kLeastSide) return;
        add(trial, split, [&](int i) { return i >= split && i < end ? 1.0 : 0.0; });
      });
    }
  }

  /// Of one trial. A scale of all of them is what a robot with other lengths shows as well.
  void TryScale(const NormalEquations& equations, const Eigen::MatrixXd& covariance) {
    if (recording_.trials.size() < 2) return;
    Recording changed = recording_;
    changed.markers *= 1.0 + kStep;
    const Blocks derivative = Derivative(changed);
    std::vector<Trial> trials;
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      trials.push_back(MakeTrial({.kind = FaultKind::kCameraScale, .trial = trial},
                                 [&](int i) { return recording_.trial[i] == trial ? 1.0 : 0.0; }));
    }
    Try(equations, covariance, derivative, trials, false);
  }

  const CalibrationResult& result_;
  const Recording& recording_;
  const CalibrationOptions& options_;
  Selection selection_;
  Fit fit_;
  std::vector<int> posture_;  // by residual block; -1: a prior
  Blocks at_;
  double squares_ = 0.0;
  std::vector<RecordingFault> found_;
};

}  // namespace

std::vector<RecordingFault> FindRecordingFaults(const CalibrationResult& result,
                                                const Recording& recording,
                                                const CalibrationOptions& options) {
  return FaultSearch(result, recording, options).found();
}

bool IsInPartOfTrial(const RecordingFault& fault, const Recording& recording) {
  return fault.trial >= 0 && fault.posture > 0 &&
         recording.trial[fault.posture - 1] == recording.trial[fault.posture];
}

std::string DescribeFault(const RecordingFault& fault, const RobotTree& tree,
                          const Recording& recording) {
  const bool joint = fault.kind != FaultKind::kCameraScale;
  const LoggedPosition of = joint ? LoggedPositionOf(tree, fault.linkage, fault.coordinate)
                                  : LoggedPosition{"camera positions"};
  std::string text = of.name;
  const bool slides = of.slides;
  char number[80];
  if (fault.kind == FaultKind::kJointOffset) {
    const double unit = slides ? 1e-3 : M_PI / 180.0;
    std::snprintf(number, sizeof number, ": its positions are off by %.3f +- %.3f %s",
                  fault.size / unit, fault.sd / unit, slides ? "mm" : "deg");
  } else {
    std::snprintf(number, sizeof number, "%s %.4f +- %.4f times the true ones",
                  joint ? ": its positions are" : " are", 1.0 + fault.size, fault.sd);
  }
  text += number;
  if (IsInPartOfTrial(fault, recording)) {
    return text + " from " + DescribePosture(recording, fault.posture) + " to the end of the trial";
  }
  if (fault.trial >= 0) return text + " in trial " + recording.trials[fault.trial].name;
  return fault.posture > 0 ? text + " from " + DescribePosture(recording, fault.posture) + " on"
                           : text;
}

}  // namespace elastocal
