#include "elastocal/posture/design.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/design_problem.hpp"
#include "elastocal/cli/design_report.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {
namespace {

struct DesignCommand {
  CommonOptions common;
  std::string project, output, criterion = "O1", algorithm = "nocp";
  std::vector<std::string> chains;
  int postures = 0, max_postures = PlateauRule().max_postures, block = 4;
  double plateau = PlateauRule().tolerance;
  bool elastic = false, no_certificate = false, curves = false;
};

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

constexpr std::array kAlgorithms = {DesignAlgorithm::kNocp, DesignAlgorithm::kCocp,
                                    DesignAlgorithm::kIoops, DesignAlgorithm::kExchange,
                                    DesignAlgorithm::kRandom};

DesignOptions MakeOptions(const DesignCommand& command) {
  DesignOptions options;
  options.criterion = static_cast<Criterion>(command.criterion[1] - '1');
  options.certify = !command.no_certificate;
  options.seed = command.common.seed.value_or(1);
  for (DesignAlgorithm algorithm : kAlgorithms) {
    if (command.algorithm == AlgorithmName(algorithm)) options.algorithm = algorithm;
  }
  options.nocp.block = command.block;
  options.nocp.plateau.tolerance = command.plateau;
  options.nocp.plateau.max_postures = command.max_postures;
  if (command.postures > 0) {
    options.nocp.plateau.tolerance = -1.0;
    options.nocp.plateau.max_postures = command.postures;
    options.postures = command.postures;
  }
  return options;
}

/// What `design` finds.
struct Programme {
  std::vector<Designed> designed;
  std::vector<CurvePoint> points;
};

/// The postures of the chain on the other side.
Designed DesignOtherSide(const Project& project, const ChainDesign& design, bool elastic,
                         const DesignOptions& options) {
  const double start = Seconds();
  const ChainSetup other = OtherSide(project, design.setup);
  const DesignedChain chain = PrepareChain(project, other, elastic);
  std::string reason;
  const auto mirror =
      FindMirror(project.tree, design.setup.coordinates, other.coordinates, &reason);
  Designed opposite;
  if (mirror) {
    opposite.design = MirrorDesign(design, *mirror, *chain.model, chain.base.kept, project.motion,
                                   other, options);
  } else {
    opposite.design = DesignChain(*chain.model, chain.base.kept, project.motion, other, options);
    opposite.design.notes.push_back("designed by itself: " + reason);
  }
  opposite.seconds = Seconds() - start;
  return opposite;
}

/// Both sides of a chain, where it has two.
void DesignSides(const Project& project, const ChainSetup& setup, const DesignCommand& command,
                 const DesignOptions& options, Programme& programme) {
  const double start = Seconds();
  const DesignedChain chain = PrepareChain(project, setup, command.elastic);
  const ChainDesign design =
      DesignChain(*chain.model, chain.base.kept, project.motion, setup, options);
  programme.designed.push_back({design, Seconds() - start});
  for (std::size_t i = 0; i < design.sizes.size(); ++i) {
    programme.points.push_back({options.algorithm, setup.name, design.sizes[i], design.indices[i]});
  }
  if (design.index == 0.0) return;
  if (command.curves) {
    for (const CurvePoint& point : CompareAlgorithms(*chain.model, chain.base.kept, project.motion,
                                                     setup, design.sizes, options)) {
      programme.points.push_back(point);
    }
  }
  if (!setup.mirror.empty()) {
    programme.designed.push_back(DesignOtherSide(project, design, command.elastic, options));
  }
}

/// "postures.yaml" -> "postures_summary.json".
std::string Beside(const std::string& output, const std::string& ending) {
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + ending)).string();
}

/// Why a chain has no postures that determine its parameters; empty where it has.
std::string WhyInfeasible(const ChainDesign& design) {
  if (design.index > 0.0) return "";
  const std::string chain = "chain '" + design.setup.name + "': ";
  if (design.status == DesignResult::Status::kNoPosture) {
    return chain + "no feasible posture was found; what stands in the way most often is the " +
           design.blame;
  }
  return chain +
         "its feasible postures do not determine all parameters; hold some (identifiability: "
         "hold) or widen its workspace";
}

