#include "elastocal/io/posture_columns.hpp"

#include <gtest/gtest.h>

#include "tests/test_files.hpp"

namespace elastocal {
namespace {

// What is refused is tested with the reader (posture_table_test.cpp).
TEST(PostureColumns, FindsEveryKindOfColumn) {
  const Project project = ParseProject(
      "robot: {urdf: arm6.urdf}\n"
      "markers: {single: [{name: M, link: rail, position_mm: [1, 2, 3]},\n"
      "                   {name: N, link: carriage, position_mm: [1, 2, 3]}]}\n"
      "recording: {columns: {markers: {N: [x, y, z]}, joints: {rail_joint: q}}, ignore: [note]}\n",
      SourceFile("tests/robots/p.yaml"));
  const PostureColumns columns = FindPostureColumns(
      {"note", "z", "y", "x", "q", "t", "elbow_joint", "finger_right_joint"}, "f:1: ", project);
  EXPECT_EQ(columns.time, 5);
  EXPECT_EQ(columns.markers, std::vector<int>{1});
  ASSERT_EQ(columns.marker_columns.size(), 1u);
  EXPECT_EQ(columns.marker_columns[0], (std::array<int, 3>{3, 2, 1}));
  // Coordinates: rail, turret, shoulder, elbow, roll, bend, flange, left finger.
  EXPECT_EQ(columns.coordinate_columns, (std::vector<int>{4, -1, -1, 6, -1, -1, -1, -1}));
}

TEST(PostureColumns, DefaultNames) {
  EXPECT_EQ(DefaultMarkerColumns("M"), (std::array<std::string, 3>{"M_x", "M_y", "M_z"}));
}

}  // namespace
}  // namespace elastocal
