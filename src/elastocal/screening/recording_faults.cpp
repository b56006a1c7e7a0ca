// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/recording_faults.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/variances.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/screening/frame_shifts.hpp"
#include "elastocal/screening/measured_faults.hpp"

namespace elastocal {
namespace {

constexpr double kStep = 1e-6;  // step of difference quotients: rad, m, relative
constexpr double kLeastExplained = 0.06;
constexpr double kLeastOfChains = 0.5;  // share of the residuals of the chains with the fault
constexpr int kLeastSide = 3;           // postures before and after the beginning of a fault
// Postures of the recording at which an offset of a joint may begin, and a passing one.
constexpr int kSplits = 48, kSplitsOfStretch = 12;
constexpr int kTrialSplits = 6;  // postures of a trial at which an offset to its end may begin

using Blocks = std::vector<Eigen::VectorXd>;

class FaultSearch {
 public:
  /// `only` are the faults to be measured; none: all are tried.
  FaultSearch(const CalibrationResult& result, const Recording& recording,
              const CalibrationOptions& options, Certainty certainty,
              const std::vector<RecordingFault>* only = nullptr)
      : certainty_(certainty),
        result_(result),
        recording_(recording),
        options_(options),
        selection_(SelectAll(result.model, recording)) {
    fit_.delta = result.delta;
    fit_.placement = result.placement;
    fit_.noise = result.noise;
    fit_.prior_scale = result.prior_scale;
    // A fault may be among the outliers: all observations take part, with limited weights.
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
    const NormalEquations equations(body);
    const Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
    double with_priors = 0.0;
    for (std::size_t b = 0; b < posture_.size(); ++b) {
      if (!body.residual_blocks[b].active) continue;
      with_priors += body.Residual(static_cast<int>(b)).squaredNorm();
      squares_ += at_[b].squaredNorm();
    }
    // With these weights, the fit may be far from the optimum of the other unknowns.
    squares_ = std::min(squares_, with_priors - 2.0 * equations.Decrease(covariance));
    if (only != nullptr) {
      Measure(equations, covariance, *only);
      return;
    }
    for (const int coordinate : Coordinates()) TryJoint(equations, covariance, coordinate);
    const std::vector<Linkage>& linkages = result.model.tree.linkages;
    for (std::size_t k = 0; k < linkages.size(); ++k) {
      for (std::size_t rod = 0; rod < linkages[k].rods.size(); ++rod) {
        TryMotor(equations, covariance, {static_cast<int>(k), static_cast<int>(rod)});
      }
    }
    const RecordingFault unfinished{.kind = FaultKind::kUnfinished};  // all joints, at rest later
    Try(equations, covariance, DerivativeOf(unfinished), {MakeTrial(unfinished)}, false);
    TryScale(equations, covariance);
    PreferSlides(result.model.tree, found_);
    std::ranges::stable_sort(found_, std::greater(), &RecordingFault::share);
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

  /// Residuals of observations and constraints.
  Blocks Residuals(const BodyResiduals& body) const {
    Blocks residuals(posture_.size());
    for (std::size_t b = 0; b < posture_.size(); ++b) {
      if (posture_[b] >= 0) residuals[b] = body.Residual(static_cast<int>(b));
    }
    return residuals;
  }

  /// Derivative of the residuals by a change of the recording over kStep.
  Blocks Derivative(const Recording& changed) const {
    FitResiduals residuals(Problem(changed), selection_, result_.posterior.parameters, fit_);
    residuals.body.Evaluate(residuals.body.Start(), false);
    Blocks derivative = Residuals(residuals.body);
    for (std::size_t b = 0; b < at_.size(); ++b) derivative[b] = (derivative[b] - at_[b]) / kStep;
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

  /// A candidate: a fault whose effect is a derivative times a factor of each posture.
  struct Trial {
    RecordingFault fault;
    Eigen::VectorXd factor;
  };

  Trial MakeTrial(const RecordingFault& fault) const {
    Trial trial{fault, Eigen::VectorXd(recording_.posture_count())};
    for (int i = 0; i < trial.factor.size(); ++i) trial.factor[i] = FactorOf(fault, recording_, i);
    return trial;
  }

  /// Sum of squares of the chains (CalibrationResult::group) in whose postures it has an effect.
  double SquaresOfChains(const Blocks& derivative, const Eigen::VectorXd& factor) const {
    std::map<int, double> squares;
    std::set<int> chains;
    for (std::size_t b = 0; b < posture_.size(); ++b) {
      const int i = posture_[b];
      if (i < 0) continue;
      squares[result_.group[i]] += at_[b].squaredNorm();
      if (factor[i] != 0.0 && !derivative[b].isZero(0.0)) chains.insert(result_.group[i]);
    }
    double sum = 0.0;
    for (const int chain : chains) sum += squares[chain];
    return sum;
  }

  /// Measures candidates by the residuals of the fit.
  std::vector<RecordingFault> Measured(const NormalEquations& equations,
                                       const Eigen::MatrixXd& covariance, const Blocks& derivative,
                                       const std::vector<Trial>& trials) const {
    Eigen::MatrixXd factors(recording_.posture_count(), static_cast<Eigen::Index>(trials.size()));
    for (std::size_t k = 0; k < trials.size(); ++k) {
      factors.col(static_cast<Eigen::Index>(k)) = trials[k].factor;
    }
    std::vector<RecordingFault> measured;
    for (const Trial& trial : trials) measured.push_back(trial.fault);
    const double variance = std::max(1.0, result_.posterior.cluster_factor);
    if (!trials.empty() && IsOfAnyDirection(trials.front().fault)) {
      MeasureShifts(equations, by_axis_, posture_, factors, covariance, variance, measured);
      for (RecordingFault& fault : measured) fault.share /= squares_;
      return measured;
    }
    const auto additions = equations.Add(derivative, posture_, factors, covariance);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      // What has to be added to the recording is minus the fault.
      measured[k].size = -additions[k].value;
      measured[k].sd = std::sqrt(additions[k].variance * variance);
      measured[k].share = additions[k].gain / squares_;
    }
    return measured;
  }

  void Try(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
           const Blocks& derivative, const std::vector<Trial>& trials, bool slides) {
    const std::vector<RecordingFault> measured =
        Measured(equations, covariance, derivative, trials);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      const RecordingFault& fault = measured[k];
      const bool matters = std::abs(fault.size) > LeastSize(fault.kind, slides) &&
                           std::abs(fault.size) < LargestSize(fault.kind, slides);
      if (!IsCertain(fault, certainty_) || !matters) continue;
      const bool explains =
          fault.share > kLeastExplained ||
          fault.share * squares_ > kLeastOfChains * SquaresOfChains(derivative, trials[k].factor);
      if (explains) found_.push_back(fault);
    }
  }

