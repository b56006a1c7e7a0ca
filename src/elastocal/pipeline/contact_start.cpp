// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/observed_corrections.hpp"
#include "elastocal/observation/observed_study.hpp"
#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {
namespace {

constexpr int kFewestObservedPostures = 8;  // tables and plates alone have 5 unknowns each

/// Checks that each pattern matches a parameter that some model of the robot has: geometry, a
/// spring of any joint, or a cause.
void CheckPatternsOf(const Project& project, const ObservationSetup& setup) {
  if (setup.hold.empty() && setup.common.empty()) return;
  ObservationSetup without = setup;
  without.hold.clear();
  without.common.clear();
  std::vector<int> joints(project.tree.joints.size());
  std::iota(joints.begin(), joints.end(), 0);
  std::vector<int> bending = joints;
  std::erase_if(bending, [&](int joint) {
    return project.tree.joints[Size(joint)].type == JointType::kPrismatic;
  });
  const ObservedRobot full = MakeObservedRobot(project.tree, project.placement, without, joints,
                                               bending, ObservableCorrections(project.tree, setup));
  CheckPatterns(full.robot.parameters, setup.hold);
  for (const std::vector<std::string>& patterns : setup.common) {
    CheckPatterns(full.robot.parameters, patterns);
  }
}

}  // namespace

ObservedRobot MakeRobotOfProject(const Project& project, const ObservationTables& tables) {
  ObservationSetup setup = tables.setup;
  setup.hold = project.identifiability.hold;
  setup.outlier_probability = project.calibration.outlier_probability;
  const auto joints = [&](const std::optional<std::vector<std::string>>& patterns) {
    return patterns ? MatchingJoints(project.tree, *patterns) : std::vector<int>();
  };
  try {
    CheckPatternsOf(project, setup);
    ObservedRobot model =
        MakeObservedRobot(project.tree, project.placement, setup,
                          joints(project.elasticity.torsion), joints(project.elasticity.bending));
    KeepObservedUnknowns(tables.observations, model);
    return model;
  } catch (const InputError& error) {
    throw InputError(project.file.string() +
                     ": contact.common or identifiability.hold: " + error.what());
  }
}

ContactStart StartContacts(const Project& project,
                           const std::vector<std::filesystem::path>& recordings,
                           const ContactRunOptions& options) {
  ContactStart start;
  std::optional<EarlierContacts>& earlier = start.earlier;
  if (!options.prior.empty()) earlier = ReadPriorOfContacts(options.prior, project);
  const bool feet_known = earlier && earlier->of_contacts;
  ObservationTables tables =
      ReadObservationTables(recordings, project, feet_known ? &earlier->contacts.feet : nullptr);
  start.warnings = std::move(tables.warnings);
  start.model = earlier ? MakeRobotAfterEarlier(*earlier, project, tables)
                        : MakeRobotOfProject(project, tables);
  start.observations = std::move(tables.observations);
  for (const std::string& what :
       CorrectObservations(options.accept, start.model, start.observations)) {
    start.warnings.push_back("corrected on request: " + what);
  }
  const int postures = start.observations.posture_count();
  if (postures < kFewestObservedPostures) {
    throw InputError(fmt::format("{}: {} postures; at least {} were expected",
                                 fmt::join(start.observations.files, ", "), postures,
                                 kFewestObservedPostures));
  }
  if (earlier) {
    for (std::string& text : StartFromEarlierContacts(*earlier, start.observations, project,
                                                      options.days, start.model)) {
      start.warnings.push_back(std::move(text));
    }
  }
  return start;
}

}  // namespace elastocal
