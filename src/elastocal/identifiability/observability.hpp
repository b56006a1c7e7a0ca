// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/parameters.hpp"

namespace elastocal {

/// Observability indices of a set of postures from the singular values sigma_1 >= ... >= sigma_Nb
/// of its regressor's identifiable columns. O1 is the paper's eq. 12. The others are numbered as in
/// Sun and Hollerbach (2008), without division by the number of postures.
struct ObservabilityIndices {
  double o1 = 0.0;  ///< (sigma_1 ... sigma_Nb)^(1/Nb) / sqrt(postures)
  double o2 = 0.0;  ///< sigma_Nb / sigma_1
  double o3 = 0.0;  ///< sigma_Nb
  double o4 = 0.0;  ///< sigma_Nb^2 / sigma_1
  double o5 = 0.0;  ///< 1 / (1 / sigma_1 + ... + 1 / sigma_Nb)
};

/// The indices from singular values in any order, none negative. If one is zero (rank lost), all
/// indices are zero.
ObservabilityIndices ComputeObservability(const Eigen::VectorXd& singular_values, int postures);

/// How well a recording excites the parameters. Condition numbers are of columns of unit norm: they
/// say how nearly dependent the columns are, whatever their units.
struct Excitation {
  double condition_all = 0.0;    ///< of all columns; infinite if they are dependent
  double condition_base = 0.0;   ///< of the identifiable columns
  ObservabilityIndices indices;  ///< of the identifiable columns, not scaled (m/rad, m/m)
  std::vector<int> parameters;   ///< parameters of the identifiable columns
  /// For each of `parameters` the standard deviation that it would have from this recording
  /// alone if one marker coordinate had `marker_sd`: rad or m; infinite if it is not excited.
  Eigen::VectorXd parameter_sd;
};

/// Identifiable parameters whose standard deviation from this recording alone is more than one
/// degree (parameters in rad) or 5e-3 in SI units (all others; 5 mm for lengths).
std::vector<int> HardlyExcited(const std::vector<Parameter>& parameters,
                               const Excitation& excitation);

/// Computes the excitation by a recording. `factor` is what RegressorFactor returns, or another
/// matrix R with columns for the parameters and R^T R = Psi^T Psi. `base` lists the identifiable
/// columns, and `postures` is the number of postures.
Excitation AssessExcitation(const Eigen::MatrixXd& factor, const std::vector<int>& base,
                            int postures, double marker_sd);

}  // namespace elastocal