  /// By what a fault does to the recording, but for its factors.
  Blocks DerivativeOf(const RecordingFault& fault) const {
    return Derivative(WithStep(fault, result_.model.tree, kStep, recording_));
  }

  /// One derivative serves faults of the same joint that follow each other.
  void Measure(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
               const std::vector<RecordingFault>& faults) {
    Blocks derivative;
    for (const RecordingFault& fault : faults) {
      const int of = found_.empty() ? -1 : found_.back().coordinate;
      if (fault.coordinate < 0 || fault.coordinate != of) derivative = DerivativeOf(fault);
      found_.push_back(Measured(equations, covariance, derivative, {MakeTrial(fault)}).front());
    }
  }

  void TryJoint(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                int coordinate) {
    const Joint& joint = JointOfCoordinate(result_.model.tree, coordinate);
    const bool slides = joint.type == JointType::kPrismatic;
    const RecordingFault fault{.coordinate = coordinate};
    const Blocks derivative = DerivativeOf(fault);
    std::vector<Trial> of_moves = {
        MakeTrial(fault), MakeTrial({.kind = FaultKind::kUnfinished, .coordinate = coordinate})};
    for (const int trial : TrialsThatMove(recording_, coordinate)) {
      of_moves.push_back(MakeTrial({.coordinate = coordinate, .trial = trial}));
    }
    Try(equations, covariance, derivative, of_moves, slides);
    if (HasMotion(recording_)) {
      const RecordingFault lag{.kind = FaultKind::kJointLag, .coordinate = coordinate};
      Try(equations, covariance, derivative, {MakeTrial(lag)}, slides);
    }
    TryOffsets(equations, covariance, derivative,
               {.kind = FaultKind::kJointOffset, .coordinate = coordinate}, slides);
  }

