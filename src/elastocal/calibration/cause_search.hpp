// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/linear_study.hpp"

namespace elastocal {

/// What the data say about one cause, which is a set of corrections.
struct CauseFinding {
  std::string cause;
  std::vector<int> parameters;   ///< indices of the corrections in the wide model
  std::vector<double> estimate;  ///< SI units, one a parameter
  std::vector<double> sd;
  /// F value of the score test; divided by the scatter of the postures where that exceeds the
  /// noise.
  double score = 0.0;
  double p = 1.0;           ///< p-value of this cause alone
  double p_adjusted = 1.0;  ///< p-value corrected for the number of causes (Holm)
  /// `gain`: by how much the held-out error (root mean square over observations) falls with this
  /// cause, m. `mean_gain`: mean over the postures of the fall of each posture's error; `gain_sd`:
  /// its standard error, m.
  double gain = 0.0, mean_gain = 0.0, gain_sd = 0.0;
  /// `visible_effect`: the size of the first parameter, SI, at which the cause would have been
  /// found nine times in ten. `visible`: root mean square of the displacement of markers by it, m,
  /// less what other parameters explain.
  double visible = 0.0, visible_effect = 0.0;
  /// For a cause that was taken: other significant causes that explain the residuals almost as well
  /// (likelihoods within a factor of 20).
  std::vector<std::string> rivals = {};
};

/// Settings of SearchCauses.
struct CauseSearchOptions {
  int folds = 10;
  /// Number of random divisions into folds; held-out errors are averaged over them.
  int deals = 3;
  double level = 0.05;
  int most = 5;  ///< largest number of causes that are taken
  std::uint64_t seed = 1;
};

/// Result of SearchCauses. Errors are those of held-out postures, m; the error of a posture is the
/// root mean square over its markers.
struct CauseSearch {
  /// All causes, each tested beside the calibration alone, by ascending p-value.
  std::vector<CauseFinding> findings;
  std::vector<CauseFinding> chosen;  ///< causes that were taken, in that order
  /// Root mean square held-out error without any cause: where some were chosen, over the divisions
  /// of `nested_error`, else over those of the findings.
  double error = 0.0;
  /// Error and gain of the whole search by nested folds: in each fold the causes are chosen without
  /// the postures on which they are judged. In tables of up to 60 postures, these are means over
  /// ten divisions into folds; over fewer in larger ones. The standard error of the gain allows for
  /// training postures that folds have in common.
  double nested_error = 0.0, nested_gain = 0.0, nested_gain_sd = 0.0;
  /// Whether the 95 % interval of the nested gain is above zero or, if not, the gain is larger than
  /// 5 % of the error and than the standard error by the scatter of the postures alone.
  bool accepted = false;
};

/// Selects causes by forward search. In each round every cause of the study is tested, and the one
/// with the smallest p-value is taken, if it is significant over all causes and its gain on
/// held-out postures meets the rule of `accepted`. The error of the whole search is found by
/// repeating it in each fold. Fewer than three postures give an empty result.
CauseSearch SearchCauses(const LinearStudy& study, const CauseSearchOptions& options = {});

}  // namespace elastocal
