// SPDX-License-Identifier: Apache-2.0
// Measured places of markers tell the last frame, which markers in motion do not tell.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "elastocal/exports/open_frames.hpp"
#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/pipeline/known_places.hpp"
#include "elastocal/validation/transfer.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/invented_arm.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

constexpr double kStated = 0.5e-3;  // m

class MarkerPlaces : public InventedArm {
 protected:
  std::vector<MarkerMeasurement> Measured(const Eigen::VectorXd& truth, double scatter,
                                          std::uint64_t seed) const {
    Random random(seed);
    std::vector<MarkerMeasurement> places;
    for (const Marker& marker : model_.markers) {
      const int x = FindParameter(model_.parameters, "marker." + marker.name + ".x");
      const Eigen::Vector3d deviation = truth.segment<3>(x);
      places.push_back({marker.name,
                        marker.p_link_marker + deviation + random.NormalVector(3, scatter),
                        kStated});
    }
    return places;
  }

  CalibrationResult Fit(const Eigen::VectorXd& truth, const std::vector<MarkerMeasurement>& places,
                        std::uint64_t seed) {
    const Recording recording =
        MakeSyntheticRecording(model_, truth, {.postures = 40, .marker_sd = 0.2e-3, .seed = seed});
    const RecordedModel robot{.model = model_, .base = base_};
    CalibrationOptions options;
    warnings_.clear();
    return CalibrateWithPlaces(places, robot, recording, options, warnings_);
  }

  /// Parameters of the last joint: the turn about its axis and the place along it.
  std::vector<int> LastFrame() const {
    const int link = FindLink(model_.tree, "tool");
    const int body = model_.tree.links[static_cast<std::size_t>(link)].body;
    const std::string& last = model_.tree.joints[static_cast<std::size_t>(body - 1)].name;
    return {FindParameter(model_.parameters, last + ".theta"),
            FindParameter(model_.parameters, last + ".r")};
  }

  std::vector<std::string> warnings_;
};

TEST_F(MarkerPlaces, TellTheLastFrameAsWellAsTheySay) {
  constexpr int kRobots = 40;
  double squares = 0.0;
  int hits = 0, count = 0;
  for (int robot = 1; robot <= kRobots; ++robot) {
    const auto seed = static_cast<std::uint64_t>(robot);
    const Eigen::VectorXd truth = Truth(robot, 10e-3);
    const CalibrationResult known = Fit(truth, Measured(truth, kStated, seed), seed);
    EXPECT_TRUE(warnings_.empty()) << warnings_.front();
    const CalibrationResult open = robot == 1 ? Fit(truth, {}, seed) : known;
    for (const int i : LastFrame()) {
      ASSERT_GE(i, 0);
      const double off = (known.delta[i] - truth[i]) / known.sd[i];
      squares += off * off;
      hits += std::abs(off) < known.interval_factor ? 1 : 0;
      ++count;
      EXPECT_EQ(known.status[static_cast<std::size_t>(i)], ParameterStatus::kEstimated);
      if (robot > 1) continue;
      EXPECT_EQ(open.status[static_cast<std::size_t>(i)], ParameterStatus::kUnsupported);
      EXPECT_LT(known.sd[i], 0.5 * open.sd[i]);
    }
  }
  // Chi-square with 80 degrees of freedom is within these bounds with a probability of 99.9 %.
  EXPECT_GT(squares / count, 0.55);
  EXPECT_LT(squares / count, 1.60);
  EXPECT_GE(hits, 70);
}

