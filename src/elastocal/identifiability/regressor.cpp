// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/regressor.hpp"

#include <algorithm>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/robot/jacobian.hpp"

namespace elastocal {
Eigen::MatrixXd RegressorFactor(const ErrorModel& model, const Geometry& geometry,
                                const Eigen::MatrixXd& q,
                                const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& seen) {
  GeneralizedJacobian jacobian(model);
  const int marker_count = model.marker_count();
  std::vector<Eigen::MatrixXd> rows(marker_count);
  std::vector<Eigen::Index> filled(marker_count, 0);
  for (int m = 0; m < marker_count; ++m) {
    rows[m].resize(3 * q.rows(), static_cast<Eigen::Index>(jacobian.Columns(m).size()));
  }
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    jacobian.Evaluate(geometry, q.row(i).transpose());
    for (int m = 0; m < marker_count; ++m) {
      if (seen.size() > 0 && !seen(i, m)) continue;
      rows[m].middleRows<3>(filled[m]) = jacobian.Block(m);
      filled[m] += 3;
    }
  }

  std::vector<Eigen::MatrixXd> factors(marker_count);
  Eigen::Index height = 0;
  for (int m = 0; m < marker_count; ++m) {
    factors[m] = TriangularFactor(rows[m].topRows(filled[m]));
    height += factors[m].rows();
  }
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(height, model.parameter_count());
  Eigen::Index at = 0;
  for (int m = 0; m < marker_count; ++m) {
    stacked(Eigen::seqN(at, factors[m].rows()), jacobian.Columns(m)) = factors[m];
    at += factors[m].rows();
  }
  return TriangularFactor(stacked);
}

}  // namespace elastocal
