#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// How far the markers of one trial are from where each model says, for one group of chains ("left
/// leg", "HAT" for head, arms and trunk). A trial that exercises several groups gives several.
struct TrialResiduals {
  std::string trial;  ///< its name
  TrialKind kind = TrialKind::kSine;
  std::string group;
  std::vector<int> markers;  ///< of the group: columns of `distances`
  /// postures x markers, m; NaN where a marker was not seen or could not be predicted.
  std::map<ModelKind, Eigen::MatrixXd> distances;
};

struct TrialErrors {
  std::string trial;
  TrialKind kind = TrialKind::kSine;
  std::string group;
  std::vector<int> markers;  ///< as `marker_rmse_3d` of the metrics
  std::map<ModelKind, ErrorMetrics> metrics;
};

/// Errors of every model over the observations that all of them predict, so that they are judged on
/// the same data. Throws std::invalid_argument for matrices of different sizes or markers beyond
/// them.
TrialErrors ComputeTrialErrors(const TrialResiduals& residuals);

/// Trials of one kind of motion and one group, all observations together.
struct ErrorTableRow {
  std::string group;
  TrialKind kind = TrialKind::kSine;
  int trials = 0;
  /// Of the models that all these trials have; without `marker_rmse_3d`.
  std::map<ModelKind, ErrorMetrics> metrics;
};

/// Cross-validation on motions that took no part in the estimate: Table 2 of the paper.
struct ErrorTable {
  std::vector<TrialErrors> trials;
  /// By group, in the order in which they are met, then sinusoidal motions, random postures and
  /// repetitions.
  std::vector<ErrorTableRow> rows;
  std::vector<ErrorTableRow> groups;  ///< over all kinds; their `kind` means nothing
  /// Mean over the rows of the 3-D RMSE, m, as the paper averages in section 6.1.4 (a row counts
  /// once, however long its trials); of the models that all rows have. Rows without observations
  /// do not count.
  std::map<ModelKind, double> mean_rmse_3d;
};

ErrorTable MakeErrorTable(std::vector<TrialErrors> trials);

}  // namespace elastocal
