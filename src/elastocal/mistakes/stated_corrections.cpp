// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/stated_corrections.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kLeastFactor = 0.5, kLargestFactor = 2.0;
constexpr double kLargestOffsetDeg = 60.0, kLargestOffsetMm = 200.0;

/// Unit of an offset in files.
double UnitOf(const LoggedPosition& logged) { return logged.slides ? 1e-3 : M_PI / 180.0; }

[[noreturn]] void Refuse(const std::string& name, const std::string& why) {
  throw InputError("--accept " + name + ": " + why);
}

/// Linkage and entry (LoggedPositionOf) of a joint or motor named in `--accept`.
std::pair<int, int> FindLogged(const std::string& name, const std::string& of,
                               const RobotTree& tree) {
  const MotorIndex motor = FindMotor(tree, of);
  if (motor.linkage >= 0) return {motor.linkage, motor.rod};
  for (const Joint& joint : tree.joints) {
    if (joint.name == of && joint.coordinate >= 0) return {-1, joint.coordinate};
  }
  Refuse(name, "the robot has no moving joint '" + of + "'");
}

void CheckSize(const std::string& name, double size, double least, double largest,
               const char* unit) {
  if (size >= least && size <= largest) return;
  Refuse(name, fmt::format("a size from {:g} to {:g}{} was expected", least, largest, unit));
}

/// Makes the correction in one recording; returns whether the recording has the trial.
bool ApplyTo(const StatedCorrection& correction, const RobotTree& tree, Recording& recording) {
  bool found = correction.trial.empty(), reached = false;
  int number = 0;  // number of the posture in the trial
  for (int i = 0; i < recording.posture_count(); ++i) {
    const bool here =
        correction.trial.empty() ||
        (!recording.trial.empty() &&
         recording.trials[static_cast<std::size_t>(recording.trial[static_cast<std::size_t>(i)])]
                 .name == correction.trial);
    if (!here) continue;
    found = true;
    if (++number < correction.from) continue;
    reached = true;
    if (correction.kind == FaultKind::kCameraScale) {
      recording.markers.row(i) /= correction.size;
      continue;
    }
    const auto undo = [&](double& position) {
      if (correction.kind == FaultKind::kJointGain) {
        position /= correction.size;
      } else {
        position -= correction.size;
      }
    };
    if (correction.linkage < 0) {
      undo(recording.q(i, correction.coordinate));
      continue;
    }
    const Linkage& linkage = tree.linkages[static_cast<std::size_t>(correction.linkage)];
    Eigen::VectorXd q = recording.q.row(i).transpose();
    const auto undo_motor = [&](Eigen::VectorXd& motors) { undo(motors[correction.coordinate]); };
    if (!MoveMotors(tree, linkage, undo_motor, q)) {
      throw InputError(fmt::format("--accept: the rods of linkage '{}' would not close in {}",
                                   linkage.name, DescribePosture(recording, i)));
    }
    recording.q.row(i) = q.transpose();
  }
  if (found && !reached && number > 0) {
    throw InputError(fmt::format(
        "--accept: {} has {} postures; one of them was expected instead of {}",
        correction.trial.empty() ? std::string("the table") : "trial '" + correction.trial + "'",
        number, correction.from));
  }
  return found;
}

/// Removes ":4" from the end of the name of a trial, or of a joint in a table.
void ReadFirstPosture(const std::string& name, std::string& of, StatedCorrection& correction) {
  const std::size_t colon = of.rfind(':');
  if (colon == std::string::npos) return;
  const std::string text = of.substr(colon + 1);
  const std::optional<double> number = ParseNumber(text);
  if (!number || !(*number >= 1.0 && *number <= 1e6) || *number != std::floor(*number)) {
    Refuse(name, "'" + text + "' is not the number of a posture, from 1");
  }
  correction.from = static_cast<int>(*number);
  of.resize(colon);
}

/// The names that correct an offset in all trials from a posture on.
std::string NamesFromPosture(const RecordingFault& fault, const LoggedPosition& logged,
                             const Recording& recording) {
  const auto trial_of = [&](int posture) {
    return recording.trial[static_cast<std::size_t>(posture)];
  };
  const int first = trial_of(fault.posture);
  int begin = 0;
  while (trial_of(begin) != first) ++begin;
  std::string names;
  for (int i = fault.posture; i < recording.posture_count(); ++i) {
    if (i > fault.posture && trial_of(i) == trial_of(i - 1)) continue;
    const int from = trial_of(i) == first ? i - begin + 1 : 1;
    names += fmt::format("{}offset:{}@{}{}={:.4f}", names.empty() ? "" : " ", logged.name,
                         recording.trials[static_cast<std::size_t>(trial_of(i))].name,
                         from > 1 ? fmt::format(":{}", from) : "", fault.size / UnitOf(logged));
  }
  return names;
}

