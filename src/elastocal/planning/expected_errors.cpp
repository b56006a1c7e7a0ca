// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/expected_errors.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Core>

#include "elastocal/calibration/frames_from_link.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/calibration_files.hpp"

namespace elastocal {
namespace {

// Evenly chosen; the result changes little with more.
constexpr Eigen::Index kPosturesOfMotion = 40;

/// The rows of the motion by the link from which the others are seen.
std::map<int, std::vector<Eigen::Index>> RowsByStandingLink(const Project& project,
                                                            const JointMotion& motion) {
  const int foot = project.soles.empty() ? 0 : project.soles.front().link;
  std::map<int, std::vector<Eigen::Index>> rows;
  const Eigen::Index step = std::max<Eigen::Index>(1, motion.q.rows() / kPosturesOfMotion);
  for (Eigen::Index i = 0; i < motion.q.rows(); i += step) {
    const std::vector<int> stands =
        motion.support.empty() ? std::vector<int>{foot} : motion.support[Size(i)];
    rows[stands.empty() ? 0 : stands.front()].push_back(i);
  }
  return rows;
}

/// Limbs by the link at their end; each link occurs once.
std::vector<std::pair<int, std::string>> EndsByName(const Project& project) {
  std::vector<std::pair<int, std::string>> ends;
  for (const Chain& chain : project.chains) {
    if (project.tree.links[Size(chain.tip_link)].body == 0) continue;
    const bool known =
        std::ranges::any_of(ends, [&](const auto& end) { return end.first == chain.tip_link; });
    if (!known) ends.emplace_back(chain.tip_link, chain.name);
  }
  ends.emplace_back(0, project.tree.links.front().name);
  return ends;
}

/// Parameters that model and covariance have in common, with their places in both.
struct SharedParameters {
  std::vector<int> model, covariance;
};

SharedParameters Shared(const ErrorModel& model, const CalibrationEstimate& estimate) {
  SharedParameters shared;
  std::map<std::string, int> places;
  for (std::size_t i = 0; i < estimate.covariance_names.size(); ++i) {
    places.emplace(estimate.covariance_names[i], static_cast<int>(i));
  }
  for (int i = 0; i < model.parameter_count(); ++i) {
    const auto found = places.find(model.parameters[Size(i)].name);
    if (found == places.end()) continue;
    shared.model.push_back(i);
    shared.covariance.push_back(found->second);
  }
  return shared;
}

}  // namespace

std::vector<ExpectedAtLimb> ExpectErrors(const Project& project,
                                         const StoredCalibration& calibration,
                                         const CalibrationEstimate& estimate,
                                         const JointMotion& motion) {
  if (!estimate.has_covariance()) return {};
  const StoredRobot robot = RestoreRobot(project, calibration);
  const SharedParameters shared = Shared(robot.model, estimate);
  const Eigen::MatrixXd covariance = estimate.covariance(shared.covariance, shared.covariance);
  const KnownGeometry known{robot.model, robot.errors, shared.model, covariance};
  const std::vector<std::pair<int, std::string>> ends = EndsByName(project);
  std::vector<int> links;
  for (const auto& [link, name] : ends) links.push_back(link);
  struct Squares {
    double position = 0.0, attitude = 0.0, count = 0.0;
  };
  std::map<int, Squares> by_link;
  for (const auto& [from, rows] : RowsByStandingLink(project, motion)) {
    std::vector<int> others = links;
    const int standing = project.tree.links[Size(from)].body;
    std::erase_if(others,
                  [&](int link) { return project.tree.links[Size(link)].body == standing; });
    const auto count = static_cast<double>(rows.size());
    for (const FramePrecision& frame :
         AssessFramesFrom(from, known, motion.q(rows, Eigen::all), others)) {
      Squares& sum = by_link[frame.link];
      sum.position += count * frame.position_sd * frame.position_sd;
      sum.attitude += count * frame.attitude_sd * frame.attitude_sd;
      sum.count += count;
    }
  }
  std::vector<ExpectedAtLimb> expected;
  for (const auto& [link, name] : ends) {
    const auto found = by_link.find(link);
    if (found == by_link.end()) continue;
    const Squares& sum = found->second;
    expected.push_back(
        {name, std::sqrt(sum.position / sum.count), std::sqrt(sum.attitude / sum.count)});
  }
  return expected;
}

bool IsSeenFromAFoot(const Project& project, const JointMotion& motion) {
  if (motion.support.empty()) return !project.soles.empty();
  return std::ranges::any_of(motion.support,
                             [](const std::vector<int>& links) { return !links.empty(); });
}

std::vector<ExpectedAtLimb> ExpectErrors(const CalibratedRobot& robot, const JointMotion& motion) {
  const CalibrationFiles files = FindCalibrationFiles(robot.calibration.source);
  return ExpectErrors(robot.project, robot.calibration, ReadCalibrationFiles(files), motion);
}

}  // namespace elastocal
