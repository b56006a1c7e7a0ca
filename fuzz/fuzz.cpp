// SPDX-License-Identifier: Apache-2.0
// libFuzzer targets: for arbitrary bytes, a reader must return a valid value or throw an
// InputError. All targets are in one program, since their headers take longer to compile. The
// environment variable FUZZ_TARGET selects the target.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/description/urdf_writer.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/io/experiment.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/measurement/merge_trials.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {
namespace {

const std::filesystem::path kFolder(ELASTOCAL_FUZZ_DIR);

void Demand(bool holds) {
  if (!holds) std::abort();
}

const Project& TableProject() {
  static const Project project = ReadProject(kFolder / "table_project.yaml");
  return project;
}

/// The writer must find the origins of joints where the reader has read them.
void FuzzUrdf(std::string_view bytes) {
  const std::string text(bytes);
  const RobotTree tree = ParseUrdf(text, "fuzz.urdf");
  LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  auto origins = ReadOrigins(text, "fuzz.urdf");
  Demand(ReplaceOrigins(text, "fuzz.urdf", origins) == text);
  for (auto& [joint, origin] : origins) {
    origin.xyz.setConstant(0.125);
    origin.rpy.setConstant(-0.5);
  }
  const std::string edited = ReplaceOrigins(text, "fuzz.urdf", origins);
  for (const auto& [joint, origin] : ReadOrigins(edited, "fuzz.urdf")) {
    Demand(origin.xyz == origins.at(joint).xyz && origin.rpy == origins.at(joint).rpy);
  }
}

/// The project is beside robot.urdf, which the seeds name.
void FuzzProject(std::string_view bytes) {
  const Project project = ParseProject(std::string(bytes), kFolder / "project.yaml");
  for (const Chain& chain : project.chains) ChainMarkers(project, chain);
}

void FuzzTable(std::string_view bytes) {
  std::istringstream stream{std::string(bytes)};
  ReadPostureTable(stream, "fuzz.csv", TableProject());
}

void DemandIncreasing(const Eigen::VectorXd& time_s) {
  for (Eigen::Index i = 1; i < time_s.size(); ++i) Demand(time_s[i] > time_s[i - 1]);
}

void FuzzJointLog(std::string_view bytes) {
  std::istringstream stream{std::string(bytes)};
  const JointLog log = ReadJointLog(stream, "fuzz.csv", TableProject());
  DemandIncreasing(log.time_s);
  Demand(log.positions.allFinite() && !log.torques.array().isInf().any());
}

/// The seeds name files of the corpus.
void FuzzExperiment(std::string_view bytes) {
  const Experiment experiment =
      ParseExperiment(std::string(bytes), kFolder / "corpus", TableProject());
  for (const TrialFiles& trial : experiment.trials) Demand(!trial.chains.empty());
}

/// A marker file and a joint log, separated by a line `===`, give samples or are refused.
void FuzzTrial(std::string_view bytes) {
  static const MarkedRobot robot = [] {
    MarkedRobot marked = MakeMarkedRobot(TableProject());
    marked.clusters = {{"both", {0, 1}}};
    marked.torque_sensors = {0, 1};
    return marked;
  }();
  const std::string text(bytes);
  const std::string kSeparator = "===\n";
  const std::size_t middle = text.find(kSeparator);
  if (middle == std::string::npos) return;
  std::istringstream stream(text.substr(middle + kSeparator.size()));
  const JointLog log = ReadJointLog(stream, "fuzz.csv", TableProject());
  for (const TrialKind kind : {TrialKind::kCalibration, TrialKind::kSine}) {
    const Trial trial{.name = "fuzz", .kind = kind, .chains = {"all"}};
    const TrialSamples samples =
        SampleTrial(robot, trial, {0, 1}, ParseQtmTsv(text.substr(0, middle), "fuzz.tsv"), log, {});
    const Recording recording = MergeTrials(robot, {samples}, "fuzz");
    Demand(recording.posture_count() == 0 || samples.summary.refused.empty());
    Demand(recording.q.allFinite());
    Demand(!Describe(samples.summary).empty());
    Findings(samples.summary);
  }
}

/// A calibration.yaml gives an estimate that can be compared with itself.
void FuzzCalibration(std::string_view bytes) {
  const CalibrationEstimate estimate = ParseEstimate(std::string(bytes), "fuzz.yaml");
  for (const ParameterEstimate& parameter : estimate.parameters) {
    Demand(!parameter.name.empty() && !parameter.unit.empty());
  }
  FindCommonParameters(estimate, estimate);
}

/// A covariance that is accepted is square, finite and as symmetric as the reader promises.
void FuzzCovariance(std::string_view bytes) {
  CalibrationEstimate estimate;
  estimate.parameters = {
      {.name = "a.theta", .unit = "rad", .sd = 2.0},
      {.name = "b, \"left\".d", .unit = "m", .sd = 3.0},
      {.name = "M.x", .unit = "m", .status = ParameterStatus::kUnsupported, .sd = 1.0}};
  TextStream stream(bytes);
  ReadCovariance(stream, "fuzz.csv", estimate);
  const auto names = static_cast<Eigen::Index>(estimate.covariance_names.size());
  Demand(estimate.covariance.rows() == names && estimate.covariance.cols() == names);
  Demand(estimate.covariance.allFinite() && names >= 2);
}

/// Postures that are accepted can be written, and the same number is read again.
void FuzzPostureFile(std::string_view bytes) {
  const Project& project = TableProject();
  const auto chains = ParsePostureFile(std::string(bytes), "fuzz.yaml", project);
  try {
    const auto again =
        ParsePostureFile(FormatPostureFile(project.tree, chains), "again.yaml", project);
    Demand(ListPostures(chains, "a").q.rows() == ListPostures(again, "b").q.rows());
  } catch (const InputError& error) {
    std::fputs(error.what(), stderr);
    std::abort();
  }
}

void DemandMotion(std::string_view bytes) {
  TextStream stream(bytes);
  const JointMotion motion = ReadMotion(stream, "fuzz.csv", TableProject());
  Demand(motion.q.rows() == motion.sample_count());
  DemandIncreasing(motion.time_s);
}

/// Reads a motion, and the same text as a list of postures.
void FuzzMotion(std::string_view bytes) {
  TextStream stream(bytes);
  try {
    const JointMotion list = ReadPostureList(stream, "fuzz.csv", TableProject());
    Demand(list.q.rows() == list.sample_count());
  } catch (const InputError&) {
    DemandMotion(bytes);  // the text may also be a motion
    return;
  }
  DemandMotion(bytes);
}

/// A marker is either seen or not, and the rate is not zero.
void DemandMarkers(const MarkerTrajectories& markers) {
  Demand(markers.rate_hz > 0.0 && std::isfinite(markers.rate_hz));
  Demand(markers.positions.cols() == 3 * markers.marker_count());
  for (Eigen::Index i = 0; i < markers.positions.rows(); ++i) {
    for (Eigen::Index c = 0; c < markers.positions.cols(); c += 3) {
      const auto gaps = markers.positions.block<1, 3>(i, c).array().isNaN().count();
      Demand(gaps == 0 || gaps == 3);
    }
  }
}

void FuzzQtm(std::string_view bytes) { DemandMarkers(ParseQtmTsv(std::string(bytes), "fuzz.tsv")); }

/// Checks what all readers of recordings promise.
template <RecordingFile (*Read)(const ByteSource&, const ReaderOptions&)>
void FuzzRecording(std::string_view bytes) {
  const std::size_t size = bytes.size();
  ReaderOptions options;
  if (size % 2 == 1) options.unit = "mm";
  if (size % 3 == 1) options.tf_frame = "room";
  if (size % 3 == 2) options.tf_frame = "cameras";
  if (size % 5 == 1) options.tf_bodies = {"tool"};
  options.salvage = size % 7 == 1;
  const RecordingFile file = Read(ByteSource::OfMemory(bytes, "fuzz"), options);
  if (file.markers) DemandMarkers(*file.markers);
  if (!file.joints) return;
  Demand(file.joints->positions.rows() == file.joints->sample_count());
  Demand(file.joints->positions.allFinite());
  DemandIncreasing(file.joints->time_s);
}

struct Target {
  const char* name;
  void (*run)(std::string_view bytes);
};

// The seeds of a target are in corpus/<name>.
const Target kTargets[] = {
    {"calibration", FuzzCalibration},
    {"covariance", FuzzCovariance},
    {"experiment", FuzzExperiment},
    {"joint_log", FuzzJointLog},
    {"motion", FuzzMotion},
    {"posture_file", FuzzPostureFile},
    {"project", FuzzProject},
    {"qtm", FuzzQtm},
    {"table", FuzzTable},
    {"trial", FuzzTrial},
    {"urdf", FuzzUrdf},
    {"c3d", FuzzRecording<ReadC3d>},
    {"db3", FuzzRecording<ReadRosbag2Db3>},
    {"mcap", FuzzRecording<ReadMcap>},
    {"motive", FuzzRecording<ReadMotiveCsv>},
    {"npz", FuzzRecording<ReadNpz>},
    {"qtm_other", FuzzRecording<ReadQtmOther>},
    {"rosbag1", FuzzRecording<ReadRosbag1>},
    {"trc", FuzzRecording<ReadTrc>},
    {"vicon", FuzzRecording<ReadViconCsv>},
};

const Target* target = nullptr;  // the target of this process

}  // namespace
}  // namespace elastocal

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  using elastocal::kTargets;
  const char* chosen = std::getenv("FUZZ_TARGET");
  const std::string_view name = chosen == nullptr ? "" : chosen;
  const auto* found = std::find_if(std::begin(kTargets), std::end(kTargets),
                                   [&](const auto& entry) { return entry.name == name; });
  if (found == std::end(kTargets)) {  // scripts/fuzz gets the names in this way
    for (const auto& entry : kTargets) std::puts(entry.name);
    std::exit(name.empty() ? 0 : 2);
  }
  elastocal::target = found;
  elastocal::TableProject();  // if it were refused, all files read with it would be
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    elastocal::target->run({reinterpret_cast<const char*>(data), size});
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
