// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/error_table.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr auto kNone = ModelKind::kUncalibrated;
constexpr auto kGeometric = ModelKind::kGeometric;

TrialResiduals Residuals(const std::string& group, TrialKind kind, const Eigen::MatrixXd& none,
                         const Eigen::MatrixXd& geometric) {
  TrialResiduals residuals{
      .trial = group, .kind = kind, .group = group, .markers = {}, .distances = {}};
  for (int m = 0; m < none.cols(); ++m) residuals.markers.push_back(m);
  residuals.distances = {{kNone, none}, {kGeometric, geometric}};
  return residuals;
}

TrialErrors Errors(const std::string& group, TrialKind kind, double none, double geometric,
                   int count = 1) {
  return ComputeTrialErrors(Residuals(group, kind, Eigen::MatrixXd::Constant(count, 1, none),
                                      Eigen::MatrixXd::Constant(count, 1, geometric)));
}

TEST(TrialErrors, OverMarkersOfTheGroupThatAllModelsPredict) {
  Eigen::MatrixXd none(2, 3), geometric(2, 3);
  none << 3, 9, 4, 3, 9, kNaN;
  geometric << 1, 9, 2, kNaN, 9, 2;
  TrialResiduals residuals = Residuals("leg", TrialKind::kSine, none, geometric);
  residuals.markers = {2, 0};
  const TrialErrors errors = ComputeTrialErrors(residuals);
  EXPECT_EQ(errors.metrics.at(kNone).observations, 2);  // those of the first posture
  EXPECT_DOUBLE_EQ(errors.metrics.at(kNone).rmse_3d, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(errors.metrics.at(kNone).maximum, 4.0);
  EXPECT_DOUBLE_EQ(errors.metrics.at(kGeometric).rmse_3d, std::sqrt(2.5));
  EXPECT_DOUBLE_EQ(errors.metrics.at(kGeometric).marker_rmse_3d[0], 2.0);
  residuals.markers = {3};
  EXPECT_THROW(ComputeTrialErrors(residuals), std::invalid_argument);
  residuals.markers = {0};
  residuals.distances[kGeometric].resize(1, 3);
  EXPECT_THROW(ComputeTrialErrors(residuals), std::invalid_argument);
}

TEST(ErrorTable, RowsByGroupThenKindWithTrialsPooled) {
  const ErrorTable table = MakeErrorTable(
      {Errors("leg", TrialKind::kRepeatability, 2, 1), Errors("HAT", TrialKind::kRandom, 3, 1),
       Errors("leg", TrialKind::kSine, 4, 2, 3), Errors("leg", TrialKind::kSine, 8, 3, 1)});
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0].group, "leg");
  EXPECT_EQ(table.rows[0].kind, TrialKind::kSine);
  EXPECT_EQ(table.rows[0].trials, 2);
  EXPECT_EQ(table.rows[1].kind, TrialKind::kRepeatability);
  EXPECT_EQ(table.rows[2].group, "HAT");
  const ErrorMetrics& sine = table.rows[0].metrics.at(kNone);
  EXPECT_EQ(sine.observations, 4);
  EXPECT_DOUBLE_EQ(sine.rmse_3d, std::sqrt((3 * 16.0 + 64.0) / 4.0));
  EXPECT_DOUBLE_EQ(sine.rmse_coordinate, sine.rmse_3d / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(sine.maximum, 8.0);
  ASSERT_EQ(table.groups.size(), 2u);
  EXPECT_EQ(table.groups[0].metrics.at(kNone).observations, 5);
  EXPECT_DOUBLE_EQ(table.groups[0].metrics.at(kNone).rmse_3d, std::sqrt((3 * 16 + 64 + 4) / 5.0));
  EXPECT_DOUBLE_EQ(table.mean_rmse_3d.at(kNone), (std::sqrt(28.0) + 2.0 + 3.0) / 3.0);
}

// The mean of the paper's rows for its full model must be the figure in its text, 2.2 mm.
TEST(ErrorTable, AveragesAsThePaperDoes) {
  std::vector<TrialErrors> trials;
  const double full[] = {2.9, 1.9, 1.9, 2.4, 1.9, 2.5, 1.8, 2.2};
  const char* group[] = {"HAT", "HAT", "HAT", "left", "left", "right", "right", "right"};
  const TrialKind kind[] = {TrialKind::kSine,   TrialKind::kRandom,       TrialKind::kRepeatability,
                            TrialKind::kSine,   TrialKind::kRandom,       TrialKind::kSine,
                            TrialKind::kRandom, TrialKind::kRepeatability};
  for (int i = 0; i < 8; ++i) trials.push_back(Errors(group[i], kind[i], 9.0, full[i], 1 + i));
  const ErrorTable table = MakeErrorTable(trials);
  EXPECT_EQ(table.rows.size(), 8u);
  EXPECT_NEAR(table.mean_rmse_3d.at(kGeometric), 2.2, 0.05);
}

TEST(ErrorTable, ModelsThatATrialDoesNotHaveAndTrialsWithoutObservations) {
  TrialErrors without = Errors("leg", TrialKind::kSine, 1, 1);
  without.metrics.erase(kGeometric);
  const ErrorTable table = MakeErrorTable({Errors("leg", TrialKind::kSine, 1, 1), without,
                                           Errors("arm", TrialKind::kSine, kNaN, 1),
                                           Errors("HAT", TrialKind::kSine, 3, 1)});
  EXPECT_FALSE(table.rows[0].metrics.contains(kGeometric));
  EXPECT_EQ(table.rows[0].metrics.at(kNone).observations, 2);
  EXPECT_TRUE(std::isnan(table.rows[1].metrics.at(kNone).rmse_3d));
  EXPECT_EQ(table.mean_rmse_3d.size(), 1u);
  EXPECT_DOUBLE_EQ(table.mean_rmse_3d.at(kNone), 2.0);
  EXPECT_TRUE(MakeErrorTable({}).mean_rmse_3d.empty());
  // A trial in which nothing was seen changes nothing.
  const ErrorTable beside = MakeErrorTable(
      {Errors("leg", TrialKind::kSine, kNaN, 1), Errors("leg", TrialKind::kSine, 3, 1)});
  EXPECT_DOUBLE_EQ(beside.rows[0].metrics.at(kNone).rmse_3d, 3.0);
}

}  // namespace
}  // namespace elastocal
