// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
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
constexpr double kLeastShare = 0.2;
constexpr double kCertain = 4.0;  // standard deviations, in noise that has the fault in it
constexpr int kSplitsTried = 12;  // of the table, after which a fault may begin
constexpr int kFewestFrozen = 5;  // postures
constexpr double kPerDegree = M_PI / 180.0;

/// Sizes from which a fault is none that a good robot and good instruments may have.
double LeastSize(const ObservationFault& fault, bool slides) {
  switch (fault.kind) {
    case ObservationFaultKind::kJointGain:
      return 0.005;
    case ObservationFaultKind::kJointOffset:
      return slides ? 1e-3 : 0.25 * kPerDegree;
    default:
      return fault.turns ? 0.05 * kPerDegree : 0.5e-3;
  }
}

/// Sizes beyond which it is another fault that this one imitates.
double LargestSize(const ObservationFault& fault, bool slides) {
  const double angle = 15.0 * kPerDegree;
  if (fault.kind == ObservationFaultKind::kJointGain) return 0.3;
  if (fault.kind == ObservationFaultKind::kJointOffset) return slides ? 0.1 : angle;
  return fault.turns ? angle : 1.0;
}

/// Adds an effect on the quantity from a posture on.
void AddEffect(const ObservedRobot& model, int quantity, int posture, Observations& observations) {
  const auto effect = static_cast<int>(observations.effects.size());
  observations.effects.push_back({quantity, "moved"});
  for (Observation& observation : observations.all) {
    const std::vector<int>& on = model.instrument(observation.instrument).quantities;
    if (observation.posture < posture || std::find(on.begin(), on.end(), quantity) == on.end()) {
      continue;
    }
    observation.effects.push_back(effect);
  }
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
    for (std::size_t k = 0; k < model_.setup.quantities.size(); ++k) {
      const bool here = model_.setup.quantities[k].of_surroundings;
      if (here && static_cast<int>(k) != model_.root_tilt) {
        TryMove(equations, covariance, static_cast<int>(k));
      }
    }
    TryFrozen();
    return Best();
  }

  /// How much of a fault of a joint's positions is left.
  double Left(const ObservationFault& fault) {
    if (!Linearise()) return 0.0;
    const NormalEquations equations(*residuals_);
    const bool gain = fault.kind == ObservationFaultKind::kJointGain;
    const Eigen::VectorXd factor = gain ? Eigen::VectorXd(observations_.q.col(fault.coordinate))
                                        : FromPostureOn(fault, fault.posture).factor;
    const auto addition =
        equations.Add(DerivativeBy(Moved(fault.coordinate), fit_.values), posture_, factor,
                      InverseOfInformation(equations.information()))[0];
    return -addition.value;
  }

 private:
  /// Evaluates the fit; false where nothing is left.
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

  /// Those of the fit; what it left out counts as far as Huber's weights let it.
  std::vector<double> LimitedWeights() const {
    const std::vector<Eigen::VectorXd> left = LeftOf(model_, observations_, fit_.values);
    std::vector<double> weights;
    for (std::size_t i = 0; i < left.size(); ++i) {
      weights.push_back(
          HuberWeight(model_.instrument(observations_.all[i].instrument), left[i], fit_.spread));
    }
    return weights;
  }

  /// Of the observations.
  std::vector<Eigen::VectorXd> ResidualsOf(const ObservationResiduals& residuals) const {
    std::vector<Eigen::VectorXd> blocks(posture_.size());
    for (int i = 0; i < observations_.count(); ++i) blocks[Size(i)] = residuals.Residual(i);
    return blocks;
  }

  /// Change of the residuals over kDerivativeStep, where observations or values are changed by it.
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

  /// Of joints that were estimated and did move.
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
    Eigen::VectorXd factor = Eigen::VectorXd::Zero(observations_.posture_count());
    factor.tail(observations_.posture_count() - posture).setOnes();
    return {fault, std::move(factor)};
  }

  /// The best of these that is one; nothing where none is.
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
      fault.size = -additions[k].value;  // what is added undoes it
      fault.sd = std::sqrt(additions[k].variance);
      fault.share = additions[k].gain / squares_;
      const double size = std::abs(fault.size);
      const bool is_one = size > kCertain * fault.sd && size > LeastSize(fault, slides) &&
                          size < LargestSize(fault, slides) && fault.share > kLeastShare;
      if (is_one && (!best || fault.share > best->share)) best = fault;
    }
    return best;
  }

  /// From some posture on: evenly over the table first, then near the best.
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
      Keep(Try(equations, covariance, derivative, {{fault, observations_.q.col(coordinate)}},
               slides));
    }
    fault.kind = ObservationFaultKind::kJointOffset;
    Keep(TryFromSomewhereOn(equations, covariance, derivative, fault, slides));
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
      fault.turns =
          model_.setup.sources[Size(of.sources[Size(number)])].unit == SourceUnit::kRadian;
      Keep(TryFromSomewhereOn(equations, covariance, DerivativeBy(changed, values), fault, false));
    }
  }

  /// Joints that are frozen in postures that are worse than the others.
  void TryFrozen() {
    const int count = observations_.posture_count();
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(count);
    for (int i = 0; i < observations_.count(); ++i) {
      squares[posture_[Size(i)]] += at_[Size(i)].squaredNorm();
    }
    for (const int c : MovingCoordinates()) {
      auto longest = FindFrozen(observations_, c);
      if (!longest) continue;
      longest->share = squares.segment(longest->posture, longest->count).sum() / squares_;
      const double fair = static_cast<double>(longest->count) / static_cast<double>(count);
      if (longest->share > std::max(kLeastShare, fair)) found_.push_back(*longest);
    }
  }

  /// One of each joint and quantity, the one that explains most first.
  std::vector<ObservationFault> Best() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
    std::vector<ObservationFault> best;
    for (const ObservationFault& fault : found_) {
      const bool known = std::any_of(best.begin(), best.end(), [&](const ObservationFault& one) {
        return one.coordinate == fault.coordinate && one.quantity == fault.quantity;
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
  double squares_ = 0.0;  // of the observations
  std::vector<ObservationFault> found_;
};

}  // namespace

std::optional<ObservationFault> FindFrozen(const Observations& observations, int coordinate) {
  const auto positions = observations.q.col(coordinate);
  const int count = observations.posture_count();
  ObservationFault longest;
  longest.kind = ObservationFaultKind::kJointFrozen;
  longest.coordinate = coordinate;
  for (int begin = 0, i = 1; i <= count; ++i) {
    if (i < count && positions[i] == positions[begin]) continue;
    if (i - begin > longest.count) {
      longest.posture = begin;
      longest.count = i - begin;
    }
    begin = i;
  }
  if (longest.count < kFewestFrozen || 2 * longest.count > count) return std::nullopt;
  return longest;
}

std::vector<ObservationFault> FindObservationFaults(const ObservedRobot& model,
                                                    const Observations& observations,
                                                    const ObservationFit& fit) {
  return ObservationFaultSearch(model, observations, fit).Run();
}

ObservationFault Refined(ObservationFault fault, const ObservedRobot& model,
                         const Observations& observations) {
  constexpr int kRounds = 2;
  const bool gain = fault.kind == ObservationFaultKind::kJointGain;
  if (!gain && fault.kind != ObservationFaultKind::kJointOffset) return fault;
  for (int round = 0; round < kRounds; ++round) {
    const Observations without = WithoutFault(fault, model, observations);
    const ObservationFit fit = EstimateObserved(model, without, {}).fit;
    const double size = ObservationFaultSearch(model, without, fit).Left(fault);
    fault.size = gain ? (1.0 + fault.size) * (1.0 + size) - 1.0 : fault.size + size;
  }
  return fault;
}

Observations WithoutFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations) {
  if (fault.kind == ObservationFaultKind::kJointFrozen) {
    std::vector<int> others;
    for (int i = 0; i < observations.posture_count(); ++i) {
      if (i < fault.posture || i >= fault.posture + fault.count) others.push_back(i);
    }
    return SelectPostures(observations, others);
  }
  Observations without = observations;
  if (fault.kind == ObservationFaultKind::kJointGain) {
    without.q.col(fault.coordinate) /= 1.0 + fault.size;
  } else if (fault.kind == ObservationFaultKind::kJointOffset) {
    const Eigen::Index rows = observations.posture_count() - fault.posture;
    without.q.col(fault.coordinate).tail(rows).array() -= fault.size;
  } else {
    AddEffect(model, fault.quantity, fault.posture, without);
  }
  return without;
}

