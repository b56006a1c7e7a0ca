// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Two markers of one cluster whose labels are exchanged in all trials of the estimate that show
/// them, or in held-out postures.
struct LabelExchange {
  int a = -1, b = -1;
  /// held-out postures that are nearer to the model with the labels exchanged back
  std::vector<int> postures;
  double before = 0.0;  ///< rms over all held-out distances, m
  double after = 0.0;   ///< the same with the labels exchanged back
  /// The labels are wrong in the estimate's trials, not in the held-out postures.
  bool of_estimate = false;
};

/// Finds an exchange that explains most of the error on held-out trials. The trials of the estimate
/// (`recording`) and the held-out ones each fit by themselves, and where the distances to the other
/// markers of the cluster are similar, only the robot shows it.
std::optional<LabelExchange> ExchangeWithinCluster(const Project& project,
                                                   const Recording& recording,
                                                   const Recording& held_out,
                                                   const ModelComparison& comparison);

/// Text "the labels of A and B seem exchanged in trial arm: exchanged back, held-out trials are 0.2
/// mm off the model, as they are 12 mm".
std::string DescribeExchange(const LabelExchange& exchange, const Recording& recording,
                             const Recording& held_out);

}  // namespace elastocal
