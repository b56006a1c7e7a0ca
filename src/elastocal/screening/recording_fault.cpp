// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/recording_fault.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/screening/frame_shifts.hpp"

namespace elastocal {

namespace {

constexpr const char* kPushed = ", or the tracker or the base was pushed";

/// Velocity of an entry of q in a posture of a motion, by the postures before and after, rad/s or
/// m/s; else 0.
double VelocityOf(int coordinate, const Recording& recording, int posture) {
  if (recording.time_s.size() == 0 || recording.trials.empty()) return 0.0;
  const int trial = recording.trial[posture];
  if (!recording.trials[trial].of_motion()) return 0.0;
  const auto within = [&](int i) {
    return i >= 0 && i < recording.posture_count() && recording.trial[i] == trial;
  };
  const int before = within(posture - 1) ? posture - 1 : posture;
  const int after = within(posture + 1) ? posture + 1 : posture;
  const double time = recording.time_s[after] - recording.time_s[before];
  if (!(time > 0.0)) return 0.0;
  return (recording.q(after, coordinate) - recording.q(before, coordinate)) / time;
}

/// The recording with joints that follow a motor of rods by `step`.
Recording WithMotorMoved(const RecordingFault& fault, const RobotTree& tree, double step,
                         const Recording& recording) {
  const Linkage& linkage = tree.linkages[Size(fault.linkage)];
  Recording changed = recording;
  const std::vector<int> joints = CoordinatesOf(tree, linkage);
  for (int i = 0; i < recording.posture_count(); ++i) {
    const Eigen::VectorXd at = recording.q(i, joints).transpose();
    const auto motors = MotorPositions(tree, linkage, at);
    if (!motors) continue;
    if (const auto closure = CloseLinkage(tree, linkage, *motors, {}, at)) {
      changed.q(i, joints) += step * closure->by_motors.col(fault.coordinate).transpose();
    }
  }
  return changed;
}

/// Whether a posture is held and was reached from the one before it.
bool IsReached(const Recording& recording, int posture) {
  if (posture < 1 || recording.trials.empty()) return posture > 0;
  const int trial = recording.trial[posture];
  return recording.trial[posture - 1] == trial && !recording.trials[trial].of_motion();
}

}  // namespace

double LeastSize(FaultKind kind, bool slides) {
  if (kind == FaultKind::kJointLag) return 0.005;
  // A lead screw is more exact than a gear, whose play limits the angle; a larger gain is the scale
  // of the cameras.
  if (kind == FaultKind::kJointGain) return slides ? 0.002 : 0.005;
  if (kind == FaultKind::kUnfinished) return 0.003;
  if (kind == FaultKind::kCameraScale || IsInCameraSpace({kind})) return 0.0015;
  if (kind == FaultKind::kFrameShift) return 1e-3;
  return slides ? 1e-3 : 0.25 * M_PI / 180.0;
}

double LargestSize(FaultKind kind, bool slides) {
  if (kind == FaultKind::kJointLag) return 2.0;
  if (kind == FaultKind::kJointGain || kind == FaultKind::kUnfinished) return 1.0;
  if (IsInCameraSpace({kind})) return 0.1;
  if (kind == FaultKind::kCameraScale) return 0.5;
  if (kind == FaultKind::kFrameShift) return 1.0;
  return slides ? 1.0 : M_PI;
}

bool IsCertain(const RecordingFault& fault, Certainty certainty) {
  constexpr double kLeastSds = 6.0, kLeastOfGiven = 4.0;
  if (certainty == Certainty::kSuspected) return std::abs(fault.size) > kLeastOfGiven * fault.sd;
  const bool like_play = fault.kind == FaultKind::kJointLag || fault.kind == FaultKind::kUnfinished;
  const double left = like_play ? 1.0 : std::sqrt(std::max(0.0, 1.0 - fault.share));
  return std::abs(fault.size) > std::max(kLeastOfGiven, kLeastSds * left) * fault.sd;
}

Eigen::MatrixXd MovesOf(const Recording& recording) {
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(recording.q.rows(), recording.q.cols());
  for (int i = 1; i < recording.posture_count(); ++i) {
    if (IsReached(recording, i)) moves.row(i) = recording.q.row(i) - recording.q.row(i - 1);
  }
  return moves;
}

double FactorOf(const RecordingFault& fault, const Recording& recording, int posture) {
  if (fault.kind == FaultKind::kJointLag) {
    return -VelocityOf(fault.coordinate, recording, posture);
  }
  if (fault.kind == FaultKind::kUnfinished && fault.coordinate >= 0) {
    const int c = fault.coordinate;
    return IsReached(recording, posture) ? recording.q(posture, c) - recording.q(posture - 1, c)
                                         : 0.0;
  }
  const bool in_trial = fault.trial < 0 || recording.trial[posture] == fault.trial;
  const bool within = posture >= fault.posture && (fault.end == 0 || posture < fault.end);
  if (!in_trial || !within) return 0.0;
  if (fault.kind == FaultKind::kJointDrift) {  // 0 in the first posture, 1 in the last
    const int last = (fault.end > 0 ? fault.end : recording.posture_count()) - 1;
    return static_cast<double>(posture - fault.posture) / std::max(1, last - fault.posture);
  }
  return fault.kind == FaultKind::kJointGain ? recording.q(posture, fault.coordinate) : 1.0;
}

std::vector<int> AllTrialsThatMove(const Recording& recording, int coordinate) {
  constexpr double kMoved = 0.2;  // rad or m
  std::vector<int> moving;
  for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (recording.trial[i] != trial) continue;
      least = std::min(least, recording.q(i, coordinate));
      most = std::max(most, recording.q(i, coordinate));
    }
    if (most - least > kMoved) moving.push_back(trial);
  }
  return moving;
}

