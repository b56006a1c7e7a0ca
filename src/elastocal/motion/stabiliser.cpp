// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/stabiliser.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/smooth_step.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

Eigen::Vector3d Level(const Eigen::Vector2d& v) { return {v.x(), v.y(), 0.0}; }

/// Where a sole is pressed, in its axes, m.
Eigen::Vector2d CentreOfPressure(const Vector6d& wrench) {
  return ZeroMomentPoint(wrench.head<3>(), wrench.tail<3>());
}

Eigen::Vector2d Within(const Eigen::Vector2d& v, double largest) {
  return v.cwiseMax(-largest).cwiseMin(largest);
}

}  // namespace

Stabiliser::Stabiliser(const RobotTree& tree, const std::vector<Sole>& soles,
                       const StabiliserOptions& options)
    : tree_(tree),
      options_(options),
      inertias_(BodyInertias(tree)),
      correction_(Eigen::VectorXd::Zero(tree.coordinate_count())) {
  for (const Sole& sole : soles) {
    legs_.emplace_back(tree, sole, soles);
    middle_.push_back(sole.centre());
  }
  if (!legs_.empty()) leg_length_ = legs_[0].length();
  weight_ = TotalMass(tree) * kGravity.norm();
  frequency_ = std::sqrt(kGravity.norm() / leg_length_);
  shifts_.assign(legs_.size(), Eigen::Vector2d::Zero());
  turns_ = shifts_;
}

Eigen::VectorXd Stabiliser::Correct(const Eigen::VectorXd& planned, const std::vector<int>& support,
                                    const StandingSense& sense, double interval_s) {
  const auto stands = [&](const LegChain& leg) {
    return std::find(support.begin(), support.end(), leg.sole_link()) != support.end();
  };
  const auto standing = std::find_if(legs_.begin(), legs_.end(), stands);
  if (standing == legs_.end()) return planned + correction_;
  PlaceSoles(planned, support);
  StandOn(static_cast<int>(standing - legs_.begin()));
  ShareWeight(planned, support);
  const StandingSense sensed = InSoleAxes(planned, sense);
  LearnTurn(sensed, interval_s);
  LearnFeet(sensed, interval_s);
  LearnHeight(sensed, interval_s);
  LearnShift(planned, sensed, interval_s);
  const double largest = options_.largest_speed * interval_s;
  correction_ += (Corrected(planned) - planned - correction_).cwiseMax(-largest).cwiseMin(largest);
  return planned + correction_;
}

void Stabiliser::PlaceSoles(const Eigen::VectorXd& planned, const std::vector<int>& support) {
  T_root_sole_.clear();
  std::vector<Eigen::Vector3d> balls;
  for (const LegChain& leg : legs_) {
    T_root_sole_.push_back(leg.SolePose(planned));
    const bool stands = std::find(support.begin(), support.end(), leg.sole_link()) != support.end();
    if (leg.on_ball() && stands) balls.emplace_back(T_root_sole_.back().translation());
  }
  if (balls.size() < 3) return;
  const Eigen::Matrix3d axes = FloorAxes(balls);
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    if (legs_[i].on_ball()) T_root_sole_[i].linear() = axes;
  }
}

StandingSense Stabiliser::InSoleAxes(const Eigen::VectorXd& planned,
                                     const StandingSense& sense) const {
  StandingSense turned = sense;
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    if (!legs_[i].on_ball()) continue;
    const Eigen::Matrix3d R =
        T_root_sole_[i].linear().transpose() * legs_[i].SolePose(planned).linear();
    const auto column = static_cast<Eigen::Index>(i);
    turned.wrenches.col(column).head<3>() = R * sense.wrenches.col(column).head<3>();
    turned.wrenches.col(column).tail<3>() = R * sense.wrenches.col(column).tail<3>();
  }
  return turned;
}

/// Expresses the filtered error in the axes of another sole.
void Stabiliser::StandOn(int reference) {
  if (reference == reference_) return;
  const Eigen::Matrix3d R =
      T_root_sole_[Size(reference)].linear().transpose() * T_root_sole_[Size(reference_)].linear();
  off_ = (R * Level(off_)).head<2>();
  reference_ = reference;
}