TEST_F(MarkerPlaces, AGrossErrorIsNamedAndLeftOut) {
  const Eigen::VectorXd truth = Truth(3, 10e-3);
  std::vector<MarkerMeasurement> places = Measured(truth, kStated, 3);
  const std::string wrong = places.back().marker;
  places.back().p_link_marker += Eigen::Vector3d(0.02, -0.01, 0.0);
  const CalibrationResult result = Fit(truth, places, 3);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("marker " + wrong), std::string::npos) << warnings_[0];
  places.pop_back();
  const CalibrationResult without = Fit(truth, places, 3);
  EXPECT_TRUE(warnings_.empty());
  EXPECT_LT((result.delta - without.delta).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(MarkerPlaces, ThatScatterByMoreThanTheySayCountLess) {
  const Eigen::VectorXd truth = Truth(4, 10e-3);
  const CalibrationResult result = Fit(truth, Measured(truth, 6.0 * kStated, 4), 4);
  ASSERT_FALSE(warnings_.empty());
  EXPECT_NE(warnings_.back().find("times as large"), std::string::npos) << warnings_.back();
  for (const int i : LastFrame()) {
    EXPECT_LT(std::abs(result.delta[i] - truth[i]), 4.0 * result.sd[i]);
  }
}

// With the true joints, a refit is as far from the places as their measurement errors. If the zero
// of the last joint is off by 40 mrad (2 mm at a marker), the markers of the tool are further off,
// and the others are not.
TEST_F(MarkerPlaces, ARefitSaysHowFarItIsFromThem) {
  constexpr int kRobots = 20;
  const Parameter& last_zero = model_.parameters[static_cast<std::size_t>(LastFrame()[0])];
  const int tool = FindLink(model_.tree, "tool");
  const int body = model_.tree.links[static_cast<std::size_t>(tool)].body;
  double squares = 0.0;
  int numbers = 0;
  for (int robot = 1; robot <= kRobots; ++robot) {
    const auto seed = static_cast<std::uint64_t>(robot);
    const Eigen::VectorXd truth = Truth(robot, 10e-3);
    const std::vector<MarkerMeasurement> places = Measured(truth, kStated, seed);
    const Recording recording =
        MakeSyntheticRecording(model_, truth, {.postures = 40, .marker_sd = 0.2e-3, .seed = seed});
    CalibrationOptions options;
    KnowMarkers(places, model_, options.earlier);
    std::map<std::string, double> joints;
    for (int i = 0; i < model_.parameter_count(); ++i) {
      const Parameter& parameter = model_.parameters[static_cast<std::size_t>(i)];
      if (!IsExternal(parameter.kind)) joints[parameter.name] = truth[i];
    }
    const auto residuals = [&] {
      return PlaceResiduals(places, RefitTo(model_, recording, base_, options, joints).result);
    };
    const std::vector<PlaceResidual> right = residuals();
    ASSERT_EQ(right.size(), model_.markers.size());
    for (const PlaceResidual& one : right) {
      EXPECT_LT(one.in_sds(), 3.0) << one.marker;
      squares += one.squares;
      numbers += 3;
    }
    joints[last_zero.name] += 40e-3;
    double of_tool = 0.0;
    for (const PlaceResidual& one : residuals()) {
      const auto marker = std::ranges::find(model_.markers, one.marker, &Marker::name);
      if (model_.tree.links[static_cast<std::size_t>(marker->link)].body == body) {
        of_tool = std::max(of_tool, one.in_sds());
      } else {
        EXPECT_LT(one.in_sds(), 3.0) << one.marker;
      }
    }
    EXPECT_GT(of_tool, 2.0);
  }
  EXPECT_NEAR(squares / numbers, 1.0, 0.2);
}

// Two measurements of one number give their mean, weighted by the inverse variances.
TEST_F(MarkerPlaces, BesideAnEarlierCalibrationBothCount) {
  const Marker& marker = model_.markers.front();
  EarlierEstimate known{{"joint.theta", "marker." + marker.name + ".y"},
                        Eigen::Vector2d(0.1, 3e-3),
                        Eigen::MatrixXd::Zero(2, 2)};
  known.covariance << 1e-4, 5e-6, 5e-6, 1e-6;
  KnowMarkers({{marker.name, marker.p_link_marker + Eigen::Vector3d(0.0, 5e-3, 1e-3), 2e-3}},
              model_, known);
  EXPECT_TRUE(KnowsRobot(known));
  ASSERT_EQ(known.names.size(), 4u);
  EXPECT_NEAR(known.mean[1], (3e-3 / 1e-6 + 5e-3 / 4e-6) / (1.0 / 1e-6 + 1.0 / 4e-6), 1e-12);
  EXPECT_NEAR(known.covariance(1, 1), 0.8e-6, 1e-15);
  EXPECT_NEAR(known.mean[0], 0.1 + 5e-6 / 5e-6 * 2e-3, 1e-12);  // follows by its correlation
  EXPECT_NEAR(known.mean[3], 1e-3, 1e-12);
  EXPECT_NEAR(known.covariance(3, 3), 4e-6, 1e-15);
  EarlierEstimate places;
  KnowMarkers({{marker.name, marker.p_link_marker, 2e-3}}, model_, places);
  EXPECT_FALSE(KnowsRobot(places));
}

// The export says which frames are undetermined, and what would determine them.
TEST(OpenFrames, AreThoseOfLastJointsThatNothingTold) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const auto parameter = [](const char* name, ParameterStatus status, double sd) {
    ParameterEstimate estimate;
    estimate.name = name;
    estimate.status = status;
    estimate.sd = sd;
    return estimate;
  };
  CalibrationEstimate estimate;
  estimate.parameters = {parameter("arm_left_6_joint.r", ParameterStatus::kUnsupported, 1e-3),
                         parameter("arm_left_7_joint.theta", ParameterStatus::kUnsupported, 0.0117),
                         parameter("arm_left_7_joint.r", ParameterStatus::kUnsupported, 1.8e-3),
                         parameter("leg_left_6_joint.theta", ParameterStatus::kEstimated, 1e-3),
                         parameter("leg_left_6_joint.r", ParameterStatus::kUnsupported, 1.8e-3)};
  const std::vector<std::string> told = DescribeOpenFrames(project, estimate);
  ASSERT_EQ(told.size(), 3u);
  EXPECT_NE(told[0].find("--marker-places"), std::string::npos);
  EXPECT_NE(std::ranges::find(told,
                              "  gripper_left_base_link: 0.67 deg about, 1.8 mm along the axis "
                              "of arm_left_7_joint"),
            told.end())
      << ::testing::PrintToString(told);
  EXPECT_NE(std::ranges::find(told, "  left_sole_link: 1.8 mm along the axis of leg_left_6_joint"),
            told.end());
  estimate.parameters.resize(1);
  EXPECT_TRUE(DescribeOpenFrames(project, estimate).empty());
}

