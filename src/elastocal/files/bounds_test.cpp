// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/bounds.hpp"

#include <limits>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

TEST(Bounds, EachKeyHasOneEntryWithARange) {
  std::set<std::string> keys;
  for (const Bound& bound : AllBounds()) {
    EXPECT_TRUE(keys.insert(bound.key).second) << bound.key;
    EXPECT_LT(bound.least, bound.largest) << bound.key;
  }
}

TEST(Bounds, AreFoundByIndicesAndNames) {
  EXPECT_EQ(BoundsOf("markers.clusters[3].positions_mm[0][2]").upper, 1e4);
  EXPECT_EQ(BoundsOf("recording.not_recorded_deg.arm.1_joint").upper, 720.0);
  EXPECT_EQ(FindBound("calibration.no_such_key"), nullptr);
  EXPECT_THROW(BoundsOf("no"), std::invalid_argument);
}

TEST(Bounds, SayWhatTheyContain) {
  const NumberRange share = BoundsOf("calibration.support_threshold");
  EXPECT_EQ(share.InWords(), "a number from 0.001 to 1");
  EXPECT_TRUE(share.Contains(1.0));
  EXPECT_FALSE(share.Contains(1.001));
  EXPECT_FALSE(share.Contains(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(BoundsOf("calibration.slip_mm").InWords(), "a number from 0.001 to 1000, or .inf");
}

// The document must contain the program's table, so that neither can change alone.
TEST(Bounds, StandInTheDocument) {
  const std::string document = ReadFile(SourceFile("docs/formats.md"));
  EXPECT_NE(document.find(BoundsTable()), std::string::npos)
      << "put this table into docs/formats.md, section Bounds:\n"
      << BoundsTable();
}

}  // namespace
}  // namespace elastocal
