// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/measurement/merge_trials.hpp"
#include "elastocal/readers/qtm_tsv.hpp"

// A marker file and a joint log, with a line `===` between them, become samples or a refusal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace elastocal;
  static const Project project =
      ReadProject(std::filesystem::path(ELASTOCAL_FUZZ_DIR) / "table_project.yaml");
  static const MarkedRobot robot = [] {
    MarkedRobot marked = MakeMarkedRobot(project);
    marked.clusters = {{"both", {0, 1}}};
    marked.torque_sensors = {0, 1};
    return marked;
  }();
  const std::string text(data, data + size);
  const std::string kSeparator = "===\n";
  const std::size_t middle = text.find(kSeparator);
  if (middle == std::string::npos) return 0;
  try {
    std::istringstream stream(text.substr(middle + kSeparator.size()));
    const JointLog log = ReadJointLog(stream, "fuzz.csv", project);
    for (const TrialKind kind : {TrialKind::kCalibration, TrialKind::kSine}) {
      const Trial trial{.name = "fuzz", .kind = kind, .chains = {"all"}};
      const TrialSamples samples = SampleTrial(
          robot, trial, {0, 1}, ParseQtmTsv(text.substr(0, middle), "fuzz.tsv"), log, {});
      const Recording recording = MergeTrials(robot, {samples}, "fuzz");
      if (recording.posture_count() > 0 && !samples.summary.refused.empty()) std::abort();
      if (!recording.q.allFinite()) std::abort();
      if (Describe(samples.summary).empty()) std::abort();
      Findings(samples.summary);
    }
  } catch (const InputError&) {
    return 0;
  }
  return 0;
}