std::string InWords(const StatedCorrection& correction, const RobotTree& tree) {
  const std::string where = correction.trial.empty() ? "" : " in trial " + correction.trial;
  if (correction.kind == FaultKind::kCameraScale) {
    return fmt::format("the cameras' positions{} were divided by {:g}", where, correction.size);
  }
  if (correction.kind == FaultKind::kJointGain) {
    std::string text = fmt::format("the positions of {}{} were divided by {:g}", correction.joint,
                                   where, correction.size);
    if (!correction.trial.empty()) return text;
    return text +
           ": all figures are of positions so divided; where the robot has this gain, and not the "
           "log alone, its controller has to divide them too";
  }
  const LoggedPosition logged = LoggedPositionOf(tree, correction.linkage, correction.coordinate);
  const std::string from =
      correction.from > 1 ? fmt::format(" from posture {} on", correction.from) : "";
  return fmt::format("{:g} {} were taken from the positions of {}{}{}",
                     correction.size / UnitOf(logged), logged.slides ? "mm" : "deg", logged.name,
                     where, from);
}

}  // namespace

std::optional<StatedCorrection> ParseStatedCorrection(const std::string& name,
                                                      const RobotTree& tree) {
  const std::size_t colon = name.find(':');
  const std::string word = name.substr(0, colon);
  StatedCorrection correction;
  if (name.starts_with("scale=")) {
    const std::optional<double> factor = ParseNumber(name.substr(name.find('=') + 1));
    if (!factor) Refuse(name, "'" + name.substr(name.find('=') + 1) + "' is not a number");
    CheckSize(name, *factor, kLeastFactor, kLargestFactor, "");
    correction.kind = FaultKind::kCameraScale;
    correction.size = *factor;
    return correction;
  }
  if (word == "offset") {
    correction.kind = FaultKind::kJointOffset;
  } else if (word == "scale") {
    correction.kind = FaultKind::kCameraScale;
  } else if (word != "gain") {
    return std::nullopt;
  }
  const std::size_t equals = name.rfind('=');
  if (colon == std::string::npos || equals == std::string::npos || equals < colon) {
    Refuse(
        name,
        "gain:JOINT=FACTOR, gain:JOINT@TRIAL=FACTOR, offset:JOINT@TRIAL=SIZE, "
        "offset:JOINT@TRIAL:POSTURE=SIZE, of a table offset:JOINT:POSTURE=SIZE, scale:TRIAL=FACTOR "
        "or scale=FACTOR was expected");
  }
  const std::optional<double> size = ParseNumber(name.substr(equals + 1));
  if (!size) Refuse(name, "'" + name.substr(equals + 1) + "' is not a number");
  std::string of = name.substr(colon + 1, equals - colon - 1);
  if (correction.kind == FaultKind::kCameraScale) {
    CheckSize(name, *size, kLeastFactor, kLargestFactor, "");
    correction.trial = of;
    correction.size = *size;
    return correction;
  }
  const std::size_t at = of.rfind('@');
  if (at != std::string::npos) {
    correction.trial = of.substr(at + 1);
    of.resize(at);
    if (correction.kind == FaultKind::kJointOffset) {
      ReadFirstPosture(name, correction.trial, correction);
    }
  } else if (correction.kind == FaultKind::kJointOffset &&
             ParseNumber(of.substr(of.rfind(':') + 1))) {
    ReadFirstPosture(name, of, correction);
  }
  std::tie(correction.linkage, correction.coordinate) = FindLogged(name, of, tree);
  const LoggedPosition logged = LoggedPositionOf(tree, correction.linkage, correction.coordinate);
  correction.joint = of;
  if (correction.kind == FaultKind::kJointGain) {
    CheckSize(name, *size, kLeastFactor, kLargestFactor, "");
    correction.size = *size;
    return correction;
  }
  if (correction.trial.empty() && correction.from == 1) {
    Refuse(name,
           "an offset in all postures is an error of the robot; offset:JOINT@TRIAL=SIZE or, of a "
           "table, offset:JOINT:POSTURE=SIZE was expected");
  }
  const double largest = logged.slides ? kLargestOffsetMm : kLargestOffsetDeg;
  CheckSize(name, *size, -largest, largest, logged.slides ? " mm" : " deg");
  correction.size = *size * UnitOf(logged);
  return correction;
}

