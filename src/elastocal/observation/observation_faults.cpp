// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/optim/normal_equations.hpp"
#include "elastocal/robot/linkage.hpp"

namespace elastocal {
namespace {

constexpr double kDerivativeStep = 1e-6;  // rad, m
constexpr double kLeastShare = 0.1;
constexpr double kCertain = 4.0;      // standard deviations, in noise that contains the fault
constexpr double kLeastMoved = 0.01;  // share of a joint's effect elsewhere, in squares
constexpr int kSplitsTried = 12;      // places in the table at which a fault may begin
constexpr double kOneDegree = M_PI / 180.0;

/// Smallest size that a good robot with good instruments does not have.
double LeastSize(const ObservationFault& fault, bool slides) {
  switch (fault.kind) {
    case ObservationFaultKind::kJointGain:
      return 0.005;
    case ObservationFaultKind::kScale:
    case ObservationFaultKind::kTagSize:
      return 0.003;
    case ObservationFaultKind::kJointOffset:
    case ObservationFaultKind::kJointDrift:
      return slides ? 1e-3 : 0.25 * kOneDegree;
    default:
      return fault.turns ? 0.05 * kOneDegree : 0.5e-3;
  }
}

/// Largest size; beyond it another fault is imitated.
double LargestSize(const ObservationFault& fault, bool slides) {
  const double angle = 15.0 * kOneDegree;
  if (fault.kind == ObservationFaultKind::kJointGain) return 0.3;
  if (fault.kind == ObservationFaultKind::kScale) return 0.3;
  if (fault.kind == ObservationFaultKind::kTagSize) return 0.5;
  if (fault.coordinate >= 0) return slides ? 0.1 : angle;
  return fault.turns ? angle : 1.0;
}

class ObservationFaultSearch {
 public:
  ObservationFaultSearch(const ObservedRobot& model, const Observations& observations,
                         const ObservationFit& fit)
      : model_(model), observations_(observations), fit_(fit), weights_(LimitedWeights()) {}

  std::vector<ObservationFault> Run() {
    if (!Linearise()) return {};
    const NormalEquations equations(*residuals_);
    const Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
    for (const int coordinate : MovingCoordinates()) TryJoint(equations, covariance, coordinate);
    for (int k = 0; k < static_cast<int>(model_.setup.quantities.size()); ++k) {
      if (k != model_.root_tilt) TryMove(equations, covariance, k);
    }
    TryScales(equations, covariance);
    TryTags(equations, covariance);
    TryFrozen();
    return Best();
  }

  /// The part of a joint's or a scale's fault that is still there.
  double Left(const ObservationFault& fault) {
    if (!Linearise()) return 0.0;
    const NormalEquations equations(*residuals_);
    const auto addition =
        equations.Add(DerivativeBy(Undone(fault), fit_.values), posture_, FactorOf(fault),
                      InverseOfInformation(equations.information()))[0];
    return -addition.value;
  }

 private:
  /// Evaluates the fit; false where there are no residuals.
  bool Linearise() {
    residuals_.emplace(model_, observations_, fit_.loads, fit_.spread, weights_,
                       ObservationFreedom{}, fit_.values);
    residuals_->Evaluate(residuals_->Start(), true);
    posture_.assign(residuals_->residual_blocks.size(), -1);
    for (int i = 0; i < observations_.count(); ++i) {
      posture_[Size(i)] = observations_.all[Size(i)].posture;
    }
    at_ = ResidualsOf(*residuals_);
    squares_ = 0.0;
    for (const Eigen::VectorXd& block : at_) squares_ += block.squaredNorm();
    return squares_ > 0.0;
  }

  Observations Moved(int coordinate) const {
    Observations changed = observations_;
    changed.q.col(coordinate).array() += kDerivativeStep;
    return changed;
  }

  Observations Scaled() const {
    Observations changed = observations_;
    for (Observation& observation : changed.all) {
      observation.measured.head(LengthsMeasured(model_.instrument(observation.instrument))) *=
          1.0 + kDerivativeStep;
    }
    return changed;
  }

