// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/page.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::json;

constexpr const char* kTemplate = "<script>\"@ELASTOCAL_REPORT_DATA@\"</script>";

Json Report(const std::map<std::string, std::string>& files) {
  return Json::parse(MakeReportJson({"out", "1.2.3", files, {}}));
}

std::vector<std::string> MissingFrom(const Json& report) {
  std::vector<std::string> what;
  for (const Json& item : report["missing"]) what.push_back(item["what"]);
  return what;
}

TEST(Page, NoTextInTheDataEndsTheScript) {
  const Json evil = {{"joint", "</script><script>alert(1)</script><!--"}};
  const std::string page = MakePage(kTemplate, evil.dump());
  const std::string inside = page.substr(8, page.size() - 8 - 9);
  EXPECT_EQ(inside.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(inside), evil);
}

TEST(Page, NeedsAPlaceForTheData) { EXPECT_THROW(MakePage("<p>", "{}"), std::invalid_argument); }

TEST(Page, ShowsWhatTheFolderHasAndSaysWhatIsMissing) {
  const Json empty = Report({});
  EXPECT_EQ(empty["version"], "1.2.3");
  EXPECT_EQ(MissingFrom(empty),
            (std::vector<std::string>{"Calibration", "Another recording", "Choice of the postures",
                                      "The planned motion", "Calibrations over time"}));

  const Json full =
      Report({{"summary.json", R"({"robot": "r"})"},
              {"report_data.json", R"({"error_table": {"rows": []}, "signals": [1]})"},
              {"validation.json", "{}"},
              {"p_curves.csv", "algorithm,chain,postures,o1\nNOCP,leg,4,0.7\n"},
              {"p_summary.json", R"({"leg": {"o1": 0.7}})"},
              {"motion.csv", "time,support,j\n0,sole,0.1\n0.1,sole,0.2\n"},
              {"motion_margins.json", "{\"zmp_mm\": 20}"}});
  EXPECT_EQ(full["summary"]["robot"], "r");
  EXPECT_EQ(full["design"]["curves"]["o1"][0], 0.7);
  EXPECT_EQ(full["design"]["summary"]["leg"]["o1"], 0.7);
  ASSERT_EQ(full["motions"].size(), 1u);
  EXPECT_EQ(full["motions"][0]["rows"], 2);
  EXPECT_EQ(full["motions"][0]["columns"]["support"][1], "sole");
  EXPECT_EQ(full["motions"][0]["margins"]["zmp_mm"], 20);
  EXPECT_EQ(MissingFrom(full), (std::vector<std::string>{"Calibrations over time"}));
}

TEST(Page, TheRobotAloneServesWhereNothingWasCalibrated) {
  EXPECT_EQ(Report({{"robot_data.json", R"({"robot": "r"})"}})["data"]["robot"], "r");
  EXPECT_EQ(Report({{"robot_data.json", R"({"robot": "r"})"},
                    {"report_data.json", R"({"robot": "s"})"}})["data"]["robot"],
            "s");
}

TEST(Page, NamesAFileThatIsBroken) {
  ExpectInputError([] { Report({{"summary.json", "{\"a\": "}}); }, {"summary.json"});
}

TEST(Page, TakesTheFilesThatItKnows) {
  EXPECT_EQ(ReportFiles({"calibration.yaml", "summary.json", "a.csv", "b.csv", "b_margins.json",
                         "postures_curves.csv", "postures_summary.json", "covariance.csv"}),
            (std::vector<std::string>{"summary.json", "b.csv", "b_margins.json",
                                      "postures_curves.csv", "postures_summary.json"}));
}

TEST(Page, CorrelationsAreInHundredths) {
  CalibrationEstimate estimate;
  estimate.covariance_names = {"a", "b"};
  estimate.covariance.resize(2, 2);
  estimate.covariance << 4.0, -3.0, -3.0, 9.0;  // correlation -3 / (2 * 3)
  const Json report = Json::parse(MakeReportJson({"out", "", {}, {{"now", estimate}}}));
  EXPECT_EQ(report["correlation"]["lower"], "ZM5k");  // the bytes 100, -50 and 100
}

TEST(Page, TheTemplateIsWholeOrAbsent) {
  if (PageTemplate().empty()) GTEST_SKIP() << "built without Node.js: reports cannot be made";
  const std::string page = MakePage(PageTemplate(), "{}");
  EXPECT_EQ(page.find("src=\"/"), std::string::npos);
  EXPECT_EQ(page.find("@ELASTOCAL_REPORT_DATA@"), std::string::npos);
}

}  // namespace
}  // namespace elastocal
