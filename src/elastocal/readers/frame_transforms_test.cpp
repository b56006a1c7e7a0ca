// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/frame_transforms.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

using Numbers = std::array<double, 7>;

const double kHalf = std::sqrt(0.5);
const Numbers kTurned = {10, 20, 30, 0, 0, kHalf, kHalf};  // turned about z by 90 degrees

/// Adds two transforms of a child, a second apart.
void Move(FrameTransforms& transforms, const std::string& parent, const std::string& child,
          std::int64_t begin_ns = 1000000000) {
  for (int i = 0; i < 2; ++i) {
    const std::int64_t stamp = begin_ns > 0 ? begin_ns + i * 1000000000 : 0;
    transforms.Add({parent, child, stamp, 7 + i, {1.0 + i, -2, 0.5, 0, 0, kHalf, kHalf}}, false,
                   "");
  }
}

std::vector<BodyTrack> Taken(FrameTransforms transforms) {
  std::string why;
  std::vector<BodyTrack> tracks = transforms.Take("bag", why);
  EXPECT_EQ(why, "");
  return tracks;
}

void ExpectPose(const BodyTrack& track, std::size_t i, const Numbers& expected) {
  for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(track.poses[7 * i + k], expected[k], 1e-14) << k;
}

TEST(FrameTransforms, TheOnlyFrameThatOthersMoveInIsTheCameras) {
  FrameTransforms transforms("", {});
  Move(transforms, "/world", "/vrpn/LHAND");
  Move(transforms, "/world", "/vrpn/RHAND");
  transforms.Add({"map", "world", 0, 0, kTurned}, true, "");
  const std::vector<BodyTrack> tracks = Taken(transforms);
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].name, "LHAND");
  EXPECT_EQ(tracks[1].name, "RHAND");
  EXPECT_EQ(tracks[0].stamps_ns, (std::vector<std::int64_t>{1000000000, 2000000000}));
  const std::vector<double> sent = {1, -2, 0.5, 0, 0, kHalf, kHalf, 2, -2, 0.5, 0, 0, kHalf, kHalf};
  EXPECT_EQ(tracks[0].poses, sent);  // the same bits
}

TEST(FrameTransforms, LastPartsThatAreNotUniqueKeepTheirNames) {
  FrameTransforms transforms("world", {});
  Move(transforms, "world", "a/hand");
  Move(transforms, "world", "b/hand");
  EXPECT_EQ(Taken(transforms)[0].name, "a/hand");
}

TEST(FrameTransforms, StaticTransformsLieBetween) {
  const auto with = [](const std::string& frame, const std::string& body) {
    FrameTransforms transforms(frame, {body});
    Move(transforms, "cameras", "LHAND");
    transforms.Add({"room", "cameras", 0, 0, kTurned}, true, "");
    transforms.Add({"LHAND", "tool", 0, 0, {0, 0, 0.25, 0, 0, 2 * kHalf, 2 * kHalf}}, true, "");
    transforms.Add({"room", "door", 0, 0, {1, 0, 0, 0, 0, 0, 1}}, true, "");
    return Taken(transforms);
  };
  // A turn about z by 90 degrees maps (1, -2) to (2, 1), and two make 180 degrees.
  ExpectPose(with("room", "LHAND")[0], 0, {12, 21, 30.5, 0, 0, 1, 0});
  ExpectPose(with("room", "LHAND")[0], 1, {12, 22, 30.5, 0, 0, 1, 0});
  ExpectPose(with("door", "LHAND")[0], 0, {11, 21, 30.5, 0, 0, 1, 0});
  ExpectPose(with("cameras", "tool")[0], 0, {1, -2, 0.75, 0, 0, 1, 0});
  ExpectPose(with("room", "tool")[0], 0, {12, 21, 30.75, 0, 0, kHalf, -kHalf});
}

TEST(FrameTransforms, WhatHasNoPoseIsNamed) {
  const auto take = [](const std::string& frame, std::vector<std::string> bodies) {
    FrameTransforms transforms(frame, std::move(bodies));
    Move(transforms, "room", "base");
    Move(transforms, "base", "elbow");
    Move(transforms, "other", "thing");
    Move(transforms, "room", "wheel");
    Move(transforms, "base", "wheel");
    transforms.Add({"room", "cameras", 0, 0, kTurned}, true, "");
    std::string why;
    EXPECT_TRUE(transforms.Take("bag", why).empty());
    return why;
  };
  ExpectInputError([&] { take("room", {"elbow"}); },
                   {"bag: tf: ", "'elbow' has no pose in frame 'room'", "'base', which moves"});
  ExpectInputError([&] { take("room", {"thing"}); }, {"'other', which no static transform joins"});
  ExpectInputError([&] { take("room", {"cameras"}); }, {"'cameras' does not move"});
  ExpectInputError([&] { take("room", {"wheel"}); }, {"'wheel' has several parents"});
  EXPECT_EQ(take("rom", {}), "its tf has no frame 'rom'; did you mean 'room'?");
  EXPECT_EQ(take("xyz", {}),
            "its tf has no frame 'xyz'; it has base, cameras, elbow, other, room, thing, wheel");
  EXPECT_EQ(take("room", {"bse"}), "its tf has no frame 'bse'; did you mean 'base'?");
  EXPECT_NE(take("", {}).find("base, other, room; give the cameras' frame"), std::string::npos);
  EXPECT_NE(take("cameras", {}).find("nothing moves in frame 'cameras'"), std::string::npos);
}

TEST(FrameTransforms, StampsAreAllThereOrNone) {
  FrameTransforms none("world", {});
  Move(none, "world", "hand", 0);
  EXPECT_EQ(Taken(none)[0].stamps_ns, (std::vector<std::int64_t>{7, 8}));  // times of reception
  FrameTransforms some = none;
  Move(some, "world", "hand");
  std::string why;
  ExpectInputError([&] { some.Take("bag", why); }, {"'hand': 2 of 4 transforms have no stamp"});
}

TEST(FrameTransforms, CirclesAndRotationsThatAreNoneAreErrors) {
  FrameTransforms transforms("a", {});
  Move(transforms, "a", "hand");
  transforms.Add({"a", "b", 0, 0, kTurned}, true, "");
  transforms.Add({"b", "a", 0, 0, kTurned}, true, "");
  std::string why;
  ExpectInputError([&] { transforms.Take("bag", why); }, {"lead back"});
  ExpectInputError(
      [&] {
        transforms.Add({"b", "c", 0, 0, {}}, true, "byte 5: ");
      },
      {"byte 5: ", "'c'"});
}

}  // namespace
}  // namespace elastocal
