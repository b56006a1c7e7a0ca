// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/recording_fault.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/move_motors.hpp"

namespace elastocal {

namespace {

/// Of an entry of q in a posture of a motion, by those before and after, rad/s or m/s; else 0.
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

}  // namespace

double FactorOf(const RecordingFault& fault, const Recording& recording, int posture) {
  if (fault.kind == FaultKind::kJointDrift) {
    return static_cast<double>(posture) / std::max(1, recording.posture_count() - 1);
  }
  if (fault.kind == FaultKind::kJointLag) {
    return -VelocityOf(fault.coordinate, recording, posture);
  }
  const bool in_trial = fault.trial < 0 || recording.trial[posture] == fault.trial;
  const bool within = posture >= fault.posture && (fault.end == 0 || posture < fault.end);
  if (!in_trial || !within) return 0.0;
  return fault.kind == FaultKind::kJointGain ? recording.q(posture, fault.coordinate) : 1.0;
}

Recording WithoutFault(const Recording& recording, const RecordingFault& fault) {
  Recording without = recording;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const double factor = FactorOf(fault, recording, i);
    if (fault.kind == FaultKind::kCameraAxis) {
      for (int m = 0; m < recording.marker_count(); ++m) {
        without.markers(i, 3 * m + fault.axis) /= 1.0 + fault.size;
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
    if (drifts) return text + number + " from the first posture to the last";
  } else {
    std::snprintf(number, sizeof number, "%s %.4f +- %.4f times the true ones",
                  joint ? ": its positions are" : " are", 1.0 + fault.size, fault.sd);
  }
  text += number;
  if (IsInPartOfTrial(fault, recording)) {
    return text + " from " + DescribePosture(recording, fault.posture) + " to the end of the trial";
  }
  if (fault.end > 0) {
    return text + " from " + DescribePosture(recording, fault.posture) + " to " +
           DescribePosture(recording, fault.end - 1);
  }
  if (fault.trial >= 0) return text + " in trial " + recording.trials[fault.trial].name;
  return fault.posture > 0 ? text + " from " + DescribePosture(recording, fault.posture) + " on"
                           : text;
}

}  // namespace elastocal