  /// The observations changed by kDerivativeStep of a scale, tag size or joint position, which
  /// undoes a fault of the opposite sign.
  /// opposite sign.
  Observations Undone(const ObservationFault& fault) const {
    if (fault.kind == ObservationFaultKind::kScale) return Scaled();
    if (fault.kind == ObservationFaultKind::kTagSize) {
      return WithTagsLarger(model_, observations_, fault.quantity, 1.0 / (1.0 + kDerivativeStep));
    }
    return Moved(fault.coordinate);
  }

  /// Factor of the fault in each posture: of a gain, the positions.
  Eigen::VectorXd FactorOf(const ObservationFault& fault) const {
    const int count = observations_.posture_count();
    Eigen::VectorXd factor(count);
    for (int i = 0; i < count; ++i) {
      const int file = observations_.postures[Size(i)].file;
      const bool here = i >= fault.posture && (fault.file < 0 || file == fault.file);
      double shape = 1.0;
      if (fault.kind == ObservationFaultKind::kJointGain) {
        shape = observations_.q(i, fault.coordinate);
      } else if (fault.kind == ObservationFaultKind::kJointDrift) {
        shape = DriftedShare(i, count);
      }
      factor[i] = here ? shape : 0.0;
    }
    return factor;
  }

  /// Weights of the fit; observations that it left out get Huber's weight.
  std::vector<double> LimitedWeights() const {
    const std::vector<Eigen::VectorXd> left = LeftOf(model_, observations_, fit_.values);
    std::vector<double> weights;
    for (std::size_t i = 0; i < left.size(); ++i) {
      weights.push_back(
          HuberWeight(model_.instrument(observations_.all[i].instrument), left[i], fit_.spread));
    }
    return weights;
  }

  /// Residuals of the observations.
  std::vector<Eigen::VectorXd> ResidualsOf(const ObservationResiduals& residuals) const {
    std::vector<Eigen::VectorXd> blocks(posture_.size());
    for (int i = 0; i < observations_.count(); ++i) blocks[Size(i)] = residuals.Residual(i);
    return blocks;
  }

  /// Derivative of the residuals, where observations or values are changed by kDerivativeStep.
  std::vector<Eigen::VectorXd> DerivativeBy(const Observations& changed,
                                            const ObservedValues& values) const {
    InterruptionPoint();
    ObservationResiduals residuals(model_, changed, fit_.loads, fit_.spread, weights_, {}, values);
    residuals.Evaluate(residuals.Start(), false);
    std::vector<Eigen::VectorXd> derivative = ResidualsOf(residuals);
    for (std::size_t b = 0; b < derivative.size(); ++b) {
      derivative[b] = (derivative[b] - at_[b]) / kDerivativeStep;
    }
    return derivative;
  }

  const Joint& JointOf(int coordinate) const {
    const RobotTree& tree = model_.robot.tree;
    return tree.joints[Size(tree.coordinate_joint[Size(coordinate)])];
  }

  /// Coordinates of joints that were estimated and moved.
  std::set<int> MovingCoordinates() const {
    std::set<int> moving;
    for (const int joint : model_.robot.active_joints) {
      const int c = model_.robot.tree.joints[Size(joint)].coordinate;
      const auto positions = observations_.q.col(c);
      if (positions.maxCoeff() > positions.minCoeff()) moving.insert(c);
    }
    return moving;
  }

  struct Tried {
    ObservationFault fault;
    Eigen::VectorXd factor;  // by posture
  };

  Tried FromPostureOn(ObservationFault fault, int posture) const {
    fault.posture = posture;
    return {fault, FactorOf(fault)};
  }

  /// The best of the tried faults that passes all limits; nothing where none does.
  std::optional<ObservationFault> Try(const NormalEquations& equations,
                                      const Eigen::MatrixXd& covariance,
                                      const std::vector<Eigen::VectorXd>& derivative,
                                      const std::vector<Tried>& tried, bool slides) const {
    if (tried.empty()) return std::nullopt;
    Eigen::MatrixXd factors(observations_.posture_count(), std::ssize(tried));
    for (std::size_t k = 0; k < tried.size(); ++k) {
      factors.col(static_cast<Eigen::Index>(k)) = tried[k].factor;
    }
    const auto additions = equations.Add(derivative, posture_, factors, covariance);
    std::optional<ObservationFault> best;
    for (std::size_t k = 0; k < tried.size(); ++k) {
      ObservationFault fault = tried[k].fault;
      fault.size = -additions[k].value;  // what is added undoes the fault
      fault.sd = std::sqrt(additions[k].variance);
      fault.share = additions[k].gain / squares_;
      const double size = std::abs(fault.size);
      const bool is_one = size > kCertain * fault.sd && size > LeastSize(fault, slides) &&
                          size < LargestSize(fault, slides) && fault.share > kLeastShare;
      if (is_one && (!best || fault.share > best->share)) best = fault;
    }
    return best;
  }

