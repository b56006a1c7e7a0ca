// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/frame_shifts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/LU>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {
namespace {

constexpr double kMoreNumbers = 2.0;  // of a direction

using Blocks = std::vector<Eigen::VectorXd>;
using Additions = std::vector<NormalEquations::Addition>;

Blocks Sum(const Blocks& a, const Blocks& b) {
  Blocks sum = a;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += b[i];
  return sum;
}

/// Information about an unknown beside all others; 0 where they reproduce it.
double InformationOf(const NormalEquations::Addition& addition) {
  return addition.variance > 0.0 ? 1.0 / addition.variance : 0.0;
}

/// The displacement that three axes together tell, and what it explains; zeros where the others
/// reproduce a direction.
struct Push {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  double gain = 0.0;
};

Push Together(const Eigen::Matrix3d& information, const Eigen::Vector3d& score) {
  constexpr double kLeastTold = 1e-6;  // of the information about each axis by itself
  const double apart = information.diagonal().prod();
  if (!(information.determinant() > kLeastTold * apart)) return {};
  Push push;
  push.value = information.inverse() * score;
  push.gain = score.dot(push.value);
  return push;
}

}  // namespace

void MeasureShifts(const NormalEquations& equations, const std::vector<Blocks>& by_axis,
                   const std::vector<int>& cluster, const Eigen::MatrixXd& factors,
                   const Eigen::MatrixXd& covariance, double variance,
                   std::vector<RecordingFault>& shifts) {
  const auto add = [&](const Blocks& derivative) {
    return equations.Add(derivative, cluster, factors, covariance);
  };
  // The information about two axes together follows from that about their sum.
  std::vector<Additions> along, across;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    along.push_back(add(by_axis[axis]));
    across.push_back(add(Sum(by_axis[axis], by_axis[(axis + 1) % 3])));
  }
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    Eigen::Matrix3d information;
    Eigen::Vector3d score;
    for (int axis = 0; axis < 3; ++axis) {
      const NormalEquations::Addition& one = along[Size(axis)][k];
      information(axis, axis) = InformationOf(one);
      score[axis] = information(axis, axis) * one.value;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3;
      information(axis, next) = information(next, axis) =
          0.5 * (InformationOf(across[Size(axis)][k]) - information(axis, axis) -
                 information(next, next));
    }
    const Push push = Together(information, score);
    const double beyond = push.gain / variance - kMoreNumbers;
    if (!(beyond > 0.0)) continue;
    RecordingFault& shift = shifts[k];
    shift.size = push.value.norm();
    shift.along = -push.value / shift.size;  // what has to be added is minus the fault
    shift.sd = shift.size / std::sqrt(beyond);
    shift.share = beyond * variance;
  }
}

void PreferSlides(const RobotTree& tree, std::vector<RecordingFault>& faults) {
  constexpr double kAsMuch = 0.95;
  const std::vector<RecordingFault> all = faults;
  const auto slides = [&](const RecordingFault& one) {
    return one.kind == FaultKind::kJointOffset && one.linkage < 0 &&
           JointOfCoordinate(tree, one.coordinate).type == JointType::kPrismatic;
  };
  const auto shifts = [](const RecordingFault& one) { return one.kind == FaultKind::kFrameShift; };
  const auto together = [](const RecordingFault& one, const RecordingFault& other) {
    return one.posture == other.posture && one.end == other.end;
  };
  // With what chance explains by the numbers of its direction.
  const auto whole_share = [](const RecordingFault& shift) {
    return shift.share * (1.0 + kMoreNumbers * std::pow(shift.sd / shift.size, 2));
  };
  for (RecordingFault& joint : faults) {
    const auto shift = std::ranges::find_if(all, [&](const RecordingFault& one) {
      return slides(joint) && shifts(one) && together(one, joint) &&
             whole_share(one) >= kAsMuch * joint.share;
    });
    if (shift != all.end()) joint.along = shift->along;
  }
  std::erase_if(faults, [&](const RecordingFault& shift) {
    return shifts(shift) && std::ranges::any_of(all, [&](const RecordingFault& one) {
             return slides(one) && together(one, shift) && one.share >= kAsMuch * shift.share;
           });
  });
}

void AddShift(const RecordingFault& more, RecordingFault& shift) {
  const Eigen::Vector3d sum = shift.size * shift.along + more.size * more.along;
  shift.size = sum.norm();
  if (shift.size > 0.0) shift.along = sum / shift.size;
}

std::string DescribeShift(const RecordingFault& shift, const Recording& recording) {
  const Eigen::Vector3d by = 1e3 * shift.size * shift.along;
  char size[120];
  std::snprintf(size, sizeof size, "%.2f +- %.2f mm elsewhere ([%.1f, %.1f, %.1f] mm)",
                1e3 * std::abs(shift.size), 1e3 * shift.sd, by.x(), by.y(), by.z());
  const std::string until =
      shift.end > 0 ? " to " + DescribePosture(recording, shift.end - 1) : " on";
  return std::string("the frame of the markers lies ") + size + " from " +
         DescribePosture(recording, shift.posture) + until +
         " (the tracker or the base was pushed?)";
}

}  // namespace elastocal
