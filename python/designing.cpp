// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/output_set.hpp"
#include "elastocal/planning/chain_setups.hpp"
#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/design_observations.hpp"
#include "elastocal/planning/leave_room.hpp"
#include "postures.hpp"

namespace elastocal::python {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::vector<Eigen::VectorXd> RowsOf(const py::handle& given, const Project& project,
                                    const std::string& chain) {
  const Names joints = CoordinateNames(project.tree);
  std::vector<Eigen::VectorXd> rows;
  for (const py::handle& row : given) {
    const auto one = py::reinterpret_borrow<py::object>(row);
    Eigen::VectorXd q = PositionsOf(one, joints, "postures of " + chain);
    if (py::isinstance<py::dict>(one)) {  // a posture file leaves missing joints at rest
      const auto named = one.cast<py::dict>();
      for (std::size_t i = 0; i < joints.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        if (!named.contains(joints[i])) q[at] = project.motion.rest[at];
      }
    }
    rows.push_back(std::move(q));
  }
  return rows;
}

std::vector<ChainPostures> FromDict(const py::dict& given, const Project& project) {
  const std::vector<ChainSetup> setups = SetupsOfBothSides(project);
  std::vector<ChainPostures> chains;
  for (const auto& [key, value] : given) {
    ChainPostures chain;
    chain.chain = key.cast<std::string>();
    for (const ChainSetup& setup : setups) {
      if (setup.name == chain.chain) chain.support = setup.support;
    }
    chain.q = RowsOf(value, project, chain.chain);
    chains.push_back(std::move(chain));
  }
  return chains;
}

void ExpectFeasible(const std::string& infeasible) {
  if (!infeasible.empty()) throw Infeasible(infeasible);
}

PyDesign DesignForInstruments(const Project& project, std::optional<int> count, std::uint64_t seed,
                              const Progress& progress) {
  ObservationDesignOptions options;
  options.count = count.value_or(options.count);
  options.seed = seed;
  ObservationDesign found = DesignObservations(project, options, progress);
  ExpectFeasible(found.infeasible);
  std::string summary = FormatObservationDesign(found);
  return {project, std::move(found.postures), std::move(summary)};
}

PyDesign DesignForMarkers(const Project& project, const PostureDesignOptions& options,
                          const Progress& progress) {
  PostureDesign found = DesignPostures(WithRoom(project, std::nullopt), options, progress);
  ExpectFeasible(found.infeasible);
  PyDesign design{project, found.postures(), FormatDesignSummary(project, found, options),
                  found.warnings()};
  design.whole = std::move(found);
  design.options = options;
  return design;
}

PyDesign Design(const ProjectOrFile& project_or_file, const Names& chains, std::optional<int> count,
                int max_count, double plateau, int block, const std::string& algorithm,
                const std::string& criterion, bool elastic, bool curves, bool certificate,
                std::uint64_t seed, const Progress& progress) {
  const Project& project = project_or_file.project;
  if (count) ExpectWithin("count", *count, 1, 1000);
  ExpectWithin("max_count", max_count, 1, 1000);
  ExpectWithin("block", block, 1, 100);
  ExpectBounded("design --plateau", plateau);
  PostureDesignOptions options;
  options.chains = chains;
  options.elastic = elastic;
  options.compare_algorithms = curves;
  DesignOptions& of = options.design;
  of.algorithm = Named<DesignAlgorithm>("algorithm", algorithm,
                                        {{"nocp", DesignAlgorithm::kNocp},
                                         {"cocp", DesignAlgorithm::kCocp},
                                         {"ioops", DesignAlgorithm::kIoops},
                                         {"exchange", DesignAlgorithm::kExchange},
                                         {"random", DesignAlgorithm::kRandom}});
  of.criterion = Named<Criterion>("criterion", criterion,
                                  {{"O1", Criterion::kO1},
                                   {"O2", Criterion::kO2},
                                   {"O3", Criterion::kO3},
                                   {"O4", Criterion::kO4},
                                   {"O5", Criterion::kO5}});
  of.certify = certificate;
  of.seed = seed;
  of.nocp.block = block;
  of.nocp.plateau.tolerance = plateau;
  of.nocp.plateau.max_postures = max_count;
  if (count) SetPostureCount(*count, of);
  return Unlocked([&] {
    return project.contact ? DesignForInstruments(project, count, seed, progress)
                           : DesignForMarkers(project, options, progress);
  });
}

PyDesign DesignAfter(const ProjectOrFile& project_or_file, const Path& calibration, bool check,
                     int count, const Names& chains, const Names& joints, double days,
                     double marker_noise_mm, std::uint64_t seed, const Progress& progress) {
  const Project& project = project_or_file.project;
  ExpectWithin("count", count, 1, 1000);
  ExpectBounded("check --days", days);
  ExpectBounded("assess --marker-noise-mm", marker_noise_mm);
  if (!joints.empty() && !check) throw InputError("joints: only with check=True");
  const FollowUpOptions options{.aim = check ? SequentialAim::kChanges : SequentialAim::kParameters,
                                .postures = count,
                                .days = days,
                                .marker_sd = 1e-3 * marker_noise_mm,
                                .chains = chains,
                                .joints = joints,
                                .seed = seed};
  if (project.contact) {
    return Unlocked([&] {
      const ObservationDesign found = DesignObservations(project,
                                                         {.count = count,
                                                          .seed = seed,
                                                          .after = calibration,
                                                          .days = days,
                                                          .changes = check,
                                                          .joints = joints},
                                                         progress);
      ExpectFeasible(found.infeasible);
      return PyDesign{project, found.postures, FormatObservationDesign(found)};
    });
  }
  return Unlocked([&] {
    const FollowUpDesign found = DesignFollowUp(project, calibration, options, progress);
    ExpectFeasible(found.infeasible);
    return PyDesign{project, found.postures(), MakeFollowUpJson(found, options)};
  });
}

void SaveDesign(const PyDesign& design, const Path& file) {
  OutputSet outputs;
  outputs.Protect({design.project.file, design.project.urdf});
  if (!design.whole) {
    outputs.Declare(file, "robot: ");
    outputs.Prepare();
    outputs.Set(file, design.text());
  } else {
    const DesignFiles files(file);
    files.Declare(outputs);
    outputs.Prepare();
    SetDesignFiles(files, design.project, *design.whole, design.options, outputs);
  }
  outputs.Publish();
}

py::dict PosturesByChain(const PyDesign& design) {
  py::dict chains;
  for (const ChainPostures& of : design.postures) {
    RowMajor q(of.q.size(), design.project.tree.coordinate_count());
    for (std::size_t i = 0; i < of.q.size(); ++i) {
      q.row(static_cast<Eigen::Index>(i)) = of.q[i].transpose();
    }
    chains[py::str(of.chain)] = q;
  }
  return chains;
}

py::dict SupportByChain(const PyDesign& design) {
  py::dict chains;
  for (const ChainPostures& of : design.postures) {
    Names links;
    for (int link : of.support) links.push_back(design.project.tree.links[link].name);
    chains[py::str(of.chain)] = links;
  }
  return chains;
}

}  // namespace

