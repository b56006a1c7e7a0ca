// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/playback.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "elastocal/math/rotation_vector.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::json;

std::string FromBase64(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = (bits << 6) | static_cast<unsigned>(alphabet.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>((bits >> count) & 0xff);
  }
  return bytes;
}

std::string Inflated(const std::string& deflated) {
  std::string bytes(1000, '\0');
  uLongf size = bytes.size();
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                reinterpret_cast<const Bytef*>(deflated.data()), deflated.size());
  EXPECT_EQ(status, Z_OK);
  bytes.resize(size);
  return bytes;
}

/// A biped in a planned posture, at some place in the world.
struct Played {
  Biped biped = MakeBiped();
  int left = FindLink(biped.tree, "left_sole"), right = FindLink(biped.tree, "right_sole");
  int trunk = biped.chains[0].tip_link;
  Eigen::VectorXd q =
      Eigen::VectorXd::LinSpaced(biped.tree.coordinate_count(), -0.3, 0.4);  // any posture
  std::vector<Transform> T_root_link = LinkTransforms(biped.tree, q);
  Transform T_world_root =
      Transform(Eigen::Translation3d(0.3, -2.0, 0.8)) *
      Transform(Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));

  std::vector<Transform> InWorld() const {
    std::vector<Transform> poses;
    for (const Transform& pose : T_root_link) poses.push_back(T_world_root * pose);
    return poses;
  }
  PlaybackRecorder Recorder() const {
    return {biped.tree,
            {{.link = trunk}, {.link = left, .is_foot = true}, {.link = right, .is_foot = true}}};
  }
};

TEST(Playback, ARobotThatDoesWhatIsPlannedHasNoDisplacementWhereverItStands) {
  const Played played;
  PlaybackRecorder recorder = played.Recorder();
  recorder.Add(0.2, played.q, played.T_root_link, {played.left, played.right}, played.InWorld());
  recorder.Add(0.4, played.q, played.T_root_link, {played.right}, played.InWorld());
  const Playback& playback = recorder.playback();
  ASSERT_EQ(playback.time_s.size(), 2u);
  for (const auto& displacement : playback.displacement) {
    ASSERT_EQ(displacement.cols(), static_cast<Eigen::Index>(playback.links.size()));
    EXPECT_LT(displacement.cwiseAbs().maxCoeff(), 1e-12);
  }
  // When another foot begins to stand, the root link does not jump.
  EXPECT_TRUE(playback.T_plan_root[1].isApprox(playback.T_plan_root[0], 1e-12));
  const PlaybackTip& swinging = playback.tips[1];
  EXPECT_TRUE(std::isnan(swinging.distance_m[0])) << "it stands";
  EXPECT_LT(swinging.distance_m[1], 1e-12);
  EXPECT_LT(playback.tips[0].distance_m[0], 1e-12);
}

TEST(Playback, FirstFootBeginsOnTheGroundWhereTheZeroPostureHasIt) {
  const Played played;
  PlaybackRecorder recorder = played.Recorder();
  recorder.Add(0.0, played.q, played.T_root_link, {played.right}, played.InWorld());
  const Transform got = recorder.playback().T_plan_root[0] *
                        played.T_root_link[static_cast<std::size_t>(played.right)];
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(played.q.size());
  Transform wanted =
      LinkTransforms(played.biped.tree, zero)[static_cast<std::size_t>(played.right)];
  wanted.translation().z() = 0.0;
  EXPECT_TRUE(got.isApprox(wanted, 1e-12));
}

TEST(Playback, DisplacementAndDistanceAreThoseOfTheLink) {
  const Played played;
  PlaybackRecorder recorder = played.Recorder();
  std::vector<Transform> T_world_link = played.InWorld();
  recorder.Add(0.0, played.q, played.T_root_link, {played.left}, T_world_link);
  // The trunk is displaced by 3, 4 and 12 mm and turned by 20 mrad about its own z axis.
  Transform& trunk = T_world_link[static_cast<std::size_t>(played.trunk)];
  trunk.pretranslate(Eigen::Vector3d(3e-3, 4e-3, 12e-3));
  trunk.rotate(Eigen::AngleAxisd(20e-3, Eigen::Vector3d::UnitZ()));
  recorder.Add(0.2, played.q, played.T_root_link, {played.left}, T_world_link);
  const Playback& playback = recorder.playback();
  for (std::size_t i = 0; i < playback.links.size(); ++i) {
    const Eigen::Matrix<double, 6, 1> moved =
        playback.displacement[1].col(static_cast<Eigen::Index>(i));
    const bool is_trunk = playback.links[i] == played.trunk;
    EXPECT_NEAR(moved.head<3>().norm(), is_trunk ? 13e-3 : 0.0, 1e-12);
    EXPECT_NEAR(moved.tail<3>().norm(), is_trunk ? 20e-3 : 0.0, 1e-12);
    if (!is_trunk) continue;
    const Eigen::Matrix3d R =
        (playback.T_plan_root[1] * played.T_root_link[static_cast<std::size_t>(played.trunk)])
            .linear();
    EXPECT_TRUE(moved.tail<3>().isApprox(20e-3 * R.col(2), 1e-9)) << "in the common frame";
  }
  EXPECT_NEAR(playback.tips[0].distance_m[1], 13e-3, 1e-12);
}

TEST(Playback, JsonHasDifferencesInTenthsAndNullForAStandingFoot) {
  const RobotTree tree = MakeRoot();
  PlaybackRecorder recorder(tree, {{.link = 0, .is_foot = true}});
  const Eigen::VectorXd q(0);
  const std::vector<Transform> still = {Transform::Identity()};
  recorder.Add(0.2, q, still, {0}, still);
  // Moves by 12.34 mm, by 5 m and by 3 mrad the other way. The first takes one byte, the second
  // more.
  Transform moved(Eigen::Translation3d(12.34e-3, -5.0, 0.0));
  moved.linear() = RotationFromVector({0.0, 0.0, -3e-3});
  recorder.Add(0.4, q, still, {0}, {moved});
  moved.translation() = Eigen::Vector3d(-12.36e-3, -5.0, 0.1e-3);
  recorder.Add(0.6, q, still, {0}, {moved});
  const Json json = Json::parse(FormatPlaybacks(tree, {{"urdf", true, &recorder.playback()}}));
  EXPECT_EQ(json["time_s"], Json::parse("[0.2, 0.4, 0.6]"));
  EXPECT_EQ(json["links"], Json::parse(R"(["root"])"));
  EXPECT_EQ(json["unit_m"], 1e-4);
  const Json& robot = json["robots"][0];
  EXPECT_EQ(robot["as"], "urdf");
  EXPECT_EQ(robot["pictures"], 3);
  EXPECT_EQ(robot["tips"][0]["place"], "foot");
  EXPECT_EQ(robot["tips"][0]["distance_mm"], Json::parse("[null, null, null]"));
  // 123, -50000 (escaped: b0 3c ff ff), 0; 0, 0, -30. Then differences: -124 (-247, escaped), 0, 1.
  const std::string bytes = std::string(6, '\0') +
                            std::string("\x7b\x80\xb0\x3c\xff\xff\x00\x00\x00\xe2", 10) +
                            std::string("\x80\x84\xff\xff\xff\x00\x01\x00\x00\x00", 10);
  EXPECT_EQ(Inflated(FromBase64(robot["displacement"])), bytes);
}

}  // namespace
}  // namespace elastocal
