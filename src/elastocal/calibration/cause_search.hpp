// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/linear_study.hpp"

namespace elastocal {

/// What the data say about one cause, as a set of corrections.
struct CauseFinding {
  std::string cause;
  std::vector<int> parameters;   ///< of the wide model
  std::vector<double> estimate;  ///< SI
  std::vector<double> sd;
  double score = 0.0;       ///< F of the score test, by the scatter of the postures where larger
  double p = 1.0;           ///< of one cause by itself
  double p_adjusted = 1.0;  ///< Holm, over all causes
  /// By how much the held-out error (root mean square over observations) falls with it, m; the
  /// mean over postures of what each gains, and the standard error of that.
  double gain = 0.0, mean_gain = 0.0, gain_sd = 0.0;
  /// Root mean square of the displacement of markers by an effect that would have been found nine
  /// times in ten, as far as nothing else explains it, m; and that effect, SI (of one parameter).
  double visible = 0.0, visible_effect = 0.0;
  /// If this cause was taken: those that would have explained almost as much in its place.
  std::vector<std::string> rivals = {};
};

struct CauseSearchOptions {
  int folds = 10;
  int deals = 3;  ///< of the postures to folds, over which held-out errors are averaged
  double level = 0.05;
  int most = 5;  ///< causes
  std::uint64_t seed = 1;
};

/// Errors of held-out postures, m: root mean square over the markers of each.
struct CauseSearch {
  std::vector<CauseFinding> findings;  ///< all causes, beside the calibration alone; best first
  std::vector<CauseFinding> chosen;    ///< in the order in which they were taken
  double error = 0.0;                  ///< held-out, root mean square, without any of them
  /// The same of the whole search: what it would have chosen without the postures that it is judged
  /// on (nested folds), and its gain.
  double nested_error = 0.0, nested_gain = 0.0, nested_gain_sd = 0.0;
  /// Whether the 95 % interval of the nested gain is above zero or, if not, the gain is larger than
  /// its standard error and than 5 % of the error.
  bool accepted = false;
};

/// Tests every cause of the study and takes the best ones, forward, one by one: only such as are
/// significant over all causes and whose gain on held-out postures is worth it, as `accepted` has
/// it. The error of the search as a whole is found by repeating it in each fold.
CauseSearch SearchCauses(const LinearStudy& study, const CauseSearchOptions& options = {});

}  // namespace elastocal
