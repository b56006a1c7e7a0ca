// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/contact_check.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "elastocal/cli/moved_joints_report.hpp"
#include "elastocal/cli/next_postures_report.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/pipeline/contact_json.hpp"

namespace elastocal::cli {
namespace {

std::string Conclusion(const ContactCheck& run, double level) {
  if (!run.mistakes.empty()) {
    return fmt::format("The recording is wrong: {}\n", fmt::join(run.mistakes, "; or "));
  }
  if (run.recording_explains()) return DescribeWrongRecording(run.alternatives);
  if (!run.explained()) {
    return fmt::format(
        "Not explained, even if every joint may have moved: {}. Is something else wrong: a joint's "
        "gain, a mounting that was moved, one bad posture? Do recording, project and calibration "
        "belong together?\n",
        fmt::join(run.FarRows(run.updated), "; "));
  }
  if (run.changed_beyond_telling()) {
    return fmt::format(
        "Changed: {}. These postures are too few to tell which joint has moved. Record more, and "
        "more different ones.\n",
        fmt::join(run.FarRows(run.calibrated), "; "));
  }
  return DescribeMoved(run.check, run.alternatives, level);
}

std::string ErrorsByInstrument(const ContactCheck& run) {
  TextTable table({"instrument", "number", "rms", "uncalibrated", "calibrated", "joints free",
                   "left by the calibration"});
  for (std::size_t i = 0; i < run.calibrated.rows.size(); ++i) {
    const RowErrors& row = run.calibrated.rows[i];
    const ShownUnit unit = ShownUnitOf(row.unit);
    const auto text = [&](double value) { return fmt::format("{:.3g}", unit.factor * value); };
    table.Add({run.model.instrument(row.instrument).name, std::to_string(row.observations),
               row.row + " " + unit.name, text(run.uncalibrated.rows[i].rms), text(row.rms),
               text(run.updated.rows[i].rms), text(run.left_before[i])});
  }
  return table.Render();
}

}  // namespace

CommandResult CheckByContacts(const CheckCommand& command, const Project& project) {
  const std::vector<std::filesystem::path> recordings(command.recording.begin(),
                                                      command.recording.end());
  const ContactCheck run = CheckContacts(project, command.calibration, recordings, command.check);
  const NextPostures next =
      DesignNextPostures(project, command.calibration, run, command.check, kNextPostures,
                         TerminalProgress("drew posture", command.common.Silent()));
  CommandResult result;
  if (!next.postures.empty()) {
    result.files[command.output] = FormatPostureFile(project.tree, next.postures);
  }
  result.json = MakeCheckJson(project, run, next);
  result.text = Conclusion(run, command.check.joints.level) + "\n" +
                fmt::format("{}, {} postures\n", run.recording, run.observations.posture_count()) +
                ErrorsByInstrument(run);
  if (!run.check.suspects.empty() || command.common.verbose) {
    result.text += "\n" + SuspectTable(run.check);
  }
  result.text += DescribeSensitivity(run.check) + DescribeNext(project, next, command.output);
  result.warnings = run.warnings;
  if (!run.converged) {
    result.errors.emplace_back("the fit has not converged: variances did not come to rest");
  }
  result.fine = run.unchanged();
  return result;
}

}  // namespace elastocal::cli
