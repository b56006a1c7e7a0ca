#include "elastocal/pipeline/coverage.hpp"

#include <algorithm>

#include "elastocal/calibration/observations.hpp"

namespace elastocal {
namespace {

/// Markers of a recording that are seen in postures of trials of the chain; of a table, anywhere.
bool Shows(const Recording& recording, const std::string& chain,
           const std::vector<std::string>& markers) {
  const ObservationMask seen = SeenMask(recording);
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (std::find(markers.begin(), markers.end(), recording.marker_names[m]) == markers.end()) {
      continue;
    }
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!seen(i, m)) continue;
      if (recording.trials.empty()) return true;
      const std::vector<std::string>& chains = recording.trials[recording.trial[i]].chains;
      if (std::find(chains.begin(), chains.end(), chain) != chains.end()) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<ChainCoverage> FindCoverage(const Project& project, const Measurements& measured) {
  std::vector<ChainCoverage> coverage;
  for (const Chain& chain : project.chains) {
    std::vector<std::string> markers;
    for (const std::string& name : ChainMarkers(project, chain)) {
      const auto marker =
          std::find_if(project.markers.begin(), project.markers.end(),
                       [&](const Marker& candidate) { return candidate.name == name; });
      if (project.tree.links[marker->link].body > 0) markers.push_back(name);
    }
    if (markers.empty()) continue;
    ChainCoverage of{chain.name,
                     Shows(measured.calibration, chain.name, markers),
                     Shows(measured.validation, chain.name, markers),
                     {}};
    for (const TrialSummary& trial : measured.trials) {
      const auto& chains = trial.trial.chains;
      if (trial.refused.empty() || trial.trial.kind != TrialKind::kCalibration ||
          std::find(chains.begin(), chains.end(), chain.name) == chains.end()) {
        continue;
      }
      of.refused.push_back("trial " + trial.trial.name + ": " + trial.refused);
    }
    coverage.push_back(std::move(of));
  }
  return coverage;
}

void JudgeCoverage(const std::vector<ChainCoverage>& coverage, Verdict& verdict) {
  const bool any_judged = std::any_of(coverage.begin(), coverage.end(),
                                      [](const ChainCoverage& of) { return of.judged; });
  std::vector<std::string> objections;
  for (const ChainCoverage& of : coverage) {
    if (!of.calibrated && !of.refused.empty()) {
      std::string reasons;
      for (const std::string& reason : of.refused)
        reasons += (reasons.empty() ? "" : "; ") + reason;
      objections.push_back("chain " + of.chain + " is not calibrated (" + reasons +
                           "): record it again or, to deploy the others, take its trials out of "
                           "experiment.yaml");
    }
    if (of.calibrated && !of.judged && any_judged) {
      verdict.remarks.push_back("chain " + of.chain +
                                " was calibrated, but no trial for validation shows it: it is not "
                                "judged on held-out data");
    }
  }
  // First: what was not measured matters more than how well the rest fits.
  verdict.objections.insert(verdict.objections.begin(), objections.begin(), objections.end());
}

}  // namespace elastocal