  /// Tries faults from some posture on: first evenly over the table, then near the best.
  std::optional<ObservationFault> TryFromSomewhereOn(const NormalEquations& equations,
                                                     const Eigen::MatrixXd& covariance,
                                                     const std::vector<Eigen::VectorXd>& derivative,
                                                     const ObservationFault& fault,
                                                     bool slides) const {
    const int count = observations_.posture_count();
    const int stride = std::max(1, count / kSplitsTried);
    std::vector<Tried> tried;
    for (int split = stride; split < count; split += stride) {
      tried.push_back(FromPostureOn(fault, split));
    }
    const auto roughly = Try(equations, covariance, derivative, tried, slides);
    if (!roughly) return std::nullopt;
    tried.clear();
    for (int split = roughly->posture - stride; split < roughly->posture + stride; ++split) {
      if (split > 0 && split < count) tried.push_back(FromPostureOn(fault, split));
    }
    return Try(equations, covariance, derivative, tried, slides);
  }

  void Keep(const std::optional<ObservationFault>& fault) {
    if (fault) found_.push_back(*fault);
  }

  void TryJoint(const NormalEquations& equations, const Eigen::MatrixXd& covariance,
                int coordinate) {
    const std::vector<Eigen::VectorXd> derivative = DerivativeBy(Moved(coordinate), fit_.values);
    const bool slides = JointOf(coordinate).type == JointType::kPrismatic;
    ObservationFault fault;
    fault.coordinate = coordinate;
    if (!IsMovedByRods(model_.robot.tree, model_.robot.tree.coordinate_joint[Size(coordinate)])) {
      std::vector<Tried> gains = {{fault, FactorOf(fault)}};
      const int files = static_cast<int>(observations_.files.size());
      for (int file = 0; file < files && files > 1; ++file) {
        fault.file = file;
        gains.push_back({fault, FactorOf(fault)});
      }
      fault.file = -1;
      Keep(Try(equations, covariance, derivative, gains, slides));
    }
    fault.kind = ObservationFaultKind::kJointDrift;
    Keep(Try(equations, covariance, derivative, {{fault, FactorOf(fault)}}, slides));
    fault.kind = ObservationFaultKind::kJointOffset;
    Keep(TryFromSomewhereOn(equations, covariance, derivative, fault, slides));
  }

  /// Tries the scale of single files, and of all files only where an earlier calibration tells the
  /// lengths of the robot.
  void TryScales(const NormalEquations& equations, const Eigen::MatrixXd& covariance) {
    const std::vector<Eigen::VectorXd> derivative = DerivativeBy(Scaled(), fit_.values);
    ObservationFault fault;
    fault.kind = ObservationFaultKind::kScale;
    const auto files = static_cast<int>(observations_.files.size());
    for (fault.file = -1; fault.file < files; ++fault.file) {
      if (fault.file < 0 ? model_.earlier.empty() : files < 2) continue;
      Keep(Try(equations, covariance, derivative, {{fault, FactorOf(fault)}}, false));
    }
  }

  /// Tries all tags together, and each by itself.
  void TryTags(const NormalEquations& equations, const Eigen::MatrixXd& covariance) {
    std::set<int> tags;
    for (const Observation& of : observations_.all) {
      const int tag = TagSeenBy(model_.instrument(of.instrument));
      if (tag >= 0) tags.insert(tag);
    }
    if (tags.size() != 1) tags.insert(-1);
    ObservationFault fault;
    fault.kind = ObservationFaultKind::kTagSize;
    for (const int tag : tags) {
      fault.quantity = tag;
      Keep(Try(equations, covariance, DerivativeBy(Undone(fault), fit_.values),
               {{fault, FactorOf(fault)}}, false));
    }
  }