std::vector<ChainPostures> PosturesOf(const py::object& given, const Project& project) {
  if (py::isinstance<PyDesign>(given)) {
    return ParsePostureFile(given.cast<const PyDesign&>().text(), "postures", project);
  }
  if (py::isinstance<py::dict>(given)) {
    const auto chains = FromDict(given.cast<py::dict>(), project);
    return ParsePostureFile(FormatPostureFile(project.tree, chains), "postures", project);
  }
  return ReadPostureFile(given.cast<Path>(), project);
}

void AddDesigning(py::module_& module) {
  const PlateauRule plateau;
  const FollowUpOptions follow_up;
  py::class_<PyDesign>(module, "Design", "Calibration postures that design() found.")
      .def_property_readonly("postures", PosturesByChain,
                             "By chain (or plate), an array (postures, joints), rad or m.")
      .def_property_readonly("support", SupportByChain,
                             "By chain, the links that stand on the floor meanwhile.")
      .def_property_readonly(
          "summary", [](const PyDesign& d) { return FromJson(d.summary); },
          "The dict of `elastocal design --json`: index, bound, efficiency of each chain ...")
      .def_property_readonly(
          "warnings", [](const PyDesign& d) { return d.warnings; },
          "What a user should know, a sentence each.")
      .def_property_readonly("text", &PyDesign::text, "The posture file.")
      .def("save", SaveDesign, "file"_a, py::call_guard<LongCall>(),
           "Writes the posture file (YAML) and, as the program does, summary and curves beside "
           "it.");
  module.def(
      "design", Design, "project"_a, py::kw_only(), "chains"_a = Names(), "count"_a = std::nullopt,
      "max_count"_a = plateau.max_postures, "plateau"_a = plateau.tolerance,
      "block"_a = NocpOptions().block, "algorithm"_a = "nocp", "criterion"_a = "O1",
      "elastic"_a = false, "curves"_a = false, "certificate"_a = true, "seed"_a = 1,
      "progress"_a = Progress(),
      "Finds the smallest set of postures that tells most of the identifiable parameters, like the "
      "command of that name. count: exactly so many for each chain. elastic: compliances too. "
      "curves: also what other algorithms reach. progress: called with (done, total). Raises "
      "InfeasibleError where a chain has no such postures.");
  module.def(
      "design_after", DesignAfter, "project"_a, "calibration"_a, py::kw_only(), "check"_a = false,
      "count"_a = follow_up.postures, "chains"_a = Names(), "joints"_a = Names(),
      "days"_a = follow_up.days, "marker_noise_mm"_a = 1e3 * follow_up.marker_sd, "seed"_a = 1,
      "progress"_a = Progress(),
      "Chooses, like `elastocal design --after`, `count` postures of each chain that add most to a "
      "saved calibration or, with check=True, that tell best whether a joint (of `joints`, or any) "
      "has moved since (with contact or instruments, `count` in all). days: since the calibration. "
      "marker_noise_mm: of a coordinate, errors of the model included.");
}

}  // namespace elastocal::python
