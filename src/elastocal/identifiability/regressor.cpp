// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/regressor.hpp"

#include <algorithm>

#include "elastocal/identifiability/root_projection.hpp"
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

Eigen::MatrixXd FreeRootFactor(const ErrorModel& model, const Geometry& geometry,
                               const Eigen::MatrixXd& q) {
  constexpr Eigen::Index kPosturesAtOnce = 20;
  GeneralizedJacobian jacobian(model);
  const Eigen::Index size = 3 * model.marker_count();
  Eigen::MatrixXd factor(0, model.parameter_count());
  for (Eigen::Index first = 0; first < q.rows(); first += kPosturesAtOnce) {
    const Eigen::Index count = std::min(kPosturesAtOnce, q.rows() - first);
    Eigen::MatrixXd rows(factor.rows() + count * size, factor.cols());
    rows.topRows(factor.rows()) = factor;
    for (Eigen::Index i = 0; i < count; ++i) {
      jacobian.Evaluate(geometry, q.row(first + i).transpose());
      const Eigen::MatrixXd own = jacobian.Dense();
      rows.middleRows(factor.rows() + i * size, size) =
          RootProjection(own.leftCols<kWaistParameterCount>()).Apply(own);
    }
    factor = TriangularFactor(rows);
  }
  factor.leftCols<kWaistParameterCount>().setZero();
  return factor;
}

}  // namespace elastocal
