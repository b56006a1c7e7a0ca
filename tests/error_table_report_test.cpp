// SPDX-License-Identifier: Apache-2.0
// The table of cross-validation errors as text. This test compiles the program's sources without
// its main.

#include "elastocal/cli/error_table_report.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/report/error_table_json.hpp"

namespace elastocal::cli {
namespace {

ErrorTable SmallTable() {
  std::vector<TrialErrors> trials;
  const auto add = [&](const char* group, TrialKind kind, double none, double geometric) {
    trials.push_back(ComputeTrialErrors(
        {.trial = std::string(group) + " trial",
         .kind = kind,
         .group = group,
         .markers = {0},
         .distances = {{ModelKind::kUncalibrated, Eigen::MatrixXd::Constant(2, 1, none)},
                       {ModelKind::kFull, Eigen::MatrixXd::Constant(2, 1, geometric)}}}));
  };
  add("HAT", TrialKind::kSine, 6.6e-3, 2.9e-3);
  add("HAT", TrialKind::kRandom, 6.6e-3, 1.9e-3);
  add("left leg", TrialKind::kRepeatability, 8.4e-3, 3.8e-3);
  add("right leg", TrialKind::kSine, std::numeric_limits<double>::quiet_NaN(), 1.0);
  return MakeErrorTable(trials);
}

TEST(ErrorTableReport, HasThePapersRowsAndColumns) {
  const std::string text = DescribeErrorTable(SmallTable());
  const std::string expected =
      "  chain              case  trials  FCM RMSE mm  NCM RMSE mm  FCM max mm  NCM max mm  "
      "sightings\n";
  EXPECT_EQ(text.substr(0, expected.size()), expected);
  for (const char* row :
       {"  HAT                  SW       1         2.90         6.60        2.90        6.60       "
        "   2\n",
        "  right leg            SW       1            -            -           -           -       "
        "   0\n",
        "  HAT                 all       2         2.45         6.60        2.90        6.60       "
        "   4\n",
        "  mean of the cases                       2.87         7.20\n"}) {
    EXPECT_NE(text.find(row), std::string::npos) << row << "not in\n" << text;
  }
  EXPECT_LT(text.find(" SW "), text.find(" RP "));
}

TEST(ErrorTableReport, Json) {
  const nlohmann::json json = nlohmann::json::parse(MakeErrorTableJson(SmallTable()).dump());
  ASSERT_EQ(json["rows"].size(), 4u);
  EXPECT_EQ(json["rows"][1]["chain"], "HAT");
  EXPECT_EQ(json["rows"][1]["case"], "RP");
  EXPECT_EQ(json["rows"][1]["observations"], 2);
  EXPECT_DOUBLE_EQ(json["rows"][1]["rmse_3d_mm"]["full"], 1.9);
  EXPECT_DOUBLE_EQ(json["rows"][2]["max_mm"]["uncalibrated"], 8.4);
  EXPECT_TRUE(json["rows"][3]["rmse_3d_mm"]["full"].is_null());
  EXPECT_TRUE(json["rows"][3]["max_mm"]["full"].is_null());
  EXPECT_EQ(json["chains"].size(), 3u);
  EXPECT_EQ(json["trials"][2]["trial"], "left leg trial");
  EXPECT_NEAR(json["mean_rmse_3d_mm"]["uncalibrated"].get<double>(), 7.2, 1e-9);
}

}  // namespace
}  // namespace elastocal::cli
