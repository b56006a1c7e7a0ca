// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/recording_info.hpp"
#include "elastocal/pipeline/result_folder.hpp"

namespace elastocal::cli {
namespace {

constexpr int kPictureWidth = 48;

struct RecordingCommand {
  CommonOptions common;
  std::string file, output, up, part;
  ReaderOptions reading;
};

/// One sign for each part of the time: the marker was seen in all frames, in some, or in none.
std::string DrawSight(const MarkerSight& sight) {
  std::string picture;
  for (const double share : sight.share_by_part) {
    picture += share >= 1.0 ? '#' : share > 0.0 ? '+' : '.';
  }
  return picture;
}

std::string DescribeMarkers(const RecordingInfo& info) {
  const MarkerTrajectories& markers = *info.file.markers;
  std::string text = fmt::format("Markers: {}, in {} frames at {:.6g} Hz ({:.1f} s); axis up: {}\n",
                                 markers.marker_count(), markers.frame_count(), markers.rate_hz,
                                 markers.frame_count() / markers.rate_hz,
                                 info.file.up.empty() ? "not stated" : info.file.up);
  TextTable table(
      {"marker", "seen, %", "gaps", "longest, s", "seen in all (#), some (+), no (.) frames"});
  for (const MarkerSight& sight : info.sights) {
    table.Add({sight.name, fmt::format("{:.1f}", 100.0 * sight.seen_share),
               std::to_string(sight.gaps), fmt::format("{:.2f}", sight.longest_gap_s),
               DrawSight(sight)});
  }
  return text + table.Render();
}

std::string DescribeJoints(const RecordingInfo& info, bool verbose) {
  const JointLog& log = *info.file.joints;
  std::string text = fmt::format("Joints: {}, {} with torques; {} samples", log.names.size(),
                                 info.torques, log.sample_count());
  if (log.sample_count() > 1) {
    text += fmt::format(" from {:.3f} to {:.3f} s, mostly {:.6g} a second, at most {:.3f} s apart",
                        log.time_s[0], log.time_s[log.time_s.size() - 1], info.log_rate_hz,
                        info.longest_hole_s);
  }
  return text + "\n  " + FirstOf(log.names, verbose ? log.names.size() : 8) + "\n";
}

std::string DescribeColumns(const NamedPostures& postures) {
  TextTable table({"column", "filled", "least", "largest"});
  for (const NamedPostures::Column& column : postures.columns) {
    const bool numbers = column.numbers == column.filled && column.filled > 0;
    table.Add({column.name, fmt::format("{} of {}", column.filled, postures.count),
               numbers             ? fmt::format("{:.6g}", column.least)
               : column.filled > 0 ? "text"
                                   : "",
               numbers ? fmt::format("{:.6g}", column.largest) : ""});
  }
  return fmt::format("Rows: {}\n", postures.count) + table.Render();
}

std::string DescribePostures(const NamedPostures& postures, bool verbose) {
  if (!postures.columns.empty()) return DescribeColumns(postures);
  std::string text =
      fmt::format("Postures: {}; joints: {}\n  {}\n", postures.count, postures.joints.size(),
                  FirstOf(postures.joints, verbose ? postures.joints.size() : 8));
  TextTable table({"marker", "seen in postures"});
  for (const NamedPostures::Sight& sight : postures.markers) {
    table.Add({sight.marker, fmt::format("{} of {}", sight.seen, postures.count)});
  }
  return text + table.Render();
}

std::string DescribeFrames(const RecordingInfo& info, bool verbose) {
  return (info.file.markers ? DescribeMarkers(info)
                            : fmt::format("No markers: {}\n", info.file.why_no_markers)) +
         (info.file.joints ? DescribeJoints(info, verbose)
                           : fmt::format("No joint positions: {}\n", info.file.why_no_joints));
}

int Info(const RecordingCommand& command) {
  OutputSet outputs;
  outputs.Protect({command.file});
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();
  const RecordingInfo info = DescribeRecording(command.file, command.reading, kPictureWidth);
  outputs.Set(command.common.json_file, MakeInfoJson(info));
  outputs.Publish();
  std::string text = fmt::format("{}: {}\n", command.file, info.file.format);
  text += info.file.postures ? DescribePostures(*info.file.postures, command.common.verbose)
                             : DescribeFrames(info, command.common.verbose);
  for (const std::string& note : info.file.notes) text += "Note: " + note + "\n";
  Print(command.common.Silent(), text);
  return kFine;
}

/// Refuses a file name that promises another format.
void CheckWrittenFormat(const std::string& output) {
  const std::string extension = std::filesystem::path(output).extension().string();
  for (const char* other : {".c3d", ".trc", ".npz", ".mcap", ".db3", ".bag"}) {
    if (extension != other) continue;
    throw InputError(output + ": found the extension " + extension +
                     "; Qualisys TSV (.tsv) or a joint log (.csv) is what convert writes");
  }
}

int Convert(const RecordingCommand& command) {
  CheckWrittenFormat(command.output);
  const RecordingPart part = command.part == "markers"  ? RecordingPart::kMarkers
                             : command.part == "joints" ? RecordingPart::kJoints
                                                        : RecordingPart::kOnlyOne;
  const ConvertedRecording converted =
      ConvertRecording(command.file, command.reading, part, command.up);
  OutputSet outputs;
  outputs.Protect({command.file});
  outputs.Declare(command.output,
                  [&](const std::string& text) { return IsConverted(text, converted); });
  outputs.Prepare();
  outputs.Set(command.output, converted.text);
  outputs.Publish();
  PrintWarnings(converted.warnings);
  Print(command.common.quiet, fmt::format("Written: {}\n", command.output));
  return kFine;
}

/// Adds the file, and options for what it may not state.
void AddRecording(CLI::App& command, RecordingCommand& options) {
  command
      .add_option("recording", options.file,
                  "Recording of cameras or robot: C3D, Vicon CSV, Motive CSV, TRC, Qualisys TSV, "
                  ".npz, ROS bag (MCAP, db3, bag, folder of a ROS 2 bag), joint log; its contents "
                  "tell which")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--unit", options.reading.unit, "Unit of length of a file that does not state it")
      ->transform(OneOf({"mm", "cm", "m", "in"}));
  command
      .add_option("--time-unit", options.reading.time_unit,
                  "Unit of the time of a joint log that does not state it (default: s)")
      ->transform(OneOf({"s", "ms", "us", "ns"}));
  command
      .add_option("--topic", options.reading.joints_topic,
                  "Topic of the joint states, where a bag has several")
      ->type_name("NAME");
  command
      .add_option("--tf-frame", options.reading.tf_frame,
                  "Frame of the cameras in the tf of a bag: bodies are what moves in it")
      ->type_name("NAME");
  command
      .add_option("--tf-bodies", options.reading.tf_bodies,
                  "Frames of tf that are bodies (default: all that move in the cameras' frame)")
      ->type_name("NAME");
  command.add_flag("--salvage", options.reading.salvage,
                   "Read a bag that was not closed or was cut off, up to where it ends");
}

}  // namespace

void AddInfo(CLI::App& app, Action& action) {
  auto options = std::make_shared<RecordingCommand>();
  CLI::App* command =
      app.add_subcommand("info", "Say what a recording holds, and when which marker was seen");
  AddRecording(*command, *options);
  AddOutputOptions(*command, options->common);
  command->footer("Example: elastocal info swing_left.c3d");
  command->callback([&action, options] { action = [options] { return Info(*options); }; });
}

void AddConvert(CLI::App& app, Action& action) {
  auto options = std::make_shared<RecordingCommand>();
  CLI::App* command = app.add_subcommand(
      "convert",
      "Write a recording in the program's own formats: Qualisys TSV with z up, or joint log");
  AddRecording(*command, *options);
  command->add_option("-o,--output", options->output, "The file to write")
      ->required()
      ->check(IsNamed)
      ->type_name("FILE");
  command
      ->add_option("--up", options->up,
                   "Axis of the cameras' frame that points up, where the file does not say")
      ->transform(OneOf({"x", "y", "z", "-x", "-y", "-z"}));
  command->add_option("--part", options->part, "What to write of a file that has both")
      ->transform(OneOf({"markers", "joints"}));
  command->add_flag("--quiet,-q", options->common.quiet, "Print nothing but warnings and errors");
  command->footer(
      "The commands that take recordings read these files as they are; nothing has to be "
      "converted for them.\n"
      "Example: elastocal convert take.csv --up y -o markers.tsv");
  command->callback([&action, options] { action = [options] { return Convert(*options); }; });
}

}  // namespace elastocal::cli
