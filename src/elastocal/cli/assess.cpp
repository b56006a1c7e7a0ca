// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/experiment.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/assess_postures.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal::cli {
namespace {

constexpr double kDegrees = 180.0 / M_PI;

struct AssessCommand {
  CommonOptions common;
  std::string project, postures;
  std::vector<std::filesystem::path> recordings;
  std::vector<std::string> chains;
  double marker_noise_mm = 0.2;
  int weakest = 5;
  bool elastic = false;
};

std::string DescribePosture(const RobotTree& tree, const ChainSetup& setup,
                            const Eigen::VectorXd& x) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < setup.coordinates.size(); ++i) {
    const Joint& joint = tree.joints[tree.coordinate_joint[setup.coordinates[i]]];
    const bool revolute = joint.type == JointType::kRevolute;
    parts.push_back(fmt::format("{} {:.1f} {}", joint.name,
                                (revolute ? kDegrees : 1e3) * x[static_cast<Eigen::Index>(i)],
                                revolute ? "deg" : "mm"));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string AssessedText(const ChainAssessment& chain, const RobotTree& tree, int weakest) {
  const Assessment& a = chain.assessment;
  std::string text = fmt::format("{}: {} postures, {} parameters\n", chain.setup.name,
                                 chain.posture_count, chain.parameters.size());
  int broken = 0;
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    if (a.violations[i].amount <= kFeasible) continue;
    if (++broken <= 3) {
      text += fmt::format("  posture {} {}\n", i + 1, a.violations[i].Describe());
    }
  }
  if (broken > 3) {
    text += fmt::format("  and {} more postures break limits or cannot be reached\n", broken - 3);
  }
  if (a.indices.o1 == 0.0) {
    text += "  these postures do not determine all parameters (O1 = 0)\n";
  } else {
    text += fmt::format("  O1 = {:.4f}, {:.1f} % of the most that is possible ({:.4f})\n",
                        a.indices.o1, 100.0 * a.efficiency, a.certificate.bound);
    text += fmt::format("  posture {} adds least: without it the set loses {:.2f} %\n",
                        a.adds_least + 1, 100.0 * a.loss[a.adds_least]);
  }
  if (a.best_addition.size() > 0) {
    text += fmt::format("  one posture more would give O1 = {:.4f}: {}\n", a.o1_with_addition,
                        DescribePosture(tree, chain.setup, a.best_addition));
  }
  text += "  weakest parameters (standard deviation from these postures alone):\n";
  for (int i : chain.WeakestParameters(weakest)) {
    const Parameter& parameter = chain.parameters[i];
    text +=
        std::isfinite(a.parameter_sd[i])
            ? fmt::format("    {} {} {}\n", parameter.name,
                          RoundedSd(InUserUnits(parameter, a.parameter_sd[i])), UserUnit(parameter))
            : fmt::format("    {} not determined\n", parameter.name);
  }
  return text;
}

std::vector<ChainPostures> GivenPostures(const AssessCommand& command, const Project& project) {
  if (!command.postures.empty()) return ReadPostureFile(command.postures, project);
  const std::vector<std::filesystem::path> recordings(command.recordings.begin(),
                                                      command.recordings.end());
  const Measurements measured = ReadMeasurements(project, recordings, ReadFor::kAnyUse);
  PrintWarnings(measured.warnings, command.common.verbose);
  return RecordedPostures(project, measured.calibration);
}

int Assess(const AssessCommand& command) {
  const Project project = ReadProject(command.project);
  OutputSet outputs;
  outputs.Protect(InputFiles(project, {command.recordings.begin(), command.recordings.end()}));
  outputs.Protect({command.postures});
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();

  PostureAssessmentOptions options;
  options.chains = command.chains;
  options.elastic = command.elastic;
  options.assess.marker_sd = 1e-3 * command.marker_noise_mm;
  options.assess.seed = command.common.seed.value_or(1);
  options.assess.certificate.seed = options.assess.seed;
  const bool quiet = command.common.Silent();
  const std::vector<ChainAssessment> chains = AssessPostures(
      project, GivenPostures(command, project), options, TerminalProgress("assessed chain", quiet));
  outputs.Set(command.common.json_file, FormatAssessment(chains, command.weakest));
  outputs.Publish();
  for (const ChainAssessment& chain : chains) {
    Print(quiet, AssessedText(chain, project.tree, command.weakest) + "\n");
  }
  return kFine;
}

}  // namespace

void AddAssess(CLI::App& app, Action& action) {
  auto options = std::make_shared<AssessCommand>();
  CLI::App* command =
      app.add_subcommand("assess", "Say what a set of calibration postures is worth");
  command->add_option("project", options->project, "Project file (YAML) with a section 'design'")
      ->required();
  auto* postures = command->add_option("--postures", options->postures, "Posture file (YAML)")
                       ->type_name("FILE");
  command
      ->add_option("--recording", options->recordings,
                   "Instead: a posture table (CSV), or recording folders")
      ->excludes(postures)
      ->expected(-1);
  command->add_option("--chains", options->chains, "Only these chains")
      ->expected(-1)
      ->type_name("NAME");
  command
      ->add_option("--marker-noise-mm", options->marker_noise_mm,
                   "Noise of a marker coordinate that the standard deviations are for, mm")
      ->check(InBounds("assess --marker-noise-mm"))
      ->capture_default_str();
  command->add_option("--weakest", options->weakest, "How many of the weakest parameters to show")
      ->check(FromTo(0, 1000))
      ->capture_default_str();
  command->add_flag(
      "--elastic", options->elastic,
      "Also judge by the compliances of the joints (eq. 5), and of the one leg that stands "
      "(eq. 6)");
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal assess models/talos/project.yaml --postures postures.yaml");
  command->callback([&action, options] {
    if (options->postures.empty() && options->recordings.empty()) {
      throw CLI::RequiredError("--postures or --recording");
    }
    action = [options] { return Assess(*options); };
  });
}

}  // namespace elastocal::cli
