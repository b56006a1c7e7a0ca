// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/design_report.hpp"
#include "elastocal/cli/next_postures_report.hpp"
#include "elastocal/cli/observation_commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/design_postures.hpp"
#include "elastocal/planning/leave_room.hpp"

namespace elastocal::cli {
namespace {

struct DesignCommand {
  CommonOptions common;
  std::string project, output, criterion = "O1", algorithm = "nocp";
  std::vector<std::string> chains;
  int count = 0, max_count = PlateauRule().max_postures, block = 4;
  double plateau = PlateauRule().tolerance;
  bool elastic = false, no_certificate = false, curves = false;
  std::string after;  ///< path of an earlier calibration; empty: none
  bool check = false;
  std::vector<std::string> joints;
  double days = 1.0, marker_noise_mm = 0.3;
  std::optional<double> limit_margin_deg;
  /// Given options that do not apply to a design by observations (contact, instruments).
  std::vector<std::string> of_chains;
  std::vector<std::string> of_end;  ///< given options on where the search of nocp ends
};

/// Options of the search chain by chain, which do not apply after a calibration.
constexpr std::array kSearchOptions = {"--algorithm", "--criterion",     "--curves",
                                       "--elastic",   "--max-count",     "--plateau",
                                       "--block",     "--no-certificate"};

constexpr std::array kAlgorithms = {DesignAlgorithm::kNocp, DesignAlgorithm::kCocp,
                                    DesignAlgorithm::kIoops, DesignAlgorithm::kExchange,
                                    DesignAlgorithm::kRandom};

PostureDesignOptions MakeOptions(const DesignCommand& command) {
  PostureDesignOptions options;
  options.chains = command.chains;
  options.elastic = command.elastic;
  options.compare_algorithms = command.curves;
  DesignOptions& design = options.design;
  design.criterion = static_cast<Criterion>(command.criterion[1] - '1');
  design.certify = !command.no_certificate;
  design.seed = command.common.seed.value_or(1);
  for (DesignAlgorithm algorithm : kAlgorithms) {
    if (command.algorithm == AlgorithmName(algorithm)) design.algorithm = algorithm;
  }
  design.nocp.block = command.block;
  design.nocp.plateau.tolerance = command.plateau;
  design.nocp.plateau.max_postures = command.max_count;
  if (command.count > 0) SetPostureCount(command.count, design);
  return options;
}

std::string FollowUpTable(const FollowUpDesign& design) {
  TextTable chains({"chain", "postures", "information nats"});
  TextTable zeros({"zero of", "smallest change that is seen"});
  for (const FollowUpChain& chain : design.chains) {
    chains.Add({chain.postures.chain, std::to_string(chain.postures.q.size()),
                fmt::format("{:.1f}", chain.information)});
    for (const ZeroSensitivity& zero : chain.zeros) {
      zeros.Add({zero.joint + " (" + chain.postures.chain + ")", SmallestChange(zero)});
    }
  }
  return "Postures after a calibration\n" + chains.Render() + "\n" + zeros.Render();
}

/// Designs postures after a calibration, and writes only a posture file.
int FollowUp(const DesignCommand& command, const Project& project) {
  CheckHasMarkers(project);
  const CalibrationFiles files = FindCalibrationFiles(command.after);
  OutputSet outputs;
  outputs.Protect({command.project, project.urdf, files.calibration, files.covariance});
  outputs.Declare(command.output, "robot: ");
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();
  const bool quiet = command.common.Silent();
  FollowUpOptions options{
      .aim = command.check ? SequentialAim::kChanges : SequentialAim::kParameters,
      .days = command.days,
      .marker_sd = 1e-3 * command.marker_noise_mm,
      .chains = command.chains,
      .joints = command.joints,
      .seed = command.common.seed.value_or(1)};
  if (command.count > 0) options.postures = command.count;
  const FollowUpDesign design =
      DesignFollowUp(project, command.after, options, TerminalProgress("designed chain", quiet));
  if (!design.infeasible.empty()) {
    spdlog::error("{}", design.infeasible);
    return kNotConverged;
  }
  outputs.Set(command.output, FormatPostureFile(project.tree, design.postures()));
  outputs.Set(command.common.json_file, MakeFollowUpJson(design, options));
  outputs.Publish();
  Print(quiet, FollowUpTable(design) + fmt::format("\nWrote {}\n", command.output));
  return kFine;
}

/// Refuses options that would have no effect on the search chain by chain.
void RefuseIdleOptions(const DesignCommand& command) {
  if (command.of_end.empty()) return;
  const std::string& option = command.of_end.front();
  if (command.count > 0) {
    throw InputError(option + ": it says where the search ends, and --count fixes the number");
  }
  if (command.algorithm != AlgorithmName(DesignAlgorithm::kNocp)) {
    throw InputError(option + ": it is for --algorithm nocp; the others take --count");
  }
}

int Design(const DesignCommand& command) {
  const Project project = WithRoom(ReadProject(command.project), command.limit_margin_deg);
  if (project.contact) {
    if (!command.of_chains.empty()) {
      throw InputError(command.of_chains.front() + ": it is for chains whose markers are seen; " +
                       project.file.string() +
                       " has contact or instruments, whose postures are designed all together");
    }
    return RunObservationDesign({command.common, command.output, command.count, command.after,
                                 command.days, command.check, command.joints},
                                project);
  }
  if (!command.after.empty()) return FollowUp(command, project);
  RefuseIdleOptions(command);
  const DesignFiles files(command.output);
  OutputSet outputs;
  outputs.Protect({command.project, project.urdf});
  files.Declare(outputs);
  DeclarePlanningReport(command.output, outputs);
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();

  const bool quiet = command.common.Silent();
  const PostureDesignOptions options = MakeOptions(command);
  const PostureDesign design =
      DesignPostures(project, options, TerminalProgress("designed chain", quiet));
  if (!design.infeasible.empty()) {
    spdlog::error("{}", design.infeasible);
    return kNotConverged;
  }
  SetDesignFiles(files, project, design, options, outputs);
  outputs.Set(command.common.json_file, FormatDesignSummary(project, design, options));
  const PlanningReport report = SetPlanningReport(
      command.output,
      MakeRunRecord("design", command.common, RecordInputs({command.project, project.urdf})),
      project, outputs);
  outputs.Publish();

  Print(quiet, "Calibration postures\n" + DesignTable(design));
  Print(quiet, fmt::format("{} postures in all: {:.1f} minutes at 5 s each\n\n"
                           "Wrote {} and {}, {}, {}\n",
                           design.posture_count(), design.posture_count() * 5.0 / 60.0,
                           files.postures.string(), files.summary.string(), files.curves.string(),
                           files.picture.string()));
  PrintWarnings(design.warnings(), command.common.verbose);
  PrintWarnings(report.warnings, command.common.verbose);
  PrintReportPlace(report.folder, report.why_none, quiet);
  return kFine;
}

void AddFollowUpOptions(CLI::App& command, DesignCommand& options) {
  CLI::Option* after = command
                           .add_option("--after", options.after,
                                       "An earlier calibration of the robot (output folder of "
                                       "calibrate): design the --count "
                                       "postures (8) that add most to it")
                           ->type_name("DIR");
  for (const char* option : kSearchOptions) after->excludes(option);
  CLI::Option* check =
      command
          .add_flag("--check", options.check,
                    "Design the postures that tell best whether a joint has moved since, for check")
          ->needs(after);
  command
      .add_option("--joints", options.joints,
                  "Joints whose movement --check shall tell; default: all")
      ->needs(check)
      ->expected(-1)
      ->type_name("NAME");
  command.add_option("--days", options.days, "Days since that calibration")
      ->needs(after)
      ->check(InBounds("check --days"))
      ->capture_default_str();
  command
      .add_option("--marker-noise-mm", options.marker_noise_mm,
                  "Noise of a marker's coordinate, errors of the model included, mm")
      ->needs(after)
      ->check(InBounds("assess --marker-noise-mm"))
      ->capture_default_str();
}

void AddSearchOptions(CLI::App& command, DesignCommand& options) {
  command
      .add_option("--count", options.count,
                  "Number of postures for each chain; default: as many as it takes. With "
                  "contact or instruments in the project, number in all (30)")
      ->check(FromTo(1, 1000));
  command.add_option("--max-count", options.max_count, "Largest number of postures for each chain")
      ->check(FromTo(1, 1000))
      ->capture_default_str();
  command
      .add_option(
          "--plateau", options.plateau,
          "The search ends when two additions in turn raise the index by less than this share")
      ->check(InBounds("design --plateau"))
      ->capture_default_str();
  command.add_option("--block", options.block, "Postures added at a time (N_p)")
      ->check(FromTo(1, 100))
      ->capture_default_str();
  command
      .add_option("--algorithm", options.algorithm,
                  "nocp finds out how many postures it takes; the others take --count (24)")
      ->transform(OneOf({"nocp", "cocp", "ioops", "exchange", "random"}))
      ->capture_default_str();
  command.add_option("--criterion", options.criterion, "Observability index")
      ->transform(OneOf({"O1", "O2", "O3", "O4", "O5"}))
      ->capture_default_str();
  command.add_flag(
      "--elastic", options.elastic,
      "Also determine the compliances of the joints (eq. 5), and of the one leg that stands "
      "(eq. 6)");
  command.add_flag("--curves", options.curves,
                   "Also show what the other algorithms reach (takes several times as long)");
  command.add_flag("--no-certificate", options.no_certificate,
                   "Do not compute the upper bound and the efficiency, which takes long");
}

}  // namespace

void AddDesign(CLI::App& app, Action& action) {
  auto options = std::make_shared<DesignCommand>();
  CLI::App* command =
      app.add_subcommand("design", "Find the smallest set of calibration postures that tell most");
  command->add_option("project", options->project, "Project file (YAML) with a section 'design'")
      ->required();
  command->add_option("-o,--output", options->output, "Posture file to write (YAML)")
      ->required()
      ->check(IsNamed)
      ->type_name("FILE");
  command->add_option("--chains", options->chains, "Only these chains")
      ->expected(-1)
      ->type_name("NAME");
  command
      ->add_option("--limit-margin-deg", options->limit_margin_deg,
                   "Left free at either end of the limits of turning joints, deg, at most a tenth "
                   "of a range: room for `compensate`; default: design.room_deg of the project")
      ->check(InBounds("plan --limit-margin-deg"));
  AddSearchOptions(*command, *options);
  AddFollowUpOptions(*command, *options);
  AddCommonOptions(*command, options->common);
  command->footer(
      "Example: elastocal design models/talos/project.yaml -o postures.yaml\n"
      "Example: elastocal design project.yaml --after out --check -o check.yaml");
  command->callback([&action, options, command] {
    for (const char* option : kSearchOptions) {
      if (command->count(option) > 0) options->of_chains.emplace_back(option);
    }
    for (const char* option : {"--max-count", "--plateau"}) {
      if (command->count(option) > 0) options->of_end.emplace_back(option);
    }
    for (const char* option : {"--chains", "--marker-noise-mm"}) {
      if (command->count(option) > 0) options->of_chains.emplace_back(option);
    }
    action = [options] { return Design(*options); };
  });
}

}  // namespace elastocal::cli