class MarkerPlacesFile : public ::testing::Test {
 protected:
  std::vector<MarkerMeasurement> Read(const std::string& text) const {
    return ReadMarkerPlaces(scratch_.Write("places.csv", text), project_);
  }
  void ExpectError(const std::string& text, std::initializer_list<std::string> words) const {
    ExpectInputError([&] { Read(text); }, words);
  }

  const Project project_ = ReadProject(SourceFile("models/talos/project.yaml"));
  const ScratchFolder scratch_;
};

TEST_F(MarkerPlacesFile, IsReadAsItIsWritten) {
  const std::vector<MarkerMeasurement> places = {
      {"LHAND_1", Eigen::Vector3d(0.0412, -1e-4, -0.0603), 5e-4},
      {"WAIST_2", Eigen::Vector3d(-0.16, -0.065, -0.035), 2e-3}};
  const std::vector<MarkerMeasurement> read = Read(FormatMarkerPlaces(places));
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].marker, places[i].marker);
    EXPECT_LT((read[i].p_link_marker - places[i].p_link_marker).norm(), 1e-7);
    EXPECT_NEAR(read[i].sd, places[i].sd, 1e-12);
  }
}

// A fixed joint connects a sole to its ankle, so places may be relative to either link.
TEST_F(MarkerPlacesFile, APlaceMayBeSeenFromAnotherLinkOfTheBody) {
  const auto read = Read("marker,x_mm,y_mm,z_mm,sd_mm,link\nLFOOT_1,10,20,30,0.5,left_sole_link\n");
  const Marker& marker = *std::ranges::find(project_.markers, "LFOOT_1", &Marker::name);
  const Link& own = project_.tree.links[static_cast<std::size_t>(marker.link)];
  const Link& sole = *std::ranges::find(project_.tree.links, "left_sole_link", &Link::name);
  const Eigen::Vector3d expected =
      own.T_body_link.inverse() * (sole.T_body_link * Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_LT((read.at(0).p_link_marker - expected).norm(), 1e-12);
  EXPECT_GT((expected - Eigen::Vector3d(0.01, 0.02, 0.03)).norm(), 0.05);  // they differ
}

// A table that simulate or a laboratory left in the recording's folder is easily forgotten.
TEST_F(MarkerPlacesFile, BesideARecordingThatIsNotUsedIsNamed) {
  EXPECT_TRUE(WarnOfIdleMarkerPlaces({scratch_.path()}).empty());
  scratch_.Write("marker_places.csv", "marker,x_mm,y_mm,z_mm,sd_mm\n");
  const std::filesystem::path table = scratch_.Write("table.csv", "");
  const auto warnings = WarnOfIdleMarkerPlaces({scratch_.path(), table});  // the same, once
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("marker_places.csv: these measured places"), std::string::npos);
  EXPECT_NE(warnings[0].find("--marker-places"), std::string::npos);
}

TEST_F(MarkerPlacesFile, WhatIsWrongIsNamed) {
  const std::string head = "marker,x_mm,y_mm,z_mm,sd_mm\n";
  ExpectError(head, {"places.csv", "no row"});
  ExpectError(head + "LHAND_9,1,2,3,0.5\n", {":2", "LHAND_9", "no marker"});
  ExpectError(head + "LHAND_1,1,2,3,0.5\nLHAND_1,1,2,3,0.5\n", {":3", "twice"});
  ExpectError(head + "LHAND_1,1,2,nan,0.5\n", {":2", "z_mm"});
  ExpectError(head + "LHAND_1,1,2,3,0\n", {":2", "sd_mm", "0.001"});
  ExpectError(head + "LHAND_1,1,2,3e9,0.5\n", {":2", "z_mm", "10000"});
  ExpectError(head + "LHAND_1,0.04,0,-0.06,0.5\n", {"in m"});
  ExpectError("marker,x_mm,y_mm,z_mm\nLHAND_1,1,2,3\n", {"sd_mm"});
  ExpectError("marker,x,y,z,sd_mm\nLHAND_1,1,2,3,0.5\n", {"'x'"});
  ExpectError("marker,x_mm,y_mm,z_mm,sd_mm,link\nLHAND_1,1,2,3,0.5,torso_2_link\n",
              {":2", "torso_2_link", "joint lies between"});
}

}  // namespace
}  // namespace elastocal
