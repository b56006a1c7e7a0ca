#include "elastocal/robot/error_model.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Names = std::vector<std::string>;

Names ParameterNames(const ErrorModel& model) {
  Names names;
  for (const Parameter& parameter : model.parameters) names.push_back(parameter.name);
  return names;
}

TEST(ErrorModel, NamesParametersInOrder) {
  const ErrorModel model = MakeErrorModel(PlanarArm(), {{"A", 0, {}}, {"B", 3, {}}});
  EXPECT_EQ(ParameterNames(model),
            (Names{"waist.T0.gamma", "waist.T0.b",  "waist.T0.alpha", "waist.T0.d",
                   "waist.T0.theta", "waist.T0.r",  "shoulder.gamma", "shoulder.b",
                   "shoulder.alpha", "shoulder.d",  "shoulder.theta", "shoulder.r",
                   "elbow.beta",     "elbow.alpha", "elbow.d",        "elbow.theta",
                   "elbow.r",        "marker.A.x",  "marker.A.y",     "marker.A.z",
                   "marker.B.x",     "marker.B.y",  "marker.B.z"}));
}

TEST(ErrorModel, KindsUnitsAndOwnersFollowTheName) {
  for (const ErrorModel& model :
       {TalosLegModel(), MakeErrorModel(RailArm(), {{"M", 7, {}}, {"N", 0, {}}})}) {
    for (const Parameter& p : model.parameters) {
      const std::string last = p.name.substr(p.name.rfind('.') + 1);
      const bool length = last.size() == 1;  // b d r x y z
      EXPECT_EQ(p.unit, length ? ParameterUnit::kMetre : ParameterUnit::kRadian) << p.name;
      if (p.kind == ParameterKind::kMarker) {
        EXPECT_EQ(p.name, "marker." + model.markers.at(p.marker).name + "." + last);
        EXPECT_EQ(p.joint, -1);
      } else if (p.kind == ParameterKind::kBase) {
        EXPECT_EQ(p.name, "waist.T0." + last);
        EXPECT_EQ(p.joint, -1);
        EXPECT_EQ(p.marker, -1);
      } else {
        EXPECT_EQ(p.name, model.tree.joints.at(p.joint).name + "." + KindName(p.kind));
        EXPECT_EQ(p.marker, -1);
      }
    }
  }
}

TEST(ErrorModel, OnlyJointsThatMoveAMarkerHaveParameters) {
  const int finger_2 = FindLink(RailArm(), "finger_2_link");
  const int turret = FindLink(RailArm(), "turret_link");
  EXPECT_EQ(MakeErrorModel(RailArm(), {{"T", turret, {}}}).active_joints, (std::vector<int>{0, 1}));
  EXPECT_EQ(MakeErrorModel(RailArm(), {{"F", finger_2, {}}, {"T", turret, {}}}).active_joints,
            (std::vector<int>{0, 1, 2, 3, 5}));
  EXPECT_TRUE(MakeErrorModel(RailArm(), {}).active_joints.empty());
  EXPECT_EQ(MakeErrorModel(RailArm(), {}).parameter_count(), 6);
}

TEST(ErrorModel, RefusesDuplicateNamesAndStrangeLinks) {
  EXPECT_THROW(MakeErrorModel(PlanarArm(), {{"A", 1, {}}, {"A", 3, {}}}), std::invalid_argument);
  EXPECT_THROW(MakeErrorModel(PlanarArm(), {{"A", 4, {}}}), std::invalid_argument);
  EXPECT_THROW(MakeErrorModel(PlanarArm(), {{"A", -1, {}}}), std::invalid_argument);
}

TEST(SelectMarkers, IsTheModelOfTheseMarkers) {
  ErrorModel leg = TalosLegModel();
  leg.T_ref_waist = Offset(1, 2, 3);
  const ErrorModel selected = SelectMarkers(leg, {"SHANK_2", "THIGH_1"});
  const ErrorModel expected = MakeErrorModel(
      TalosLeg(), {{"SHANK_2", 4, {0.065, -0.01, -0.22}}, {"THIGH_1", 3, {0.07, 0.04, -0.09}}});
  EXPECT_EQ(ParameterNames(selected), ParameterNames(expected));
  EXPECT_EQ(selected.active_joints, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(selected.markers[0].name, "SHANK_2");
  EXPECT_EQ(selected.markers[0].p_link_marker, expected.markers[0].p_link_marker);
  EXPECT_EQ(selected.markers[1].link, 3);
  EXPECT_TRUE(selected.T_ref_waist.isApprox(leg.T_ref_waist));
}

TEST(SelectMarkers, AnUnknownNameIsAnError) {
  ExpectInputError([] { SelectMarkers(TalosLegModel(), {"FOOT1"}); },
                   {"no marker 'FOOT1'", "mean 'FOOT_1'?"});
}

TEST(SelectMarkers, RefusesOneMarkerTwice) {
  EXPECT_THROW(SelectMarkers(TalosLegModel(), {"FOOT_1", "FOOT_1"}), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
