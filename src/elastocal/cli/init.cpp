// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/drafting/draft.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/report/page.hpp"
#include "elastocal/report/version.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal::cli {
namespace {

struct InitCommand {
  CommonOptions common;
  std::string urdf, srdf, output;
  std::vector<std::string> packages;
  bool force = false;
};

/// Refuses to replace a project unless forced, because somebody may have corrected it.
void RefuseToReplace(const std::filesystem::path& file, bool force) {
  if (force || FileTypeOf(file) == std::filesystem::file_type::not_found) return;
  throw InputError(file.string() + " is there already; --force replaces it");
}

/// Path of the robot description to be used: the given file, if it is already in the folder and
/// needs no added links.
std::filesystem::path PlaceOfUrdf(const std::filesystem::path& urdf,
                                  const std::filesystem::path& folder, bool changed) {
  const std::filesystem::path copy = folder / urdf.filename();
  std::error_code none;
  if (!std::filesystem::equivalent(copy, urdf, none)) return copy;
  if (!changed) return {};
  return folder / (urdf.stem().string() + "_soles" + urdf.extension().string());
}

/// Adds the folders in an environment variable, each followed by `below`.
void AddRoots(const char* variable, const std::filesystem::path& below, MeshPlaces& places) {
  const char* value = std::getenv(variable);
  std::istringstream list(value == nullptr ? "" : value);
  for (std::string folder; std::getline(list, folder, ':');) {
    if (!folder.empty()) places.roots.push_back(std::filesystem::path(folder) / below);
  }
}

MeshPlaces FindPlaces(const InitCommand& command) {
  MeshPlaces places;
  places.urdf = command.urdf;
  for (const std::string& given : command.packages) {
    const std::size_t equals = given.find('=');
    if (equals == 0 || equals == std::string::npos) {
      throw InputError("--package: found '" + given + "'; NAME=DIR was expected");
    }
    const std::filesystem::path folder = given.substr(equals + 1);
    if (FileTypeOf(folder) != std::filesystem::file_type::directory) {
      throw InputError("--package: there is no folder '" + folder.string() + "'");
    }
    places.packages[given.substr(0, equals)] = folder;
  }
  AddRoots("ROS_PACKAGE_PATH", "", places);
  AddRoots("AMENT_PREFIX_PATH", "share", places);
  return places;
}

std::string ChainTable(const ProjectDraft& draft) {
  TextTable table({"chain", "from", "tip", "postures designed", "contacts checked"});
  for (const DraftedChain& chain : draft.chains) {
    std::string designed, contacts;
    for (const ChainSetup& setup : draft.designs) {
      if (setup.name == chain.name) {
        designed = "yes";
        contacts = std::to_string(setup.contacts.size());
      }
      if (setup.mirror == chain.name) designed = "mirror of " + setup.name;
    }
    table.Add({chain.name, draft.tree.links[Size(chain.from_link)].name,
               draft.tree.links[Size(chain.tip_link)].name, designed, contacts});
  }
  return table.Render();
}

/// Writes the page that shows the draft. Returns why there is none; empty where there is one.
std::string WritePage(const std::filesystem::path& folder) {
  if (PageTemplate().empty()) return kNoPage;
  const std::filesystem::path page = folder / "report.html";
  try {
    OutputSet outputs;
    outputs.Protect(PageInputs(folder, {}));
    DeclarePage(folder, page, outputs);
    outputs.Prepare();
    SetPage(folder, page, MakeFolderPage(folder, ProgramVersion()), outputs);
    outputs.Publish();
  } catch (const InputError& error) {
    return std::string("no report.html: ") + error.what();  // the draft itself is written
  }
  return {};
}

int Init(const InitCommand& command) {
  const std::filesystem::path folder = command.output;
  const std::filesystem::path project = folder / "project.yaml";
  const std::string urdf = ReadFile(command.urdf);
  Semantics semantics;
  if (!command.srdf.empty()) semantics = ParseSemantics(ReadFile(command.srdf), command.srdf);
  const ProjectDraft draft = DraftProject(urdf, command.urdf, semantics, FindPlaces(command));
  const std::filesystem::path copy = PlaceOfUrdf(command.urdf, folder, draft.urdf != urdf);

  RefuseToReplace(project, command.force);
  if (!copy.empty()) RefuseToReplace(copy, command.force);
  OutputSet outputs;
  outputs.Protect({command.urdf, command.srdf});
  outputs.Declare(project);
  outputs.Declare(copy);
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();
  const std::filesystem::path described = copy.empty() ? std::filesystem::path(command.urdf) : copy;
  const std::filesystem::path staged =
      copy.empty() ? std::filesystem::path(command.urdf) : outputs.StagingPath(copy);
  if (!copy.empty()) std::ofstream(staged, std::ios::binary) << draft.urdf;
  RequireReadable(draft, project, staged);
  outputs.Set(project, FormatDraft(draft, described.filename().string()));
  outputs.Set(command.common.json_file, FormatDraftSummary(draft));
  outputs.Publish();

  const bool quiet = command.common.Silent();
  Print(quiet, fmt::format("Robot {}: {} joints, {} meshes read, {} markers, {} spheres\n\n{}\n",
                           draft.tree.name, draft.tree.joints.size(), draft.shapes.meshes,
                           3 * draft.clusters.size(), draft.spheres.size(), ChainTable(draft)));
  Print(quiet, "Posture of rest: " + draft.rest.source + "\n");
  Print(quiet,
        fmt::format("Wrote {}{}\n", project.string(), copy.empty() ? "" : " and " + copy.string()));
  PrintReportPlace(folder, WritePage(folder), quiet);
  Print(quiet, fmt::format("Look at it, correct project.yaml where it is wrong, then: elastocal "
                           "inspect {0}\n(elastocal report {1} draws the corrected one)\n",
                           project.string(), folder.string()));
  PrintWarnings(draft.warnings, command.common.verbose);
  return kFine;
}

}  // namespace

void AddInit(CLI::App& app, Action& action) {
  auto options = std::make_shared<InitCommand>();
  CLI::App* command = app.add_subcommand("init", "Draft a project from a robot description");
  command->add_option("urdf", options->urdf, "Robot description (URDF)")->required();
  command
      ->add_option("--srdf", options->srdf,
                   "Semantic description: names of limbs, posture of rest, links that never touch")
      ->type_name("FILE");
  command
      ->add_option("--package", options->packages,
                   "Folder of a package that meshes are in; otherwise they are looked for in "
                   "ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and above the robot description")
      ->allow_extra_args(false)
      ->type_name("NAME=DIR");
  command
      ->add_option("-o,--output", options->output,
                   "Folder for project.yaml and a copy of the robot description")
      ->required()
      ->check(IsNamed)
      ->type_name("DIR");
  command->add_flag("--force", options->force, "Replace a project that is there already");
  AddOutputOptions(*command, options->common);
  command->footer("Example: elastocal init models/talos/talos.urdf -o my_robot");
  command->callback([&action, options] { action = [options] { return Init(*options); }; });
}

}  // namespace elastocal::cli