std::vector<int> TrialsThatMove(const Recording& recording, int coordinate) {
  std::vector<int> moving = AllTrialsThatMove(recording, coordinate);
  if (moving.size() < 2) moving.clear();
  return moving;
}

bool IsInCameraSpace(const RecordingFault& fault) {
  return fault.kind == FaultKind::kCameraAxis || fault.kind == FaultKind::kCameraShear ||
         fault.kind == FaultKind::kCameraBend;
}

Eigen::MatrixXd CameraDisplacements(const RecordingFault& fault, const Recording& recording) {
  const Eigen::MatrixXd& markers = recording.markers;
  if (fault.kind == FaultKind::kCameraScale) return markers;
  Eigen::MatrixXd displacements = Eigen::MatrixXd::Zero(markers.rows(), markers.cols());
  if (fault.kind == FaultKind::kFrameShift) {
    for (int m = 0; m < recording.marker_count(); ++m) {
      displacements.middleCols(3 * m, 3).rowwise() = fault.along.transpose();
    }
    return displacements;
  }
  if (fault.kind != FaultKind::kCameraBend) {
    const int by = fault.kind == FaultKind::kCameraShear ? fault.by_axis : fault.axis;
    for (int m = 0; m < recording.marker_count(); ++m) {
      displacements.col(3 * m + fault.axis) = markers.col(3 * m + by);
    }
    return displacements;
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double count = 0.0, most = 0.0;
  const auto each_seen = [&](const auto& visit) {
    for (int i = 0; i < recording.posture_count(); ++i) {
      for (int m = 0; m < recording.marker_count(); ++m) {
        if (Seen(recording, i, m)) visit(i, m);
      }
    }
  };
  each_seen([&](int i, int m) {
    middle += MarkerPosition(recording, i, m);
    ++count;
  });
  middle /= std::max(1.0, count);
  each_seen([&](int i, int m) {
    most = std::max(most, (MarkerPosition(recording, i, m) - middle).squaredNorm());
  });
  each_seen([&](int i, int m) {
    const Eigen::Vector3d from = MarkerPosition(recording, i, m) - middle;
    displacements.block<1, 3>(i, 3 * m) = (from.squaredNorm() / most * from).transpose();
  });
  return displacements;
}

Recording WithStep(const RecordingFault& fault, const RobotTree& tree, double step,
                   const Recording& recording) {
  if (fault.linkage >= 0) return WithMotorMoved(fault, tree, step, recording);
  Recording changed = recording;
  if (fault.coordinate >= 0) {
    changed.q.col(fault.coordinate).array() += step;
  } else if (fault.kind == FaultKind::kUnfinished) {
    changed.q += step * MovesOf(recording);
  } else {
    changed.markers += step * CameraDisplacements(fault, recording);
  }
  return changed;
}

Recording WithoutFault(const Recording& recording, const RecordingFault& fault) {
  Recording without = recording;
  if (fault.kind == FaultKind::kUnfinished && fault.coordinate < 0) {
    without.q -= fault.size * MovesOf(recording);
    return without;
  }
  if (IsInCameraSpace(fault)) {
    const bool factor = fault.kind == FaultKind::kCameraAxis;
    without.markers -=
        fault.size / (factor ? 1.0 + fault.size : 1.0) * CameraDisplacements(fault, recording);
    return without;
  }
  for (int i = 0; i < recording.posture_count(); ++i) {
    const double factor = FactorOf(fault, recording, i);
    if (fault.kind == FaultKind::kFrameShift) {
      for (int m = 0; m < recording.marker_count(); ++m) {
        without.markers.block<1, 3>(i, 3 * m) -= fault.size * factor * fault.along.transpose();
      }
    } else if (fault.kind == FaultKind::kCameraScale) {
      without.markers.row(i) /= 1.0 + fault.size * factor;
    } else if (fault.kind == FaultKind::kJointGain) {
      if (fault.trial < 0 || recording.trial[i] == fault.trial) {
        without.q(i, fault.coordinate) /= 1.0 + fault.size;
      }
    } else {
      without.q(i, fault.coordinate) -= fault.size * factor;
    }
  }
  return without;
}

bool IsInPartOfTrial(const RecordingFault& fault, const Recording& recording) {
  return fault.trial >= 0 && fault.posture > 0 &&
         recording.trial[fault.posture - 1] == recording.trial[fault.posture];
}

std::string DescribeFault(const RecordingFault& fault, const RobotTree& tree,
                          const Recording& recording) {
  if (fault.kind == FaultKind::kCameraAxis) {
    char sentence[160];
    std::snprintf(sentence, sizeof sentence,
                  "camera positions along %c are %.4f +- %.4f times the true ones, unlike those "
                  "along the other axes",
                  "xyz"[fault.axis], 1.0 + fault.size, fault.sd);
    return sentence;
  }
  if (fault.kind == FaultKind::kUnfinished) {
    char sentence[200];
    const std::string of =
        fault.coordinate < 0 ? "the joints" : LoggedPositionOf(tree, -1, fault.coordinate).name;
    std::snprintf(
        sentence, sizeof sentence,
        ": positions are %s the markers by %.2f +- %.2f %% of each move from the posture "
        "before (%s)",
        fault.size > 0.0 ? "ahead of" : "behind", 100.0 * std::abs(fault.size), 100.0 * fault.sd,
        fault.size > 0.0 ? "measured before the robot came to rest, or commanded positions?"
                         : "a log that is late?");
    return of + sentence;
  }
  if (IsInCameraSpace(fault)) {
    char sentence[200];
    if (fault.kind == FaultKind::kCameraShear) {
      std::snprintf(sentence, sizeof sentence,
                    "the cameras' axes are not square: %c is off by %.4f +- %.4f times %c",
                    "xyz"[fault.axis], fault.size, fault.sd, "xyz"[fault.by_axis]);
    } else {
      std::snprintf(sentence, sizeof sentence,
                    "the cameras' space is distorted: their scale at the outermost marker is %.4f "
                    "+- %.4f times that in the middle",
                    1.0 + fault.size, fault.sd);
    }
    return sentence;
  }
  if (fault.kind == FaultKind::kFrameShift) return DescribeShift(fault, recording);
  const bool joint = fault.kind != FaultKind::kCameraScale;
  const LoggedPosition of = joint ? LoggedPositionOf(tree, fault.linkage, fault.coordinate)
                                  : LoggedPosition{"camera positions"};
  std::string text = of.name;
  const bool slides = of.slides;
  char number[80];
  if (fault.kind == FaultKind::kJointLag) {
    std::snprintf(number, sizeof number, " %.0f +- %.1f ms", 1e3 * std::abs(fault.size),
                  1e3 * fault.sd);
    return text + ": in motions its positions " + (fault.size > 0.0 ? "lag by" : "are early by") +
           number;
  }
  if (fault.kind == FaultKind::kJointOffset || fault.kind == FaultKind::kJointDrift) {
    const double unit = slides ? 1e-3 : M_PI / 180.0;
    const bool drifts = fault.kind == FaultKind::kJointDrift;
    std::snprintf(number, sizeof number, " by %.3f +- %.3f %s", fault.size / unit, fault.sd / unit,
                  slides ? "mm" : "deg");
    text += drifts ? ": its positions drift" : ": its positions are off";
    if (drifts) {
      const std::string of_trial = fault.trial < 0
                                       ? ""
                                       : " of trial " + recording.trials[fault.trial].name +
                                             " (or the markers that it carries creep)";
      return text + number + " from the first posture to the last" + of_trial;
    }
  } else {
    std::snprintf(number, sizeof number, "%s %.4f +- %.4f times the true ones",
                  joint ? ": its positions are" : " are", 1.0 + fault.size, fault.sd);
  }
  text += number;
  if (IsInPartOfTrial(fault, recording)) {
    return text + " from " + DescribePosture(recording, fault.posture) + " to the end of the trial";
  }
  if (fault.end > 0) {
    text += " from " + DescribePosture(recording, fault.posture) + " to " +
            DescribePosture(recording, fault.end - 1);
    return MayBeShift(fault) ? text + kPushed : text;
  }
  if (fault.trial >= 0) return text + " in trial " + recording.trials[fault.trial].name;
  if (fault.posture > 0) text += " from " + DescribePosture(recording, fault.posture) + " on";
  return MayBeShift(fault) ? text + kPushed : text;
}

}  // namespace elastocal
