#include "elastocal/posture/assess.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/design_problem.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/measurements.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / M_PI;

struct AssessCommand {
  CommonOptions common;
  std::string project, postures;
  std::vector<std::filesystem::path> recordings;
  std::vector<std::string> chains;
  double marker_sd_mm = 0.2;
  int weakest = 5;
  bool elastic = false;
};

/// A set of postures with what was found about it.
struct Assessed {
  ChainSetup setup;
  const ErrorModel* model;
  std::vector<int> base;
  int postures = 0;
  Assessment assessment;
};

/// The set-up of a chain of either side.
ChainSetup SetupOf(const Project& project, const std::string& chain) {
  for (const ChainSetup& setup : SetupsOfBothSides(project)) {
    if (setup.name == chain) return setup;
  }
  throw InputError(project.file.string() + ": section 'design' says nothing of chain '" + chain +
                   "'");
}

std::vector<int> Weakest(const Eigen::VectorXd& sd, const ErrorModel& model,
                         const std::vector<int>& base, int count) {
  std::vector<int> order;
  for (std::size_t i = 0; i < base.size(); ++i) {
    if (!IsExternal(model.parameters[base[i]].kind)) order.push_back(static_cast<int>(i));
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) { return sd[a] > sd[b]; });
  order.resize(std::min<std::size_t>(order.size(), static_cast<std::size_t>(count)));
  return order;
}

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

std::string AssessedText(const Assessed& assessed, const RobotTree& tree, int weakest) {
  const Assessment& a = assessed.assessment;
  std::string text = fmt::format("{}: {} postures, {} parameters\n", assessed.setup.name,
                                 assessed.postures, assessed.base.size());
  int broken = 0;
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    if (a.violations[i].amount <= kFeasible) continue;
    if (++broken <= 3) {
      text += fmt::format("  posture {} breaks the {} by {:.3g}\n", i + 1, a.violations[i].what,
                          a.violations[i].amount);
    }
  }
  if (broken > 3) text += fmt::format("  and {} more postures break limits\n", broken - 3);
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
                        DescribePosture(tree, assessed.setup, a.best_addition));
  }
  text += "  weakest parameters (standard deviation from these postures alone):\n";
  for (int i : Weakest(a.parameter_sd, *assessed.model, assessed.base, weakest)) {
    const Parameter& parameter = assessed.model->parameters[assessed.base[i]];
    text += std::isfinite(a.parameter_sd[i])
                ? fmt::format("    {} {:.4g} {}\n", parameter.name,
                              InUserUnits(parameter, a.parameter_sd[i]), UserUnit(parameter))
                : fmt::format("    {} not determined\n", parameter.name);
  }
  return text;
}

Json AssessedJson(const Assessed& assessed, int weakest) {
  const Assessment& a = assessed.assessment;
  Json weak = Json::object();
  for (int i : Weakest(a.parameter_sd, *assessed.model, assessed.base, weakest)) {
    const double sd = a.parameter_sd[i];
    weak[assessed.model->parameters[assessed.base[i]].name] =
        std::isfinite(sd) ? Json(sd) : Json(nullptr);
  }
  Json broken = Json::array();
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    if (a.violations[i].amount <= kFeasible) continue;
    broken.push_back(
        {{"posture", i + 1}, {"what", a.violations[i].what}, {"amount", a.violations[i].amount}});
  }
  return {{"chain", assessed.setup.name},
          {"postures", assessed.postures},
          {"parameters", assessed.base.size()},
          {"o1", a.indices.o1},
          {"o2", a.indices.o2},
          {"o3", a.indices.o3},
          {"o4", a.indices.o4},
          {"o5", a.indices.o5},
          {"bound", a.certificate.bound},
          {"efficiency", a.efficiency},
          {"adds_least", a.adds_least + 1},
          {"loss", std::vector<double>(a.loss.begin(), a.loss.end())},
          {"o1_with_best_addition", a.o1_with_addition},
          {"best_addition", std::vector<double>(a.best_addition.begin(), a.best_addition.end())},
          {"weakest_sd", weak},
          {"infeasible", broken}};
}

