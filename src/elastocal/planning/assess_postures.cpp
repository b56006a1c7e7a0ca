// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/assess_postures.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/planning/chain_setups.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

/// The set-up of a chain or of its mirror image.
ChainSetup SetupOf(const Project& project, const std::string& chain) {
  for (const ChainSetup& setup : SetupsOfBothSides(project)) {
    if (setup.name == chain) return setup;
  }
  throw InputError(project.file.string() + ": section 'design' says nothing of chain '" + chain +
                   "'");
}

/// Whether a posture of a recording exercises the chain: it is of a trial with a chain that has the
/// same end, or of a posture table.
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

ChainAssessment AssessChain(const Project& project, const ChainPostures& set,
                            const PostureAssessmentOptions& options) {
  const DesignedChain chain = PrepareChain(project, SetupOf(project, set.chain), options.elastic);
  PostureProblem problem =
      MakeChainProblem(*chain.model, chain.base.kept, project.motion, chain.setup);
  PostureSet postures(problem.column_count());
  for (const Eigen::VectorXd& q : set.q) postures.Add(problem, q(chain.setup.coordinates));
  ChainAssessment result;
  result.setup = chain.setup;
  for (int i : chain.base.kept) result.parameters.push_back(chain.model->parameters[i]);
  result.posture_count = postures.size();
  result.assessment = AssessPostures(problem, postures, options.assess);
  return result;
}

Json AssessedJson(const ChainAssessment& chain, int weakest) {
  const Assessment& a = chain.assessment;
  Json weak = Json::object();
  for (int i : chain.WeakestParameters(weakest)) {
    const double sd = a.parameter_sd[i];
    weak[chain.parameters[i].name] = std::isfinite(sd) ? Json(sd) : Json(nullptr);
  }
  Json broken = Json::array();
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    if (a.violations[i].amount <= kFeasible) continue;
    broken.push_back(
        {{"posture", i + 1}, {"what", a.violations[i].what}, {"amount", a.violations[i].amount}});
  }
  return {{"chain", chain.setup.name},
          {"postures", chain.posture_count},
          {"parameters", chain.parameters.size()},
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

}  // namespace

std::vector<int> ChainAssessment::WeakestParameters(int count) const {
  std::vector<int> order;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!IsExternal(parameters[i].kind)) order.push_back(static_cast<int>(i));
  }
  const Eigen::VectorXd& sd = assessment.parameter_sd;
  std::sort(order.begin(), order.end(), [&](int a, int b) { return sd[a] > sd[b]; });
  order.resize(std::min<std::size_t>(order.size(), static_cast<std::size_t>(count)));
  return order;
}

std::vector<ChainAssessment> AssessPostures(const Project& project,
                                            const std::vector<ChainPostures>& sets,
                                            const PostureAssessmentOptions& options,
                                            const Progress& progress) {
  ChosenSetups(project, {});  // throws where there is no section `design`
  for (const std::string& name : options.chains) FindChain(project, name);
  std::vector<const ChainPostures*> chosen;
  for (const ChainPostures& set : sets) {
    const auto& names = options.chains;
    if (names.empty() || std::find(names.begin(), names.end(), set.chain) != names.end()) {
      chosen.push_back(&set);
    }
  }
  if (chosen.empty()) throw InputError("there are no postures of the chains asked for");
  const int total = static_cast<int>(chosen.size());
  std::vector<ChainAssessment> chains;
  for (const ChainPostures* set : chosen) {
    if (progress) progress(static_cast<int>(chains.size()), total);
    chains.push_back(AssessChain(project, *set, options));
  }
  if (progress) progress(total, total);
  return chains;
}

std::vector<ChainPostures> RecordedPostures(const Project& project, const Recording& recording) {
  std::vector<ChainPostures> sets;
  for (const ChainSetup& setup : SetupsOfBothSides(project)) {
    ChainPostures set{setup.name, setup.support, {}};
    for (Eigen::Index i = 0; i < recording.q.rows(); ++i) {
      if (Exercises(recording, i, project, setup)) {
        set.q.emplace_back(recording.q.row(i).transpose());
      }
    }
    if (!set.q.empty()) sets.push_back(std::move(set));
  }
  return sets;
}

std::string FormatAssessment(const std::vector<ChainAssessment>& chains, int weakest) {
  Json list = Json::array();
  for (const ChainAssessment& chain : chains) list.push_back(AssessedJson(chain, weakest));
  return JsonText(Json{{"chains", list}});
}

}  // namespace elastocal
