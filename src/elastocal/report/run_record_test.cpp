// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/run_record.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/report/encoding.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

TEST(RunRecord, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(
      QuoteCommandLine({"elastocal", "calibrate", "my project.yaml", "it's", "", "-o", "out"}),
      "elastocal calibrate 'my project.yaml' 'it'\\''s' '' -o out");
}

TEST(RunRecord, KeepsOtherCommandsAndReplacesItsOwn) {
  const std::string first = UpdateRuns("", {"design", "elastocal design p", "1.0", 7, {}});
  const std::string second = UpdateRuns(first, {"calibrate", "old", "1.0", {}, {}});
  const auto json = nlohmann::json::parse(
      UpdateRuns(second, {"calibrate", "new", "1.1", {}, {{"a.csv", 3, "00"}}, "/b"}));
  EXPECT_EQ(json["design"]["seed"], 7);
  EXPECT_EQ(json["calibrate"]["command_line"], "new");
  EXPECT_EQ(json["calibrate"]["folder"], "/b");
  EXPECT_TRUE(json["calibrate"]["seed"].is_null());
  EXPECT_EQ(json["calibrate"]["inputs"][0]["sha256"], "00");
}

TEST(RunRecord, AFileOfAnotherKindIsNotKept) {
  EXPECT_EQ(nlohmann::json::parse(UpdateRuns("not JSON", {"a", "b", "c", {}, {}})).size(), 1u);
}

TEST(RunRecord, ChecksFilesAndPassesOverWhatIsNone) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.Write("input", "abc");
  const std::vector<InputRecord> records =
      RecordInputs({file, scratch.path(), scratch.path() / "absent"});
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].bytes, 3u);
  EXPECT_EQ(records[0].sha256, Sha256("abc"));
}

}  // namespace
}  // namespace elastocal