  void TryMove(const NormalEquations& equations, const Eigen::MatrixXd& covariance, int quantity) {
    Observations changed = observations_;
    AddEffect(model_, quantity, 0, changed);
    ObservationFault fault;
    fault.kind = ObservationFaultKind::kMoved;
    fault.quantity = quantity;
    const Quantity& of = model_.setup.quantities[Size(quantity)];
    for (int number = 0; number < of.size(); ++number) {
      ObservedValues values = fit_.values;
      values.effects.emplace_back(kDerivativeStep * Eigen::VectorXd::Unit(of.size(), number));
      const SourceUnit unit = model_.setup.sources[Size(of.sources[Size(number)])].unit;
      if (unit != SourceUnit::kMetre && unit != SourceUnit::kRadian) continue;
      fault.turns = unit == SourceUnit::kRadian;
      Keep(TryFromSomewhereOn(equations, covariance, DerivativeBy(changed, values), fault, false));
    }
  }

  /// Finds joints that are frozen in postures with larger residuals than the others. A joint that
  /// does not move what was measured there (the right arm, while the left hand touches) may well
  /// have rested.
  void TryFrozen() {
    const int count = observations_.posture_count();
    const Eigen::VectorXd squares = SquaresByPosture(at_);
    for (const int c : MovingCoordinates()) {
      auto longest = FindFrozen(observations_, c);
      if (!longest) continue;
      const auto share_of = [&](const Eigen::VectorXd& of) {
        return of.segment(longest->posture, longest->count).sum() / of.sum();
      };
      longest->share = share_of(squares);
      const double fair = static_cast<double>(longest->count) / static_cast<double>(count);
      if (!(longest->share > std::max(kLeastShare, fair))) continue;
      const double moves = share_of(SquaresByPosture(DerivativeBy(Moved(c), fit_.values)));
      if (moves > kLeastMoved * fair) found_.push_back(*longest);
    }
  }

  Eigen::VectorXd SquaresByPosture(const std::vector<Eigen::VectorXd>& blocks) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(observations_.posture_count());
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (posture_[i] >= 0) squares[posture_[i]] += blocks[i].squaredNorm();
    }
    return squares;
  }

  /// Selects one fault of each joint and quantity, the one that explains most first.
  std::vector<ObservationFault> Best() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
    std::vector<ObservationFault> best;
    for (const ObservationFault& fault : found_) {
      const bool known = std::any_of(best.begin(), best.end(), [&](const ObservationFault& one) {
        return one.coordinate == fault.coordinate && one.quantity == fault.quantity &&
               one.kind == fault.kind;
      });
      if (!known) best.push_back(fault);
    }
    return best;
  }

  const ObservedRobot& model_;
  const Observations& observations_;
  const ObservationFit& fit_;
  std::vector<double> weights_;  // by observation
  std::optional<ObservationResiduals> residuals_;
  std::vector<int> posture_;  // by residual block; -1: a prior
  std::vector<Eigen::VectorXd> at_;
  double squares_ = 0.0;  // sum over the observations
  std::vector<ObservationFault> found_;
};

}  // namespace

std::vector<ObservationFault> FindObservationFaults(const ObservedRobot& model,
                                                    const Observations& observations,
                                                    const ObservationFit& fit) {
  return ObservationFaultSearch(model, observations, fit).Run();
}

ObservationFault Refined(ObservationFault fault, const ObservedRobot& model,
                         const Observations& observations) {
  constexpr int kRounds = 2;
  const bool gain = fault.kind == ObservationFaultKind::kJointGain ||
                    fault.kind == ObservationFaultKind::kScale ||
                    fault.kind == ObservationFaultKind::kTagSize;
  if (fault.kind == ObservationFaultKind::kJointFrozen ||
      fault.kind == ObservationFaultKind::kMoved) {
    return fault;
  }
  for (int round = 0; round < kRounds; ++round) {
    const Observations without = WithoutFault(fault, model, observations);
    const ObservationFit fit = EstimateObserved(model, without, {}).fit;
    const double size = ObservationFaultSearch(model, without, fit).Left(fault);
    fault.size = gain ? (1.0 + fault.size) * (1.0 + size) - 1.0 : fault.size + size;
  }
  return fault;
}

}  // namespace elastocal
