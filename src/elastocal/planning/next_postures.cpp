// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/next_postures.hpp"

#include <optional>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/design_observations.hpp"
#include "elastocal/planning/leave_room.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {

NextPostures DesignNextPostures(const Project& project, const std::filesystem::path& calibration,
                                const CheckRun& run, const CheckOptions& options, int count,
                                const Progress& progress) {
  NextPostures next;
  if (run.check.suspects.empty()) return next;
  if (project.motion.chains.empty()) {
    next.why_none = "the project has no section 'design', which says what postures may be";
    return next;
  }
  const FollowUpDesign design = DesignFollowUp(WithRoom(project, std::nullopt), calibration,
                                               {.aim = SequentialAim::kChanges,
                                                .postures = count,
                                                .days = options.days,
                                                .joints = run.check.suspects,
                                                .seed = options.seed.value_or(1)},
                                               progress);
  next.why_none = design.infeasible;
  if (design.infeasible.empty()) next.postures = design.postures();
  return next;
}

NextPostures DesignNextPostures(const Project& project, const std::filesystem::path& calibration,
                                const ContactCheck& run, const CheckOptions& options, int count,
                                const Progress& progress) {
  NextPostures next;
  if (run.check.suspects.empty()) return next;
  ObservationDesign design;
  try {
    design = DesignObservations(WithRoom(project, std::nullopt),
                                {.count = count,
                                 .candidates = 40,
                                 .seed = options.seed.value_or(1),
                                 .after = calibration,
                                 .days = options.days,
                                 .changes = true,
                                 .joints = run.check.suspects},
                                progress);
  } catch (const InputError& error) {  // a project that does not say which postures are allowed
    next.why_none = error.what();
    return next;
  }
  next.why_none = design.infeasible;
  if (design.infeasible.empty()) next.postures = std::move(design.postures);
  return next;
}

namespace {

std::string WithNext(const std::string& check, const Project& project, const NextPostures& next) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(check);
  json["next_postures"] = nlohmann::ordered_json::array();
  for (const ChainPostures& chain : next.postures) {
    auto postures = nlohmann::ordered_json::array();
    for (const Eigen::VectorXd& q : chain.q) {
      nlohmann::ordered_json posture;
      for (int i = 0; i < project.tree.coordinate_count(); ++i) {
        posture[JointOfCoordinate(project.tree, i).name] = q[i];
      }
      postures.push_back(std::move(posture));
    }
    json["next_postures"].push_back({{"chain", chain.chain}, {"postures", std::move(postures)}});
  }
  return JsonText(json);
}

}  // namespace

std::string MakeCheckJson(const Project& project, const CheckRun& run, const NextPostures& next) {
  return WithNext(MakeCheckJson(run), project, next);
}

std::string MakeCheckJson(const Project& project, const ContactCheck& run,
                          const NextPostures& next) {
  return WithNext(MakeCheckJson(run), project, next);
}

}  // namespace elastocal
