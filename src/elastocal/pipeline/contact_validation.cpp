// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_validation.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/fingerprint.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/observation/standing_robot.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_verdict.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// The joints with a stored compliance of these suffixes.
std::vector<int> ElasticJointsOf(const StoredCalibration& stored, const RobotTree& tree,
                                 const std::vector<std::string>& suffixes) {
  std::set<int> joints;
  for (const auto& [name, value] : stored.joint_errors) {
    for (const std::string& suffix : suffixes) {
      if (name.ends_with(suffix)) {
        joints.insert(FindJoint(tree, name.substr(0, name.size() - suffix.size())));
      }
    }
  }
  return {joints.begin(), joints.end()};
}

/// The stored errors of the robot's parameters; those it does not have are of joints that touches
/// do not move.
Eigen::VectorXd StoredErrors(const StoredCalibration& stored, const ErrorModel& robot) {
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(robot.parameter_count());
  for (int i = 0; i < robot.parameter_count(); ++i) {
    const auto found = stored.joint_errors.find(robot.parameters[i].name);
    if (found != stored.joint_errors.end()) errors[i] = found->second;
  }
  return errors;
}

std::vector<Eigen::VectorXd> PredictStored(const ContactValidation& run,
                                           const StoredContact& stored,
                                           const Eigen::VectorXd& errors) {
  ObservedValues values{errors, {}, {}};
  for (const Quantity& quantity : run.model.setup.quantities) {
    const auto found = stored.quantities.find(quantity.name);
    values.quantities.push_back(
        found != stored.quantities.end()
            ? found->second
            : QuantityValue{quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
  }
  return run.surroundings_refitted
             ? LeftAfterRegistration(run.model, run.observations, values, stored.spread)
             : LeftOf(run.model, run.observations, values);
}

}  // namespace

ContactValidation ValidateContacts(const Project& project, const std::filesystem::path& calibration,
                                   const std::vector<std::filesystem::path>& recordings,
                                   bool refit_table) {
  const std::filesystem::path file = FindCalibrationFiles(calibration).calibration;
  const StoredCalibration stored = ReadCalibration(file);
  const StoredContacts contacts = ReadContacts(file, project);
  ObservationTables tables = ReadObservationTables(recordings, project, &contacts.feet);
  ContactValidation run;
  run.calibration_file = file.string();
  run.calibration_fingerprint = stored.fingerprint;
  for (const std::filesystem::path& table : recordings) {
    run.recording += (run.recording.empty() ? "" : ", ") + table.string();
  }
  run.surroundings_refitted = refit_table;
  run.observations = std::move(tables.observations);
  run.warnings = std::move(tables.warnings);
  // What is in common or held says nothing about values that are known.
  tables.setup.common.clear();
  run.model =
      MakeObservedRobot(project.tree, project.placement, tables.setup,
                        ElasticJointsOf(stored, project.tree, {".compliance_z"}),
                        ElasticJointsOf(stored, project.tree, {".compliance_x", ".compliance_y"}));
  if (stored.nominal != NominalFingerprint(run.model.robot)) {
    throw InputError(file.string() + ": made for robot '" + stored.robot +
                     "' with other nominal geometry than " + project.urdf.string() +
                     "; expected the URDF that was calibrated, not the calibrated one");
  }
  CheckParameters(stored, run.model.robot, {});
  const std::vector<Eigen::VectorXd> before = PredictStored(
      run, contacts.uncalibrated, Eigen::VectorXd::Zero(run.model.robot.parameter_count()));
  const std::vector<Eigen::VectorXd> after =
      PredictStored(run, contacts.calibrated, StoredErrors(stored, run.model.robot));
  run.uncalibrated = MakeFigures(run.model, run.observations, before);
  run.calibrated = MakeFigures(run.model, run.observations, after);
  run.gain_in_sds =
      GainInSds(run.model, run.observations, before, after, contacts.calibrated.spread);
  for (const std::string& row : WorseRows(run.model, run.uncalibrated, run.calibrated)) {
    run.objections.push_back("the calibrated robot is worse here: " + row);
  }
  // Without registration, a table or tracker that has been moved says nothing of the robot.
  for (const std::string& row : LargeErrors(run.model, run.calibrated)) {
    run.objections.push_back(run.surroundings_refitted
                                 ? "no calibrated robot errs like this: " + row
                                 : row +
                                       ": was the tracker or the table moved since the "
                                       "calibration? --refit table registers both anew");
  }
  if (!(run.gain_in_sds > 0.0)) {
    run.objections.emplace_back("calibrated is no better than uncalibrated here");
  }
  return run;
}

std::string MakeContactValidationJson(const ContactValidation& run) {
  nlohmann::ordered_json json;
  json["status"] = run.better() ? "better" : "not better";
  json["objections"] = run.objections;
  json["calibration"] = run.calibration_file;
  json["calibration_fingerprint"] = run.calibration_fingerprint;
  json["recording"] = run.recording;
  json["postures"] = run.observations.posture_count();
  json["contact"] = FiguresJson(run.model, run.calibrated);
  json["contact"]["table"] = run.surroundings_refitted ? "refitted" : "as calibrated";
  json["contact"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated);
  json["contact"]["gain_in_sds"] = run.gain_in_sds;
  json["warnings"] = run.warnings;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace elastocal