/// Sets the share of the weight that the plan puts on each sole: by the lever rule for two, equal
/// shares for more.
void Stabiliser::ShareWeight(const Eigen::VectorXd& planned, const std::vector<int>& support) {
  share_.resize(static_cast<Eigen::Index>(legs_.size()));
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const bool stands =
        std::find(support.begin(), support.end(), legs_[i].sole_link()) != support.end();
    share_[static_cast<Eigen::Index>(i)] = stands ? 1.0 / static_cast<double>(support.size()) : 0.0;
  }
  if (legs_.size() != 2 || share_.minCoeff() == 0.0) return;
  const Eigen::Vector3d com = CentreOfMass(tree_, inertias_, planned);
  const Eigen::Vector3d first = T_root_sole_[0] * Level(middle_[0]);
  const Eigen::Vector3d across = T_root_sole_[1] * Level(middle_[1]) - first;
  share_[1] = std::clamp((com - first).dot(across) / across.squaredNorm(), 0.0, 1.0);
  share_[0] = 1.0 - share_[1];
}

Eigen::Vector2d Stabiliser::Blend(const std::vector<Eigen::Vector2d>& by_sole) const {
  const Eigen::Matrix3d R_reference_root = T_root_sole_[Size(reference_)].linear().transpose();
  Eigen::Vector3d blend = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < by_sole.size(); ++i) {
    const Eigen::Vector3d own = T_root_sole_[i].linear() * Level(by_sole[i]);
    blend += share_[static_cast<Eigen::Index>(i)] * R_reference_root * own;
  }
  return blend.head<2>();
}

void Stabiliser::Learn(const Eigen::Vector2d& change, double largest,
                       std::vector<Eigen::Vector2d>& by_sole) {
  const Eigen::Matrix3d& R_root_reference = T_root_sole_[Size(reference_)].linear();
  const Eigen::Vector3d of_all = R_root_reference * Level(change) / share_.squaredNorm();
  for (std::size_t i = 0; i < by_sole.size(); ++i) {
    const Eigen::Vector3d own = T_root_sole_[i].linear().transpose() * of_all;
    by_sole[i] = Within(by_sole[i] + share_[static_cast<Eigen::Index>(i)] * own.head<2>(), largest);
  }
}

void Stabiliser::LearnTurn(const StandingSense& sense, double interval_s) {
  // If nothing leans, the upward direction by the inertial unit is the sole's z axis.
  const Eigen::Vector3d up =
      T_root_sole_[Size(reference_)].linear().transpose() * sense.R_world_root.row(2).transpose();
  const Eigen::Vector2d lean = up.cross(Eigen::Vector3d::UnitZ()).head<2>();
  Learn(-options_.turn_rate * frequency_ * interval_s * lean, options_.largest_turn, turns_);
  turn_ = Blend(turns_);
}

bool Stabiliser::BothPressed(const StandingSense& sense) const {
  return legs_.size() == 2 && sense.wrenches.row(2).minCoeff() >= options_.least_pressure * weight_;
}

void Stabiliser::LearnFeet(const StandingSense& sense, double interval_s) {
  if (!BothPressed(sense)) return;
  const Eigen::Vector2d apart =
      CentreOfPressure(sense.wrenches.col(0)) - CentreOfPressure(sense.wrenches.col(1));
  const Eigen::Vector2d turn(apart.y(), -apart.x());  // lifts the edge that is loaded more
  foot_ =
      Within(foot_ + options_.foot_rate / leg_length_ * interval_s * turn, options_.largest_turn);
}

void Stabiliser::LearnHeight(const StandingSense& sense, double interval_s) {
  if (!BothPressed(sense)) return;
  const Transform T_reference_root = T_root_sole_[Size(reference_)].inverse();
  std::array<Eigen::Vector2d, 2> middle;
  Eigen::Vector2d off_middle = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < 2; ++i) {
    const auto wrench = sense.wrenches.col(static_cast<Eigen::Index>(i));
    const Transform T_reference_sole = T_reference_root * T_root_sole_[i];
    middle[i] = (T_reference_sole * Level(middle_[i])).head<2>();
    const Eigen::Vector2d off = CentreOfPressure(wrench) - middle_[i];
    off_middle += wrench[2] / sense.wrenches.row(2).sum() *
                  (T_reference_sole.linear() * Level(off)).head<2>();
  }
  const Eigen::Vector2d across = middle[0] - middle[1];
  // A first foot that is too low presses both on the sides towards the second one.
  const double largest = options_.largest_turn * across.norm();
  height_ -= options_.height_rate / leg_length_ * interval_s * off_middle.dot(across);
  height_ = std::clamp(height_, -largest, largest);
}

