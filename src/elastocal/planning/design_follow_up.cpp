// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/design_follow_up.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/planning/chain_setups.hpp"
#include "elastocal/robot/zero_offset.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/validation/earlier_markers.hpp"

namespace elastocal {
namespace {

/// A calibration, for the design of any chain.
struct Known {
  StoredCalibration stored;
  CalibrationEstimate estimate;
};

/// All parameters that the chain's postures can tell, identifiable or not; prior knowledge
/// determines the rest.
std::vector<int> Columns(const DesignedChain& chain) {
  std::vector<int> columns;
  for (int i = 0; i < chain.model->parameter_count(); ++i) {
    if (std::binary_search(chain.base.held.begin(), chain.base.held.end(), i)) continue;
    if (chain.model->parameters[i].kind == ParameterKind::kTorqueBias) continue;
    columns.push_back(i);
  }
  return columns;
}

bool Asked(const std::string& joint, const std::vector<std::string>& joints) {
  return joints.empty() || std::find(joints.begin(), joints.end(), joint) != joints.end();
}

PriorKnowledge KnowledgeOf(const DesignedChain& chain, const std::vector<int>& columns,
                           const Known& known, const Project& project,
                           const FollowUpOptions& options) {
  const ErrorModel& model = *chain.model;
  const Prior& prior = project.calibration.prior;
  PriorKnowledge knowledge;
  knowledge.marker_sd = options.marker_sd;
  Eigen::VectorXd sd(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    sd[static_cast<Eigen::Index>(i)] = prior.Of(model.tree, model.parameters[columns[i]]);
  }
  knowledge.covariance = sd.cwiseAbs2().asDiagonal();
  std::vector<LinkMarkers> links =
      FindCommonMarkers(known.estimate.markers, PlacesOfMarkers(model));
  for (LinkMarkers& link : links) link.same = true;
  const EarlierEstimate earlier =
      MakeEarlierEstimate(known.estimate, model, project.calibration, options.days, links);
  const EarlierPart part = PartOf(earlier, model, columns);
  knowledge.covariance(part.positions, part.positions) = part.covariance;
  const Eigen::VectorXd sizes = SizeOfChanges(earlier, model, prior);
  knowledge.change_sd = Eigen::VectorXd::Zero(sd.size());
  for (std::size_t n = 0; n < earlier.names.size(); ++n) {
    const auto at = std::find_if(columns.begin(), columns.end(), [&](int i) {
      return model.parameters[i].name == earlier.names[n];
    });
    if (at == columns.end()) continue;
    const Parameter& parameter = model.parameters[*at];
    if (parameter.joint < 0 || !IsZeroOffset(parameter, model.tree)) continue;
    if (!Asked(model.tree.joints[parameter.joint].name, options.joints)) continue;
    knowledge.change_sd[at - columns.begin()] = sizes[static_cast<Eigen::Index>(n)];
  }
  return knowledge;
}

FollowUpChain DesignOne(const Project& project, const ChainSetup& setup, const Known& known,
                        const FollowUpOptions& options, std::string& infeasible) {
  const DesignedChain chain = PrepareChain(project, setup, true, true);
  CheckApplies(known.stored, project, *chain.model);
  const std::vector<int> columns = Columns(chain);
  const PriorKnowledge knowledge = KnowledgeOf(chain, columns, known, project, options);
  FollowUpChain result{.postures = {setup.name, setup.support, {}}, .zeros = {}};
  const bool nothing = options.aim == SequentialAim::kChanges && knowledge.change_sd.isZero(0.0);
  if (nothing) return result;
  PostureProblem problem = MakeChainProblem(*chain.model, columns, project.motion, setup);
  const DesignResult design = SequentialDesign(problem, knowledge, options.seed,
                                               {.postures = options.postures, .aim = options.aim});
  if (design.set.size() == 0) {
    infeasible = "chain '" + setup.name +
                 "': no feasible posture was found; what stands in the way most often is the " +
                 design.blame;
    return result;
  }
  for (const Eigen::VectorXd& x : design.set.postures()) {
    result.postures.q.push_back(problem.feasible.chain.FullPosture(x));
  }
  result.information = design.indices.back();
  const double variance = options.marker_sd * options.marker_sd;
  const Eigen::VectorXd sd = ChangeDeviations(knowledge, design.set.information() / variance);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (knowledge.change_sd[at] <= 0.0) continue;
    const Joint& joint = chain.model->tree.joints[chain.model->parameters[columns[i]].joint];
    const bool told = sd[at] <= knowledge.change_sd[at];
    result.zeros.push_back(
        {joint.name, joint.type == JointType::kPrismatic,
         told ? sd[at] : std::numeric_limits<double>::infinity(),
         SmallestChange(sd[at], knowledge.change_sd[at], chain.model->tree.joints.size())});
  }
  return result;
}

std::vector<ChainSetup> Chosen(const Project& project, const FollowUpOptions& options) {
  ChosenSetups(project, {});  // throws for a project without chain set-ups
  std::vector<ChainSetup> setups = SetupsOfBothSides(project);
  std::vector<std::string> names, joints;
  for (const ChainSetup& setup : setups) names.push_back(setup.name);
  for (const Joint& joint : project.tree.joints) joints.push_back(joint.name);
  const auto expect = [&](const std::string& name, const std::vector<std::string>& all,
                          const std::string& what) {
    if (std::find(all.begin(), all.end(), name) != all.end()) return;
    throw InputError(project.file.string() + ": " + what + " '" + name + "'" +
                     DidYouMean(name, all));
  };
  for (const std::string& name : options.chains) {
    expect(name, names, "the section 'design' has no chain");
  }
  for (const std::string& name : options.joints) expect(name, joints, "the robot has no joint");
  if (options.chains.empty()) return setups;
  std::erase_if(setups, [&](const ChainSetup& setup) {
    return std::find(options.chains.begin(), options.chains.end(), setup.name) ==
           options.chains.end();
  });
  return setups;
}

nlohmann::ordered_json FiniteJson(double number) {
  return std::isfinite(number) ? nlohmann::ordered_json(number) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::vector<ChainPostures> FollowUpDesign::postures() const {
  std::vector<ChainPostures> postures;
  for (const FollowUpChain& chain : chains) postures.push_back(chain.postures);
  return postures;
}

FollowUpDesign DesignFollowUp(const Project& project, const std::filesystem::path& calibration,
                              const FollowUpOptions& options, const Progress& progress) {
  const CalibrationFiles files = FindCalibrationFiles(calibration);
  const Known known{ReadCalibration(files.calibration), ReadCalibrationFiles(files)};
  const std::vector<ChainSetup> setups = Chosen(project, options);
  FollowUpDesign design;
  int done = 0;
  for (const ChainSetup& setup : setups) {
    if (progress) progress(done++, static_cast<int>(setups.size()));
    FollowUpChain chain = DesignOne(project, setup, known, options, design.infeasible);
    if (!design.infeasible.empty()) return design;
    if (!chain.postures.q.empty()) design.chains.push_back(std::move(chain));
  }
  if (design.chains.empty()) {
    design.infeasible = "no chain moves a joint whose change could be told";
  }
  return design;
}

nlohmann::ordered_json ZerosJson(const std::vector<ZeroSensitivity>& zeros) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ZeroSensitivity& zero : zeros) {
    json.push_back({{"joint", zero.joint},
                    {"unit", zero.prismatic ? "m" : "rad"},
                    {"sd", FiniteJson(zero.sd)},
                    {"smallest_seen", FiniteJson(zero.smallest_seen)}});
  }
  return json;
}

std::string MakeFollowUpJson(const FollowUpDesign& design, const FollowUpOptions& options) {
  nlohmann::ordered_json json;
  json["aim"] = options.aim == SequentialAim::kChanges ? "changes" : "parameters";
  json["seed"] = options.seed;
  json["chains"] = nlohmann::ordered_json::array();
  for (const FollowUpChain& chain : design.chains) {
    nlohmann::ordered_json one;
    one["chain"] = chain.postures.chain;
    one["postures"] = chain.postures.q.size();
    one["information_nats"] = chain.information;
    one["zeros"] = ZerosJson(chain.zeros);
    json["chains"].push_back(std::move(one));
  }
  return JsonText(json);
}

}  // namespace elastocal
