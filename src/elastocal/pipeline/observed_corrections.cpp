// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/observed_corrections.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/stated_corrections.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kMostRowsFurther = 10;

[[noreturn]] void RefuseName(const std::string& name, const std::string& why) {
  throw InputError("--accept " + name + ": " + why);
}

/// As `--accept` calls it: without its folder.
std::string FileName(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

int CoordinateOf(const std::string& name, const std::string& joint, const RobotTree& tree) {
  for (const Joint& candidate : tree.joints) {
    if (candidate.name == joint && !candidate.mimic) return candidate.coordinate;
  }
  RefuseName(name, "the robot has no moving joint '" + joint + "'");
}

std::string JointName(const RobotTree& tree, int coordinate) {
  return tree.joints[Size(tree.coordinate_joint[Size(coordinate)])].name;
}

std::string ApplyStated(const std::string& name, const StatedCorrection& correction,
                        const ObservedRobot& model, Observations& observations) {
  std::vector<char> here(Size(observations.posture_count()), 0);
  bool found = false;
  int number = 0;  // of the posture in its file
  for (int i = 0; i < observations.posture_count(); ++i) {
    const int file = observations.postures[Size(i)].file;
    if (i == 0 || file != observations.postures[Size(i - 1)].file) number = 0;
    ++number;
    const bool of_file =
        correction.trial.empty() || FileName(observations.files[Size(file)]) == correction.trial;
    here[Size(i)] = of_file && number >= correction.from ? 1 : 0;
    found = found || here[Size(i)] != 0;
  }
  if (!found) {
    RefuseName(name, fmt::format("there is no posture {} in a file '{}'", correction.from,
                                 correction.trial));
  }
  if (correction.kind == FaultKind::kCameraScale) {
    for (Observation& observation : observations.all) {
      if (here[Size(observation.posture)] == 0) continue;
      const int lengths = LengthsMeasured(model.instrument(observation.instrument));
      observation.measured.head(lengths) /= correction.size;
    }
    return fmt::format("positions and lengths as measured were divided by {:g} ({})",
                       correction.size, name);
  }
  for (int i = 0; i < observations.posture_count(); ++i) {
    if (here[Size(i)] == 0) continue;
    double& position = observations.q(i, correction.coordinate);
    position = correction.kind == FaultKind::kJointGain ? position / correction.size
                                                        : position - correction.size;
  }
  return fmt::format("{}: {}", correction.joint, name);
}

/// Undoes it; what was undone.
std::string ApplyName(const std::string& name, const ObservedRobot& model,
                      Observations& observations) {
  const RobotTree& tree = model.robot.tree;
  if (const auto stated = ParseStatedCorrection(name, tree)) {
    return ApplyStated(name, *stated, model, observations);
  }
  const std::size_t colon = name.find(':');
  const std::string word = name.substr(0, colon);
  const std::string of = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (word == "sign") {
    observations.q.col(CoordinateOf(name, of, tree)) *= -1.0;
    return of + ": the sign of its positions was reversed";
  }
  if (word == "exchange") {
    const std::size_t comma = of.find(',');
    if (comma == std::string::npos) RefuseName(name, "exchange:JOINT,JOINT was expected");
    const std::string a = of.substr(0, comma), b = of.substr(comma + 1);
    observations.q.col(CoordinateOf(name, a, tree))
        .swap(observations.q.col(CoordinateOf(name, b, tree)));
    return a + " and " + b + ": their positions were exchanged";
  }
  if (word == "frozen") {
    const auto frozen = FindFrozen(observations, CoordinateOf(name, of, tree));
    if (!frozen) RefuseName(name, "its positions are not the same in five rows one after another");
    observations = WithoutFault(*frozen, model, observations);
    return fmt::format("{}: {} postures in which it is frozen were left out", of, frozen->count);
  }
  if (word == "rows") {
    const auto rows = ParseNumber(of.starts_with('+') ? of.substr(1) : of);
    const bool whole = rows && *rows == std::round(*rows) && *rows != 0.0;
    if (!whole || std::abs(*rows) > kMostRowsFurther) {
      RefuseName(name, fmt::format("rows:+1, up to {} rows to either side, was expected",
                                   kMostRowsFurther));
    }
    observations = WithRowsOf(observations, static_cast<int>(*rows));
    return fmt::format("what was observed was taken for the joint positions {} rows further", of);
  }
  RefuseName(name,
             "sign:JOINT, exchange:JOINT,JOINT, frozen:JOINT, rows:COUNT, gain:JOINT=FACTOR, "
             "offset:JOINT@FILE:POSTURE=SIZE or scale=FACTOR was expected");
}

}  // namespace

std::vector<std::string> CorrectObservations(const std::vector<std::string>& accepted,
                                             const ObservedRobot& model,
                                             Observations& observations) {
  std::vector<std::string> undone;
  std::set<std::string> done;
  for (const std::string& name : accepted) {
    if (!done.insert(name).second) RefuseName(name, "given twice");
    undone.push_back(ApplyName(name, model, observations));
  }
  return undone;
}

std::optional<std::string> NameOfFault(const ObservationFault& fault, const ObservedRobot& model,
                                       const Observations& observations) {
  if (fault.kind == ObservationFaultKind::kMoved ||
      fault.kind == ObservationFaultKind::kJointDrift) {
    return std::nullopt;
  }
  const std::string in = fault.file < 0 ? "" : FileName(observations.files[Size(fault.file)]);
  if (fault.kind == ObservationFaultKind::kScale) {
    return fmt::format("scale:{}={:.5f}", in, 1.0 + fault.size);
  }
  const RobotTree& tree = model.robot.tree;
  const std::string joint = JointName(tree, fault.coordinate);
  if (fault.kind == ObservationFaultKind::kJointFrozen) return "frozen:" + joint;
  if (fault.kind == ObservationFaultKind::kJointGain) {
    return fmt::format("gain:{}{}={:.5f}", joint, in.empty() ? "" : "@" + in, 1.0 + fault.size);
  }
  const bool slides = tree.joints[Size(tree.coordinate_joint[Size(fault.coordinate)])].type ==
                      JointType::kPrismatic;
  const double size = fault.size / (slides ? 1e-3 : M_PI / 180.0);
  std::string names;
  int number = 0;  // of the posture in its file
  for (int i = 0; i < observations.posture_count(); ++i) {
    const int file = observations.postures[Size(i)].file;
    const bool begins = i == 0 || file != observations.postures[Size(i - 1)].file;
    number = begins ? 1 : number + 1;
    if (i < fault.posture || (i > fault.posture && !begins)) continue;
    names += fmt::format("{}offset:{}@{}{}={:.4f}", names.empty() ? "" : " ", joint,
                         FileName(observations.files[Size(file)]),
                         number > 1 ? fmt::format(":{}", number) : "", size);
  }
  return names;
}

Observations WithRowsOf(const Observations& observations, int further) {
  Observations moved = observations;
  std::vector<int> kept;
  for (int i = 0; i < observations.posture_count(); ++i) {
    const int partner = i + further;
    if (partner < 0 || partner >= observations.posture_count()) continue;
    if (observations.postures[Size(partner)].file != observations.postures[Size(i)].file) continue;
    moved.q.row(i) = observations.q.row(partner);
    kept.push_back(i);
  }
  return SelectPostures(moved, kept);
}

}  // namespace elastocal