std::optional<Eigen::Vector2d> Stabiliser::Off(const Eigen::VectorXd& planned,
                                               const StandingSense& sense) const {
  const Transform T_reference_root = T_root_sole_[Size(reference_)].inverse();
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const Transform T = T_reference_root * T_root_sole_[i];
    const auto wrench = sense.wrenches.col(static_cast<Eigen::Index>(i));
    const Eigen::Vector3d pressed = T.linear() * wrench.head<3>();
    force += pressed;
    moment += T.linear() * wrench.tail<3>() + T.translation().cross(pressed);
  }
  if (!(force.z() > options_.least_pressure * weight_)) return std::nullopt;
  const Eigen::Vector3d com =
      T_reference_root * (CentreOfMass(tree_, inertias_, planned) + com_off_);
  return ZeroMomentPoint(force, moment) - com.head<2>();
}

void Stabiliser::TakeRest(const Eigen::VectorXd& planned, const std::vector<int>& support,
                          const StandingSense& sense) {
  PlaceSoles(planned, support);
  const std::optional<Eigen::Vector2d> off = Off(planned, InSoleAxes(planned, sense));
  if (off) com_off_ += T_root_sole_[Size(reference_)].linear() * Level(*off);
}

void Stabiliser::LearnShift(const Eigen::VectorXd& planned, const StandingSense& sense,
                            double interval_s) {
  shift_ = Blend(shifts_);
  const std::optional<Eigen::Vector2d> off = Off(planned, sense);
  if (!off) return;
  off_ += std::min(1.0, interval_s / options_.filter_s) * (*off - off_);
  Learn(-options_.shift_rate * frequency_ * interval_s * off_, options_.largest_shift * leg_length_,
        shifts_);
  shift_ = Blend(shifts_);
}

Eigen::VectorXd Stabiliser::Corrected(const Eigen::VectorXd& planned) const {
  const Transform T_root_reference = T_root_sole_[Size(reference_)];
  Eigen::VectorXd corrected = planned;
  struct Moved {
    std::size_t leg;
    double share, largest;  // largest: rad
  };
  std::vector<Moved> standing, lifted;
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const double height = (T_root_reference.inverse() * T_root_sole_[i]).translation().z();
    const double share =
        1.0 - SmoothStep((height / leg_length_ - options_.low) / (options_.high - options_.low));
    if (share == 0.0) continue;
    Transform T_reference_root = T_root_reference.inverse();
    T_reference_root.linear() =
        RotationFromVector(share * Level(turn_)) * T_reference_root.linear();
    T_reference_root.translation() += share * Level(shift_);
    const Eigen::Vector2d foot = i == 0 ? foot_ : Eigen::Vector2d(-foot_);
    Transform T_moved_sole = (T_root_reference * T_reference_root).inverse() * T_root_sole_[i];
    T_moved_sole.linear() = T_moved_sole.linear() * RotationFromVector(share * Level(foot));
    T_moved_sole.translation() +=
        share * (i == 0 ? 0.5 : -0.5) * height_ * T_moved_sole.linear().col(2);
    const std::vector<int>& leg = legs_[i].coordinates();
    if (!legs_[i].PlaceFlat(T_moved_sole, corrected)) {
      corrected(leg) = planned(leg) + correction_(leg);
    }
    const Eigen::VectorXd moved = corrected(leg) - planned(leg);
    (share_[static_cast<Eigen::Index>(i)] > 0.0 ? standing : lifted)
        .push_back({i, share, moved.cwiseAbs().maxCoeff()});
  }
  // Near its full length, a small displacement of the sole needs large motions of the joints.
  constexpr double kMoreThanStanding = 2.0, kUsual = 0.1;  // rad
  double most = kUsual;
  for (const Moved& leg : standing) most = std::max(most, kMoreThanStanding * leg.largest);
  for (const Moved& leg : lifted) {
    const double kept = std::min(1.0, leg.share * most / std::max(leg.largest, 1e-12));
    for (const int c : legs_[leg.leg].coordinates()) {
      corrected[c] = planned[c] + kept * (corrected[c] - planned[c]);
    }
  }
  return corrected;
}

}  // namespace elastocal
