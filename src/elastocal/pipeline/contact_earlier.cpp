// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_earlier.hpp"

#include <algorithm>
#include <iterator>

#include "elastocal/io/fingerprint.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/observation/contact_result.hpp"
#include "elastocal/observation/observed_study.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"

namespace elastocal {
namespace {

constexpr double kToldByEarlier = 10.0;  // numbers for which each standard deviation counts

std::vector<int> JointsOf(const std::optional<std::vector<std::string>>& names,
                          const RobotTree& tree) {
  std::vector<int> joints;
  for (const std::string& name : names.value_or(std::vector<std::string>())) {
    joints.push_back(FindJoint(tree, name));
  }
  std::sort(joints.begin(), joints.end());
  return joints;
}

void TakeSpread(const Spread& spread, std::vector<Source>& sources) {
  for (std::size_t s = 0; s < sources.size(); ++s) {
    if (sources[s].role == Source::Role::kFixed) continue;
    sources[s].sd = spread.sd[s];
    sources[s].own_weight = kToldByEarlier;
  }
}

}  // namespace

ObservedRobot MakeStoredRobot(const StoredCalibration& stored, const Project& project,
                              const ObservationSetup& setup) {
  const ElasticityChoice elasticity = ElasticityOf(stored, project);
  ObservationSetup alone = setup;
  alone.common.clear();
  ObservedRobot model = MakeObservedRobot(
      project.tree, project.placement, alone, JointsOf(elasticity.torsion, project.tree),
      JointsOf(elasticity.bending, project.tree),
      CorrectionsOf(ObservableCorrections(project.tree, setup), elasticity.extra));
  if (stored.nominal != NominalFingerprint(model.robot)) {
    throw InputError(stored.source + ": made for robot '" + stored.robot +
                     "' with other nominal geometry than " + project.urdf.string() +
                     "; expected the URDF that was calibrated, not the calibrated one");
  }
  CheckParameters(stored, model.robot, {});
  return model;
}

EarlierContacts ReadEarlierContacts(const std::filesystem::path& calibration,
                                    const Project& project) {
  const CalibrationFiles files = FindCalibrationFiles(calibration);
  return {ReadCalibration(files.calibration), ReadContacts(files.calibration, project),
          ReadCalibrationFiles(files)};
}

EarlierContacts ReadPriorOfContacts(const std::filesystem::path& calibration,
                                    const Project& project) {
  const CalibrationFiles files = FindCalibrationFiles(calibration);
  if (HasContacts(files.calibration)) return ReadEarlierContacts(calibration, project);
  EarlierContacts earlier{ReadCalibration(files.calibration), {}, ReadCalibrationFiles(files)};
  earlier.of_contacts = false;
  return earlier;
}

ObservedRobot MakeRobotAfterEarlier(const EarlierContacts& earlier, const Project& project,
                                    const ObservationTables& tables) {
  ObservationSetup setup = tables.setup;
  setup.outlier_probability = project.calibration.outlier_probability;
  if (earlier.of_contacts) TakeSpread(earlier.contacts.calibrated.spread, setup.sources);
  setup.hold = project.identifiability.hold;
  ObservedRobot model = MakeStoredRobot(earlier.stored, project, setup);
  KeepObservedUnknowns(tables.observations, model);
  return model;
}

EarlierEstimate MakeEarlierOfContacts(const EarlierContacts& earlier, const ObservedRobot& model,
                                      const Project& project, double days) {
  return MakeEarlierEstimate(earlier.estimate, model.robot, project.calibration, days);
}

OpenedRobot OpenJoints(const ObservedRobot& model, const EarlierEstimate& earlier,
                       const Observations& observations, const Project& project,
                       const JointCheckOptions& options) {
  const Eigen::VectorXd sizes = SizeOfChanges(earlier, model.robot, project.calibration.prior);
  OpenedRobot opened{model, {}, {}};
  opened.model.earlier = earlier;
  opened.model.earlier.covariance.diagonal() += sizes.cwiseAbs2();
  opened.estimate = EstimateObserved(opened.model, observations, {});
  opened.check =
      FindMovedJoints(InformationOfContacts(opened.model, observations, opened.estimate.fit),
                      opened.model.earlier, earlier, sizes, options);
  return opened;
}

std::vector<std::string> StartFromEarlierContacts(const EarlierContacts& earlier,
                                                  const Observations& observations,
                                                  const Project& project, double days,
                                                  ObservedRobot& model) {
  const auto after = [&](double drifting) {
    return MakeEarlierOfContacts(earlier, model, project, drifting);
  };
  const OpenedRobot opened = OpenJoints(model, after(days), observations, project);
  const JointCheck& check = opened.check;
  model.earlier =
      MostProbable(check, InformationOfContacts(opened.model, observations, opened.estimate.fit),
                   opened.model.earlier, days, after, project.calibration.prior);
  std::vector<std::string> texts = DescribeForgotten(check, earlier.stored.source);
  std::ranges::move(DescribeWidened(check, earlier.stored.source), std::back_inserter(texts));
  const std::string before =
      ", " + earlier.stored.recording + ", ";  // files, as ContactRun has them
  for (const std::string& file : observations.files) {
    if (before.find(", " + file + ", ") == std::string::npos) continue;
    texts.push_back(earlier.stored.source + ": made from " + file +
                    " as well, which counts twice: left-out postures are not new to it");
  }
  return texts;
}

}  // namespace elastocal