std::optional<std::string> NameOfCorrection(const RecordingFault& fault, const RobotTree& tree,
                                            const Recording& recording) {
  const std::string trial =
      fault.trial < 0 ? "" : recording.trials[static_cast<std::size_t>(fault.trial)].name;
  if (fault.kind == FaultKind::kCameraScale) {
    if (trial.empty()) return std::nullopt;
    return fmt::format("scale:{}={:.5f}", trial, 1.0 + fault.size);
  }
  if (fault.coordinate < 0 || fault.kind == FaultKind::kJointDrift ||
      fault.kind == FaultKind::kJointLag || fault.kind == FaultKind::kUnfinished) {
    return std::nullopt;
  }
  const LoggedPosition logged = LoggedPositionOf(tree, fault.linkage, fault.coordinate);
  const std::string where = trial.empty() ? "" : "@" + trial;
  if (fault.kind == FaultKind::kJointGain) {
    return fmt::format("gain:{}{}={:.5f}", logged.name, where, 1.0 + fault.size);
  }
  if (trial.empty()) {
    if (recording.trial.empty()) {
      if (fault.posture < 1) return std::nullopt;
      const auto from = [&](int posture, double size) {
        return fmt::format("offset:{}:{}={:.4f}", logged.name, posture + 1, size / UnitOf(logged));
      };
      std::string names = from(fault.posture, fault.size);
      if (fault.end > 0) names += " " + from(fault.end, -fault.size);
      return names;
    }
    return NamesFromPosture(fault, logged, recording);
  }
  std::string from;
  if (IsInPartOfTrial(fault, recording)) {
    const auto first = std::find(recording.trial.begin(), recording.trial.end(), fault.trial);
    from = fmt::format(":{}", fault.posture - (first - recording.trial.begin()) + 1);
  }
  return fmt::format("offset:{}{}{}={:.4f}", logged.name, where, from, fault.size / UnitOf(logged));
}

std::string ApplyCorrection(const StatedCorrection& correction, const RobotTree& tree,
                            Measurements& measured) {
  if (correction.trial.empty() && correction.from > 1 && !measured.calibration.trial.empty()) {
    throw InputError("--accept offset:" + correction.joint +
                     ": the recording has trials; offset:JOINT@TRIAL:POSTURE=SIZE was expected");
  }
  const bool first = ApplyTo(correction, tree, measured.calibration);
  const bool second = ApplyTo(correction, tree, measured.validation);
  if (!first && !second) {
    std::set<std::string> known;
    for (const Recording* of : {&measured.calibration, &measured.validation}) {
      for (const Trial& trial : of->trials) known.insert(trial.name);
    }
    throw InputError(fmt::format("--accept: no trial '{}' is used; trials: {}", correction.trial,
                                 fmt::join(known, ", ")));
  }
  if (correction.kind == FaultKind::kCameraScale) {
    for (std::size_t t = 0; t < measured.trials.size(); ++t) {
      TrialSummary& trial = measured.trials[t];
      if (!correction.trial.empty() && trial.trial.name != correction.trial) continue;
      if (trial.scale) trial.scale->size = (1.0 + trial.scale->size) / correction.size - 1.0;
      for (FootRest& rest : measured.foot_rests) {
        if (rest.trial != static_cast<int>(t)) continue;
        for (Eigen::Matrix3Xd* at : {&rest.at, &rest.at_first, &rest.at_last}) {
          *at /= correction.size;
        }
      }
    }
  }
  return InWords(correction, tree);
}

void RefuseAccepted(const std::string& name, const std::set<std::string>& shown) {
  const std::string known =
      "sign:JOINT, exchange:JOINT,JOINT, frozen:JOINT, labels:NAME,NAME, rows:COUNT, "
      "gain:JOINT=FACTOR, offset:JOINT@TRIAL=SIZE, scale:TRIAL=FACTOR or scale=FACTOR";
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos || known.find(name.substr(0, colon + 1)) == std::string::npos) {
    Refuse(name, "no such mistake is known; " + known + " was expected");
  }
  const std::string near = DidYouMean(name, shown);
  Refuse(name, "nothing in the recording points to it" +
                   (!near.empty()   ? near
                    : shown.empty() ? "; it points to no mistake that has a name"
                                    : fmt::format("; it points to {}", fmt::join(shown, ", "))));
}

}  // namespace elastocal
