// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/validation/metrics.hpp"

namespace elastocal {

/// Distances of the markers of one trial to their predictions by each model, for one group of
/// chains ("left leg", "HAT" for head, arms and trunk). A trial that exercises several groups has
/// one entry for each.
struct TrialResiduals {
  std::string trial;  ///< name of the trial
  TrialKind kind = TrialKind::kSine;
  std::string group;
  std::vector<int> markers;  ///< markers of the group, by column of `distances`
  /// postures x markers, m; NaN where a marker was not seen or could not be predicted.
  std::map<ModelKind, Eigen::MatrixXd> distances;
};

/// Error metrics of one trial and one group, by model.
struct TrialErrors {
  std::string trial;
  TrialKind kind = TrialKind::kSine;
  std::string group;
  std::vector<int> markers;  ///< for each entry of `marker_rmse_3d` of the metrics
  std::map<ModelKind, ErrorMetrics> metrics;
};

/// Errors of every model, over the observations that all models predict, so that all are judged on
/// the same data. Throws std::invalid_argument if matrices have different sizes or lack a marker.
TrialErrors ComputeTrialErrors(const TrialResiduals& residuals);

/// Errors over all observations of the trials of one kind of motion and one group.
struct ErrorTableRow {
  std::string group;
  TrialKind kind = TrialKind::kSine;
  int trials = 0;
  /// Metrics of the models that all these trials have; without `marker_rmse_3d`.
  std::map<ModelKind, ErrorMetrics> metrics;
};

/// Errors on held-out motions: Table 2 of the paper.
struct ErrorTable {
  std::vector<TrialErrors> trials;
  /// Ordered by group (as they first occur), and then by kind: sinusoidal motions, random postures,
  /// repetitions.
  std::vector<ErrorTableRow> rows;
  std::vector<ErrorTableRow> groups;  ///< over all kinds of motion; their `kind` has no meaning
  /// Mean of the rows' 3-D RMSE, m, for the models that all rows have. As in the paper's section
  /// 6.1.4, each row counts once, whatever the length of its trials. Rows without observations do
  /// not count.
  std::map<ModelKind, double> mean_rmse_3d;
};

ErrorTable MakeErrorTable(std::vector<TrialErrors> trials);

}  // namespace elastocal
