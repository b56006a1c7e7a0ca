// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {
namespace {

/// The positions of a posture with the mistake corrected, which is one of a linkage's motors.
Eigen::VectorXd WithoutMotorMistake(const LogSuspicion& suspicion, const RobotTree& tree,
                                    Eigen::VectorXd q) {
  const Linkage& linkage = tree.linkages[Size(suspicion.linkage)];
  const auto undo = [&](Eigen::VectorXd& motors) {
    if (suspicion.kind == LogContradiction::kSign) {
      motors[suspicion.coordinate] *= -1.0;
    } else {
      std::swap(motors[suspicion.coordinate], motors[suspicion.other]);
    }
  };
  if (!MoveMotors(tree, linkage, undo, q)) {
    throw InputError("linkage '" + linkage.name +
                     "' would not close without that mistake: " + NameOf(suspicion, tree));
  }
  return q;
}

/// Undoes the mistake in the directions of the last motions. Where motors were wrong, those of the
/// joints that they move are told anew by the corrected positions.
void UndoInApproach(const LogSuspicion& suspicion, const RobotTree& tree, Recording& corrected) {
  Eigen::MatrixXd& approach = corrected.approach;
  if (approach.rows() == 0) return;
  Eigen::MatrixXd anew;
  std::vector<int> moved;
  if (suspicion.linkage >= 0) {
    anew = ApproachesOf(corrected.q, corrected.trial);
    moved = CoordinatesOf(tree, tree.linkages[Size(suspicion.linkage)]);
  }
  for (const int i : suspicion.postures) {
    for (const int c : moved) approach(i, c) = anew(i, c);
    if (!moved.empty()) continue;
    if (suspicion.kind == LogContradiction::kSign) {
      approach(i, suspicion.coordinate) *= -1.0;
    } else {
      std::swap(approach(i, suspicion.coordinate), approach(i, suspicion.other));
    }
  }
}

}  // namespace

Recording WithoutMistake(const Recording& recording, const LogSuspicion& suspicion,
                         const RobotTree& tree) {
  Recording corrected = recording;
  if (suspicion.kind == LogContradiction::kFrozen) {
    std::vector<int> kept;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!std::binary_search(suspicion.postures.begin(), suspicion.postures.end(), i)) {
        kept.push_back(i);
      }
    }
    return SelectPostures(recording, kept);
  }
  for (int i : suspicion.postures) {
    if (i >= recording.posture_count()) {
      throw std::invalid_argument("a suspicion of another recording");
    }
    if (suspicion.linkage >= 0) {
      corrected.q.row(i) =
          WithoutMotorMistake(suspicion, tree, corrected.q.row(i).transpose()).transpose();
    } else if (suspicion.kind == LogContradiction::kSign) {
      corrected.q(i, suspicion.coordinate) *= -1.0;
    } else {
      std::swap(corrected.q(i, suspicion.coordinate), corrected.q(i, suspicion.other));
    }
  }
  UndoInApproach(suspicion, tree, corrected);
  return corrected;
}

}  // namespace elastocal
