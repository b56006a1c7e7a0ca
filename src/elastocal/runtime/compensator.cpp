// SPDX-License-Identifier: Apache-2.0
#include "elastocal/runtime/compensator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "elastocal/runtime/core_correction.h"

namespace elastocal {
namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;

/// Allocates one store for arrays of these lengths, and sets a pointer to each.
template <typename Store, typename Parts>
void HandOut(Store& store, const Parts& parts) {
  std::size_t size = 0;
  for (const auto& part : parts) size += static_cast<std::size_t>(part.second);
  store.resize(size);
  auto* next = store.data();
  for (const auto& part : parts) {
    *part.first = next;
    next += part.second;
  }
}

Eigen::Isometry3d ToIsometry(const ec_pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.R);
  T.translation() = Eigen::Map<const Eigen::Vector3d>(pose.p);
  return T;
}

void SetPose(const Eigen::Isometry3d& T, ec_pose& pose) {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(pose.R);
  R = T.linear();
  Eigen::Map<Eigen::Vector3d> p(pose.p);
  p = T.translation();
}

void CheckOptions(const CompensatorOptions& options) {
  const bool good = options.torque_time_constant_s >= 0.0 && options.period_s > 0.0 &&
                    options.largest_turn_rad > 0.0 && options.largest_turn_rad <= 0.3 &&
                    options.largest_shift_m > 0.0 && options.largest_correction_rad > 0.0;
  if (!good) {
    throw std::invalid_argument(
        "options of the compensator: positive times and limits were expected, turns of at most "
        "0.3 rad");
  }
}

}  // namespace

std::string DescribeStatus(CompensatorStatus status) {
  constexpr std::pair<CompensatorStatus, const char*> kTexts[] = {
      {EC_BAD_POSITION,
       "positions that are not finite, or too few: the last good ones were used; or a wanted pose "
       "that is not finite or no rotation: those of the nominal robot were used"},
      {EC_BAD_TORQUE,
       "torques that are not finite, or of a wrong number: the last good ones were used, or those "
       "of "
       "statics"},
      {EC_BAD_SUPPORT, "an unknown foot: the last good support was used"},
      {EC_DEFLECTION_CUT, "a deflection beyond its limit was cut"},
      {EC_CORRECTION_CUT, "a correction is at its limit, and the end of a limb not in its place"},
      {EC_JOINT_LIMIT, "a joint is at its limit, and the end of a limb not in its place"},
      {EC_NOTHING_YET,
       "no good positions so far: those of the zero posture were used (of a command: those from "
       "which "
       "the motion starts, where these are known)"}};
  std::string text;
  for (const auto& [bit, words] : kTexts) {
    if ((status & bit) == 0) continue;
    text += (text.empty() ? "" : "; ") + std::string(words);
  }
  return text;
}

Compensator::Compensator(RuntimeModel model, const CompensatorOptions& options)
    : model_(std::move(model)), branches_(FindBranches(model_)) {
  if (model_.calibrated.empty() || model_.feet.size() > 32) {
    throw std::invalid_argument(
        "compensator: a robot with joints and at most 32 feet was expected");
  }
  CheckOptions(options);
  Link(branches_, options);
  Allocate();
  ec_reset(&robot_, &memory_);
}

void Compensator::Link(const RuntimeBranches& branches, const CompensatorOptions& options) {
  const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
  robot_.joints = count(model_.calibrated);
  robot_.coordinates = count(model_.lower);
  robot_.links = count(model_.links);
  robot_.feet = count(model_.feet);
  robot_.tips = count(model_.tips);
  robot_.branches = count(branches.branch_size);
  robot_.shifts = count(model_.shifts);
  robot_.nominal = model_.nominal.data();
  robot_.calibrated = model_.calibrated.data();
  robot_.mass = model_.mass.data();
  robot_.moment = model_.moment.data();
  robot_.leg_of_body = model_.leg_of_body.data();
  robot_.link = model_.links.data();
  robot_.foot = model_.feet.data();
  robot_.tip = model_.tips.data();
  robot_.shift = model_.shifts.data();
  robot_.branch_of_coordinate = branches.branch_of_coordinate.data();
  robot_.column_of_coordinate = branches.column_of_coordinate.data();
  robot_.branch_size = branches.branch_size.data();
  robot_.lower = model_.lower.data();
  robot_.upper = model_.upper.data();
  robot_.total_mass = 0.0;
  for (double mass : model_.mass) robot_.total_mass += mass;
  std::copy(model_.gravity.begin(), model_.gravity.end(), robot_.gravity);
  std::copy(model_.suspension.begin(), model_.suspension.end(), robot_.suspension);
  robot_.torque_gain = options.period_s / (options.period_s + options.torque_time_constant_s);
  robot_.largest_turn = options.largest_turn_rad;
  robot_.largest_shift = options.largest_shift_m;
  robot_.largest_correction = options.largest_correction_rad;
}