int Design(const DesignCommand& command) {
  const Project project = ReadProject(command.project);
  const std::vector<std::string> outputs = {command.output, Beside(command.output, "_summary.json"),
                                            Beside(command.output, "_curves.csv"),
                                            Beside(command.output, "_curves.svg")};
  CheckOutputs({outputs.begin(), outputs.end()}, {command.project, project.urdf});
  CheckOutputs({command.common.json_file}, {command.project, project.urdf});
  if (command.algorithm == "exchange" && command.criterion != "O1") {
    throw InputError("--algorithm exchange is for --criterion O1");
  }
  const bool quiet = command.common.Silent();
  const DesignOptions options = MakeOptions(command);
  Programme programme;
  const std::vector<Designed>& designed = programme.designed;
  for (const ChainSetup& setup : ChosenSetups(project, command.chains)) {
    DesignSides(project, setup, command, options, programme);
    if (const std::string why = WhyInfeasible(designed.back().design); !why.empty()) {
      spdlog::error("{}", why);
      return kNotConverged;
    }
  }
  std::vector<std::string> warnings;
  std::vector<ChainPostures> postures;
  std::size_t total = 0;
  for (const auto& [design, seconds] : designed) {
    postures.push_back({design.setup.name, design.setup.support, design.postures});
    total += design.postures.size();
    for (const std::string& note : design.notes) {
      warnings.push_back(design.setup.name + ": " + note);
    }
  }
  const nlohmann::ordered_json json =
      DesignJson(designed, project.tree.name, command.criterion, options.seed);
  WriteFiles({{outputs[0], FormatPostureFile(project.tree, postures)},
              {outputs[1], json.dump(2) + "\n"},
              {outputs[2], CurvesCsv(programme.points, options.seed)},
              {outputs[3], CurvesSvg(programme.points, command.criterion)}});
  if (!command.common.json_file.empty()) {
    WriteFile(command.common.json_file, json.dump(2) + "\n");
  }
  Print(quiet, "Calibration postures\n" + DesignTable(designed));
  Print(quiet, fmt::format("{} postures in all: {:.1f} minutes at 5 s each\n\nWrote {} and {}\n",
                           total, static_cast<double>(total) * 5.0 / 60.0, outputs[0],
                           fmt::join(outputs.begin() + 1, outputs.end(), ", ")));
  PrintWarnings(warnings);
  WritePlanningReport(command.output, "design", command.common, project, {});
  return kFine;
}

}  // namespace

void AddDesign(CLI::App& app, Action& action) {
  auto options = std::make_shared<DesignCommand>();
  CLI::App* command =
      app.add_subcommand("design", "Find the smallest set of calibration postures that tell most");
  command->add_option("project", options->project, "Project file (YAML) with a section 'design'")
      ->required();
  command->add_option("-o,--output", options->output, "Posture file to write (YAML)")->required();
  command->add_option("--chain", options->chains, "Only these chains")->expected(-1);
  command
      ->add_option("--postures", options->postures,
                   "Exactly so many for each chain instead of as many as it takes")
      ->check(CLI::Range(1, 1000));
  command->add_option("--max-postures", options->max_postures, "At most so many for each chain")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--plateau", options->plateau,
                   "Ends when two additions in turn change the index by less than this, relatively")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--block", options->block, "Postures added at a time (N_p)")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command
      ->add_option("--algorithm", options->algorithm,
                   "nocp finds out how many postures it takes; the others take --postures (24)")
      ->check(CLI::IsMember({"nocp", "cocp", "ioops", "exchange", "random"}))
      ->capture_default_str();
  command->add_option("--criterion", options->criterion, "Observability index")
      ->check(CLI::IsMember({"O1", "O2", "O3", "O4", "O5"}))
      ->capture_default_str();
  command->add_flag(
      "--elastic", options->elastic,
      "The compliances of the joints (eq. 5), and of the one leg that stands (eq. 6), shall be "
      "determined too");
  command->add_flag("--curves", options->curves,
                    "Also show what the other algorithms reach (takes several times as long)");
  command->add_flag("--no-certificate", options->no_certificate,
                    "Without the upper bound and the efficiency");
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal design models/talos/project.yaml -o postures.yaml");
  command->callback([&action, options] { action = [options] { return Design(*options); }; });
}

}  // namespace elastocal::cli