/// Whether a posture of a recording exercises the chain: in a trial with a chain that ends where
/// this one does, or in a table of postures.
bool Exercises(const Recording& recording, Eigen::Index posture, const Project& project,
               const ChainSetup& setup) {
  if (recording.trials.empty()) return true;
  const Trial& trial = recording.trials[recording.trial[posture]];
  return std::any_of(project.chains.begin(), project.chains.end(), [&](const Chain& chain) {
    const auto& names = trial.chains;
    return chain.tip_link == setup.tip_link &&
           std::find(names.begin(), names.end(), chain.name) != names.end();
  });
}

/// The postures of a recording, by chain of the project's design and of their mirror images.
std::vector<ChainPostures> RecordedPostures(const AssessCommand& command) {
  const Project project = ReadProject(command.project);
  const Recording recording =
      ReadMeasurements(project, {command.recordings.begin(), command.recordings.end()},
                       ReadFor::kAnyUse)
          .calibration;
  std::vector<ChainPostures> sets;
  for (const ChainSetup& setup : SetupsOfBothSides(project)) {
    ChainPostures set{setup.name, setup.support, {}};
    for (Eigen::Index i = 0; i < recording.q.rows(); ++i) {
      if (Exercises(recording, i, project, setup)) {
        set.q.push_back(recording.q.row(i).transpose());
      }
    }
    if (!set.q.empty()) sets.push_back(std::move(set));
  }
  return sets;
}

int Assess(const AssessCommand& command) {
  const Project project = ReadProject(command.project);
  CheckOutputs({command.common.json_file}, {command.project, project.urdf, command.postures});
  ChosenSetups(project, {});  // says so where there is no section `design`
  const std::vector<ChainPostures> sets = command.postures.empty()
                                              ? RecordedPostures(command)
                                              : ReadPostureFile(command.postures, project);
  const bool quiet = command.common.Silent();
  AssessOptions options;
  options.marker_sd = 1e-3 * command.marker_sd_mm;
  options.seed = command.common.seed.value_or(1);
  options.certificate.seed = options.seed;
  Json chains = Json::array();
  for (const ChainPostures& set : sets) {
    if (!command.chains.empty() && std::find(command.chains.begin(), command.chains.end(),
                                             set.chain) == command.chains.end()) {
      continue;
    }
    const DesignedChain chain = PrepareChain(project, SetupOf(project, set.chain), command.elastic);
    PostureProblem problem =
        MakeChainProblem(*chain.model, chain.base.kept, project.motion, chain.setup);
    PostureSet postures(problem.column_count());
    for (const Eigen::VectorXd& q : set.q) postures.Add(problem, q(chain.setup.coordinates));
    const Assessed assessed{chain.setup, chain.model.get(), chain.base.kept, postures.size(),
                            AssessPostures(problem, postures, options)};
    Print(quiet, AssessedText(assessed, project.tree, command.weakest) + "\n");
    chains.push_back(AssessedJson(assessed, command.weakest));
  }
  if (chains.empty()) throw InputError("--chain: there are no postures of these chains");
  if (!command.common.json_file.empty()) {
    WriteFile(command.common.json_file, Json{{"chains", chains}}.dump(2) + "\n");
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
  auto* postures = command->add_option("--postures", options->postures, "Posture file (YAML)");
  command
      ->add_option("--recording", options->recordings,
                   "Instead: a posture table (CSV), or recording folders")
      ->excludes(postures)
      ->expected(-1);
  command->add_option("--chain", options->chains, "Only these chains")->expected(-1);
  command
      ->add_option("--marker-sd", options->marker_sd_mm,
                   "Noise of a marker coordinate that the standard deviations are for, mm")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--weakest", options->weakest, "How many of the weakest parameters to show")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_flag(
      "--elastic", options->elastic,
      "The compliances of the joints (eq. 5), and of the one leg that stands (eq. 6), shall be "
      "determined too");
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