  void TryMotor(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                const MotorIndex& motor) {
    const RobotTree& tree = result_.model.tree;
    const Linkage& linkage = tree.linkages[Size(motor.linkage)];
    const RecordingFault fault{
        .kind = FaultKind::kJointOffset, .coordinate = motor.rod, .linkage = motor.linkage};
    const bool slides = linkage.rods[Size(motor.rod)].actuator;
    TryOffsets(equations, covariance, DerivativeOf(fault), fault, slides);
  }

  /// Tries offsets of a joint, a motor or the markers' frame, by the derivative of its position.
  void TryOffsets(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                  const Blocks& derivative, const RecordingFault& of, bool slides) {
    std::vector<Trial> trials;
    const auto add = [&](int trial, int posture, int end = 0, bool drifts = false) {
      RecordingFault fault = of;
      if (drifts) fault.kind = FaultKind::kJointDrift;
      fault.trial = trial;
      fault.posture = posture;
      fault.end = end;
      trials.push_back(MakeTrial(fault));
    };
    const auto try_all = [&] {
      Try(equations, covariance, derivative, trials, slides);
      trials.clear();
    };
    const int count = recording_.posture_count();
    const int stride = std::max(1, count / kSplits);
    const auto add_split = [&](int split) {
      // An offset of nearly all or nearly no postures is an error of the robot, or one bad posture.
      if (split < kLeastSide || split > count - kLeastSide) return;
      add(-1, split);
    };
    const auto best_since = [&](std::size_t before) {
      return *std::ranges::max_element(found_.begin() + static_cast<std::ptrdiff_t>(before),
                                       found_.end(), {}, &RecordingFault::share);
    };
    // Tries evenly spread beginnings, then all between the best and its neighbours.
    const auto try_splits = [&](int begin, int end, int step, const auto& add_at) {
      const std::size_t before = found_.size();
      for (int split = begin + step; split < end; split += step) add_at(split);
      try_all();
      if (found_.size() == before) return;
      const int around = best_since(before).posture;
      for (int off = 1; off < step; ++off) {
        add_at(around - off);
        add_at(around + off);
      }
      try_all();
    };
    try_splits(0, count, stride, add_split);
    if (recording_.trials.empty()) {
      TryStretches(count, add, try_all, best_since);
    }
    const auto add_drift = [&](int trial, int begin, int end) {
      const bool long_enough = end == 0 || end - begin >= 2 * kLeastSide;
      const bool of_joint = of.coordinate >= 0 && of.linkage < 0;
      if (of_joint && long_enough) add(trial, begin, end, true);
    };
    // For a joint that markers show in one trial, a drift over all trials would be as likely.
    const bool several = recording_.trials.size() > 1;
    if (!several) add_drift(-1, 0, 0);
    try_all();
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      const auto first = std::find(recording_.trial.begin(), recording_.trial.end(), trial);
      if (first == recording_.trial.end()) continue;
      const int begin = static_cast<int>(first - recording_.trial.begin());
      const int end = begin + static_cast<int>(std::count(first, recording_.trial.end(), trial));
      add(trial, begin);
      if (several) add_drift(trial, begin, end);
      try_all();
      if (end == count) continue;  // the end of the trial is the end of the recording
      try_splits(begin, end, std::max(1, (end - begin) / kTrialSplits), [&](int split) {
        if (split < begin + kLeastSide || split > end - kLeastSide) return;
        add(trial, split);
      });
    }
  }