void Compensator::Allocate() {
  const int joints = robot_.joints, coordinates = robot_.coordinates, feet = robot_.feet;
  int largest = 1;
  for (int size : branches_.branch_size) largest = std::max(largest, size);
  const std::pair<double**, int> doubles[] = {{&memory_.axis, 3 * joints},
                                              {&memory_.beyond, 4 * (joints + 1)},
                                              {&memory_.load, 3 * joints},
                                              {&memory_.root_load, 3 * joints},
                                              {&memory_.normal, largest * largest},
                                              {&memory_.factor, largest * largest},
                                              {&memory_.gradient, largest},
                                              {&memory_.step, largest},
                                              {&memory_.column, 6 * 64},
                                              {&memory_.good_q, 3 * coordinates},
                                              {&memory_.good_torque, 3 * joints},
                                              {&memory_.work_q, coordinates},
                                              {&memory_.best_q, coordinates},
                                              {&memory_.kept_q, coordinates},
                                              {&memory_.start_q, coordinates},
                                              {&memory_.lowest, coordinates},
                                              {&memory_.highest, coordinates},
                                              {&memory_.most_change, coordinates},
                                              {&memory_.last_q, coordinates},
                                              {&memory_.last_command, coordinates},
                                              {&memory_.given, coordinates},
                                              {&memory_.pace, coordinates},
                                              {&memory_.shift, joints},
                                              {&memory_.side, 2 * robot_.shifts},
                                              {&memory_.from, 2 * robot_.shifts},
                                              {&memory_.centre, 3 * feet},
                                              {&memory_.share, feet},
                                              {&memory_.motion, 3 * joints}};
  const std::pair<ec_pose**, int> poses[] = {{&memory_.body, joints + 1},
                                             {&memory_.twisted, joints},
                                             {&memory_.target, robot_.tips},
                                             {&memory_.sole, feet},
                                             {&links_, robot_.links},
                                             {&wanted_, robot_.tips},
                                             {&memory_.last_target, robot_.tips}};
  HandOut(numbers_, doubles);
  HandOut(poses_, poses);
  const std::pair<int**, int> whole[] = {{&memory_.held, largest}, {&memory_.loosed, largest}};
  HandOut(whole_, whole);
  search_.resize(branches_.branch_size.size());
  memory_.search = search_.data();
  stopped_.resize(static_cast<std::size_t>(coordinates));
  memory_.stopped = stopped_.data();
  not_finite_.assign(static_cast<std::size_t>(std::max(joints, coordinates)),
                     std::numeric_limits<double>::quiet_NaN());
  rigid_ = Eigen::VectorXd::Zero(coordinates);
  command_ = Eigen::VectorXd::Zero(coordinates);
}

const double* Compensator::Positions(const Vector& q) const noexcept {
  return q.size() == robot_.coordinates ? q.data() : not_finite_.data();
}

const double* Compensator::Torques(const Vector& torque) const noexcept {
  if (torque.size() == 0) return nullptr;
  return torque.size() == robot_.joints ? torque.data() : not_finite_.data();
}

/// Torques of a wrong number, even if none were known before.
CompensatorStatus Compensator::SizeStatus(const Vector& torque) const noexcept {
  return torque.size() == 0 || torque.size() == robot_.joints ? EC_FINE : EC_BAD_TORQUE;
}

CompensatorStatus Compensator::Forward(const Vector& q, const Vector& torque,
                                       StandingFeet feet) noexcept {
  return SizeStatus(torque) |
         ec_forward(&robot_, Positions(q), Torques(torque), feet, &memory_, links_, &root_);
}

CompensatorStatus Compensator::Correct(const Vector& q, const Vector& torque,
                                       StandingFeet feet) noexcept {
  return SizeStatus(torque) | ec_correct(&robot_, Positions(q), Torques(torque), feet, &memory_,
                                         rigid_.data(), displacement_.data());
}

CompensatorStatus Compensator::Command(const Vector& nominal, const Vector& torque,
                                       StandingFeet feet) noexcept {
  return SizeStatus(torque) | ec_command(&robot_, Positions(nominal), Torques(torque), feet,
                                         &memory_, command_.data(), residual_);
}

CompensatorStatus Compensator::Command(const Eigen::Isometry3d* T_root_tip, const Vector& nominal,
                                       const Vector& torque, StandingFeet feet) noexcept {
  for (int t = 0; t < robot_.tips; ++t) SetPose(T_root_tip[t], wanted_[t]);
  return SizeStatus(torque) | ec_command_poses(&robot_, wanted_, Positions(nominal),
                                               Torques(torque), feet, &memory_, command_.data(),
                                               residual_);
}

bool Compensator::LimitChanges(const Vector& most) noexcept {
  if (most.size() != 0 && most.size() != robot_.coordinates) return false;
  ec_limit_changes(&robot_, most.size() == 0 ? nullptr : most.data(), &memory_);
  return true;
}

void Compensator::EaseChanges(double calls) noexcept { ec_ease_changes(calls, &memory_); }

void Compensator::Forget() noexcept { ec_forget(&robot_, &memory_); }

bool Compensator::StartFrom(const Vector& command) noexcept {
  return ec_start_from(&robot_, Positions(command), &memory_) != 0;
}

Eigen::Isometry3d Compensator::link_pose(int link) const noexcept {
  return ToIsometry(links_[link]);
}

double Compensator::left_m(int coordinate) const noexcept {
  const int branch = robot_.branch_of_coordinate[coordinate];
  return branch < 0 ? 0.0 : std::sqrt(search_[static_cast<std::size_t>(branch)].left);
}

double Compensator::tip_left_m(int tip) const noexcept {
  ec_pose now;
  double error[6];
  ec_tip_pose(&robot_, tip, &memory_, &now);
  ec_tip_error(&now, &memory_.target[tip], robot_.tip[tip].arm, error);
  return std::sqrt(ec_dot(error, error) + ec_dot(&error[3], &error[3]));
}

double Compensator::tip_left_rad(int tip) const noexcept {
  ec_pose now;
  double error[6];
  ec_tip_pose(&robot_, tip, &memory_, &now);
  ec_tip_error(&now, &memory_.target[tip], 1.0, error);
  return std::sqrt(ec_dot(&error[3], &error[3]));
}

Eigen::Isometry3d Compensator::root_pose() const noexcept { return ToIsometry(root_); }

}  // namespace elastocal