std::string DescribeFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations) {
  const PosturePlace& place = observations.postures[Size(fault.posture)];
  const std::string from = observations.files[Size(place.file)] + ":" + std::to_string(place.line);
  char number[120];
  if (fault.kind == ObservationFaultKind::kMoved) {
    std::string name = model.setup.quantities[Size(fault.quantity)].name;
    name = name.substr(0, name.find('.'));
    const double unit = fault.turns ? kPerDegree : 1e-3;
    std::snprintf(number, sizeof number, " was moved by some %.2g %s before ",
                  std::abs(fault.size) / unit, fault.turns ? "deg" : "mm");
    return name + number + from;
  }
  const RobotTree& tree = model.robot.tree;
  const Joint& joint = tree.joints[Size(tree.coordinate_joint[Size(fault.coordinate)])];
  if (fault.kind == ObservationFaultKind::kJointGain) {
    std::snprintf(number, sizeof number, ": its positions are %.4f +- %.4f times the true ones",
                  1.0 + fault.size, fault.sd);
    return joint.name + number;
  }
  if (fault.kind == ObservationFaultKind::kJointFrozen) {
    return joint.name + ": its positions are frozen in " + std::to_string(fault.count) +
           " postures from " + from + " on, while it moved";
  }
  const bool slides = joint.type == JointType::kPrismatic;
  const double unit = slides ? 1e-3 : kPerDegree;
  std::snprintf(number, sizeof number, ": its positions are off by %.3f +- %.3f %s from ",
                fault.size / unit, fault.sd / unit, slides ? "mm" : "deg");
  return joint.name + number + from + " on";
}

}  // namespace elastocal