  /// An offset from one posture to another: a joint that slipped and was corrected.
  template <typename Add, typename TryAll, typename BestSince>
  void TryStretches(int count, const Add& add, const TryAll& try_all,
                    const BestSince& best_since) const {
    const int stride = std::max(1, count / kSplitsOfStretch);
    const auto add_stretch = [&](int begin, int end) {
      const bool long_enough = end - begin >= kLeastSide;
      if (begin >= kLeastSide && end <= count - kLeastSide && long_enough) add(-1, begin, end);
    };
    std::size_t before = found_.size();
    for (int begin = stride; begin < count; begin += stride) {
      for (int end = begin + stride; end < count; end += stride) add_stretch(begin, end);
    }
    try_all();
    if (found_.size() == before) return;
    for (const bool of_end : {false, true, false, true}) {
      const RecordingFault around = best_since(before);
      before = found_.size();
      for (int off = -stride; off <= stride; ++off) {
        add_stretch(around.posture + (of_end ? 0 : off), around.end + (of_end ? off : 0));
      }
      try_all();
      if (found_.size() == before) return;
    }
  }

  /// Tries faults of the cameras' space, and the scale of one trial (not of all: see the header).
  void TryScale(const NormalEquations& equations, const Eigen::MatrixXd& covariance) {
    if (recording_.trials.empty() && !recording_.free_root) {
      RecordingFault shift{.kind = FaultKind::kFrameShift};
      for (int axis = 0; axis < 3; ++axis) {
        shift.along = Eigen::Vector3d::Unit(axis);
        by_axis_.push_back(DerivativeOf(shift));
      }
      shift.along.setZero();
      TryOffsets(equations, covariance, by_axis_.front(), shift, true);
    }
    std::vector<RecordingFault> of_cameras = {{.kind = FaultKind::kCameraBend}};
    for (int axis = 0; axis < 3; ++axis) {
      of_cameras.push_back({.kind = FaultKind::kCameraAxis, .axis = axis});
      of_cameras.push_back(
          {.kind = FaultKind::kCameraShear, .axis = axis, .by_axis = (axis + 1) % 3});
    }
    for (const RecordingFault& fault : of_cameras) {
      Try(equations, covariance, DerivativeOf(fault), {MakeTrial(fault)}, false);
    }
    if (recording_.trials.size() < 2) return;
    std::vector<Trial> trials;
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      trials.push_back(MakeTrial({.kind = FaultKind::kCameraScale, .trial = trial}));
    }
    Try(equations, covariance, DerivativeOf({.kind = FaultKind::kCameraScale}), trials, false);
  }

  Certainty certainty_;
  const CalibrationResult& result_;
  const Recording& recording_;
  const CalibrationOptions& options_;
  Selection selection_;
  Fit fit_;
  std::vector<int> posture_;  // by residual block; -1: a prior
  Blocks at_;
  double squares_ = 0.0;
  std::vector<Blocks> by_axis_;  ///< derivatives by displacements of the markers' frame
  std::vector<RecordingFault> found_;
};

}  // namespace

std::vector<RecordingFault> FindRecordingFaults(const CalibrationResult& result,
                                                const Recording& recording,
                                                const CalibrationOptions& options,
                                                Certainty certainty) {
  return FaultSearch(result, recording, options, certainty).found();
}

std::vector<RecordingFault> MeasureFaults(const std::vector<RecordingFault>& faults,
                                          const CalibrationResult& result,
                                          const Recording& recording,
                                          const CalibrationOptions& options) {
  return FaultSearch(result, recording, options, Certainty::kCertain, &faults).found();
}

}  // namespace elastocal
