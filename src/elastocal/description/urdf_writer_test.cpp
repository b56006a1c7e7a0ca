// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/urdf_writer.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr const char* kUrdf =
    "<?xml version='1.0'?><!-- <joint name=\"hip\"><origin/></joint> -->\r\n"
    "<robot name=\"r\">\r\n"
    "  <transmission name=\"t\"><joint name=\"hip\"><origin xyz=\"9 9 "
    "9\"/></joint></transmission>\r\n"
    "  <link name=\"a\"/><link name='b'/>\t<link name=\"c\"/> <link name=\"d\"/>\r\n"
    "  <joint\r\n   type = 'continuous'\r\n   name='hip'>\r\n"
    "    <!-- measured > twice --> <parent link=\"a\"/><child link=\"b\"/>\r\n"
    "    <origin rpy = '0 0  0.50'\r\n            xyz=\"1.0 2 3\"  />\r\n"
    "  </joint>\r\n"
    "\r\n"
    "  <joint name=\"k&amp;nee\" type=\"fixed\">\r\n"
    "\r\n"
    "    <parent link=\"b\"/> <child link=\"c\"/>\r\n"
    "  </joint>\r\n"
    "  <joint name=\"toe\" type=\"fixed\"><origin/><parent link=\"c\"/><child "
    "link=\"d\"/></joint>\r\n"
    "  <gazebo><![CDATA[<joint name=\"toe\"><origin/>]]><joint name=\"toe\"/></gazebo>\r\n"
    "</robot>";

std::string Replaced(std::string text, const std::string& old, const std::string& with) {
  return text.replace(text.find(old), old.size(), with);
}

TEST(UrdfWriter, ReadsOriginsAsWritten) {
  const auto origins = ReadOrigins(kUrdf, "r.urdf");
  ASSERT_EQ(origins.size(), 3u);
  EXPECT_EQ(origins.at("hip").xyz, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(origins.at("hip").rpy, Eigen::Vector3d(0, 0, 0.5));
  EXPECT_EQ(origins.at("k&nee").xyz, Eigen::Vector3d::Zero());
}

TEST(UrdfWriter, ChangesOnlyTheValuesThatDiffer) {
  const std::string result =
      ReplaceOrigins(kUrdf, "r.urdf", {{"hip", {{1, 2, 3.25}, {0, 0, 0.5}}}});
  EXPECT_EQ(result, Replaced(kUrdf, "1.0 2 3", "1 2 3.25"));
  const std::string both =
      ReplaceOrigins(kUrdf, "r.urdf", {{"hip", {{1, 2, 3.25}, {0.1, 0, 0.5}}}});
  EXPECT_EQ(both, Replaced(result, "0 0  0.50", "0.1 0 0.5"));
}

TEST(UrdfWriter, UnchangedOriginsLeaveEveryByte) {
  EXPECT_EQ(ReplaceOrigins(kUrdf, "r.urdf", ReadOrigins(kUrdf, "r.urdf")), kUrdf);
}

TEST(UrdfWriter, InsertsAMissingOriginOnItsOwnLine) {
  const std::string result =
      ReplaceOrigins(kUrdf, "r.urdf", {{"k&nee", {{0, 0, -0.5}, {0, 0, 0}}}});
  EXPECT_EQ(result, Replaced(kUrdf, "type=\"fixed\">\r\n\r\n",
                             "type=\"fixed\">\r\n    <origin xyz=\"0 0 -0.5\" rpy=\"0 0 0\"/>"
                             "\r\n\r\n"));
}

TEST(UrdfWriter, InsertsMissingAttributes) {
  const std::string result = ReplaceOrigins(kUrdf, "r.urdf", {{"toe", {{0, 0, 1}, {2, 0, 0}}}});
  EXPECT_EQ(result,
            Replaced(kUrdf, "<joint name=\"toe\" type=\"fixed\"><origin/>",
                     "<joint name=\"toe\" type=\"fixed\"><origin xyz=\"0 0 1\" rpy=\"2 0 0\"/>"));
}

// The parser shortens entities and skips a byte order mark. Neither may shift the places in the
// text.
TEST(UrdfWriter, FindsPlacesBehindEntitiesAndMarks) {
  const std::string text =
      "\xEF\xBB\xBF<!-- caf\xe9 --><robot name=\"&lt;&lt;r&gt;&gt;\"><link name='a&#233;'/><link "
      "name='b'/><joint type='fixed' note='&#62;>' name='&quot;j&quot;' ><parent link='a&#xE9;'/>"
      "<child link='b'/><origin note='&amp;&amp;' rpy='&#49; 2 3' xyz = '0 0 0'/></joint></robot>";
  const auto origins = ReadOrigins(text, "r.urdf");
  EXPECT_EQ(origins.at("\"j\"").rpy, Eigen::Vector3d(1, 2, 3));
  const auto changed = ReplaceOrigins(text, "r.urdf", {{"\"j\"", {{0, 0, 7}, {4, 2, 3}}}});
  EXPECT_EQ(changed, Replaced(Replaced(text, "&#49; 2 3", "4 2 3"), "0 0 0", "0 0 7"));
  const std::string without =
      Replaced(text, "<origin note='&amp;&amp;' rpy='&#49; 2 3' xyz = '0 0 0'/>", "");
  EXPECT_EQ(ReplaceOrigins(without, "r.urdf", {{"\"j\"", {{0, 0, 7}, {4, 2, 3}}}}),
            Replaced(without, "' >", "' ><origin xyz=\"0 0 7\" rpy=\"4 2 3\"/>"));
}

TEST(UrdfWriter, NumbersReadBackExactly) {
  const UrdfOrigin origin{{0.1, 1.0 / 3.0, -1e-17}, {M_PI, 2e-300, 12345.678901234567}};
  const auto written = ReadOrigins(ReplaceOrigins(kUrdf, "r.urdf", {{"toe", origin}}), "r.urdf");
  EXPECT_EQ(written.at("toe").xyz, origin.xyz);
  EXPECT_EQ(written.at("toe").rpy, origin.rpy);
}

TEST(UrdfWriter, ChangesEveryJointOfARealModelAndBack) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const auto nominal = ReadOrigins(urdf, "arm6.urdf");
  auto moved = nominal;
  for (auto& [name, origin] : moved) {
    origin.xyz += Eigen::Vector3d(1e-3, -2e-3, 3e-3);
    origin.rpy += Eigen::Vector3d(-3e-3, 2e-3, 1e-3);
  }
  const std::string there = ReplaceOrigins(urdf, "arm6.urdf", moved);
  const auto read = ReadOrigins(there, "arm6.urdf");
  for (const auto& [name, origin] : moved) {
    EXPECT_EQ(read.at(name).xyz, origin.xyz) << name;
    EXPECT_EQ(read.at(name).rpy, origin.rpy) << name;
  }
  const auto back = ReadOrigins(ReplaceOrigins(there, "arm6.urdf", nominal), "arm6.urdf");
  for (const auto& [name, origin] : nominal) EXPECT_EQ(back.at(name).xyz, origin.xyz) << name;
}

TEST(UrdfWriter, NamesAnUnknownJoint) {
  ExpectInputError(
      [] {
        ReplaceOrigins(kUrdf, "r.urdf", {{"hipp", {}}});
      },
      {"r.urdf", "'hipp'", "did you mean 'hip'"});
  EXPECT_THROW(ReplaceOrigins(kUrdf, "r.urdf", {{"hip", {{NAN, 0, 0}, {0, 0, 0}}}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
