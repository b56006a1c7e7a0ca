// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/labels.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

constexpr double kNoise = 0.2e-3;  // m, noise of the cameras

// A cluster with markers at `places` (3 x markers, m) that turns and moves, at 100 Hz.
MarkerTrajectories Move(const Eigen::Matrix3Xd& places, int frames) {
  MarkerTrajectories trajectories;
  trajectories.rate_hz = 100.0;
  trajectories.names.resize(static_cast<std::size_t>(places.cols()), "m");
  trajectories.positions.resize(frames, 3 * places.cols());
  Random random(17);
  for (int frame = 0; frame < frames; ++frame) {
    const double t = 0.01 * frame;
    const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(std::sin(t), Eigen::Vector3d::UnitX()) *
                                      Eigen::AngleAxisd(0.7 * t, Eigen::Vector3d::UnitZ()))
                                         .toRotationMatrix();
    const Eigen::Vector3d middle(0.3 * std::cos(t), 0.2 * t, 1.0);
    for (Eigen::Index m = 0; m < places.cols(); ++m) {
      const Eigen::Vector3d position =
          rotation * places.col(m) + middle + random.NormalVector(3, kNoise);
      trajectories.positions.block<1, 3>(frame, 3 * m) = position.transpose();
    }
  }
  return trajectories;
}

// Sides of 60, 71 and 85 mm.
Eigen::Matrix3Xd Triangle() {
  Eigen::Matrix3Xd places(3, 3);
  places << 0.0, 0.060, 0.055, 0.0, 0.0, 0.0645, 0.0, 0.0, 0.0295;
  return places;
}

void Exchange(MarkerTrajectories& trajectories, int a, int b, FrameInterval frames) {
  auto first = trajectories.positions.block(frames.begin, 3 * a, frames.size(), 3);
  auto second = trajectories.positions.block(frames.begin, 3 * b, frames.size(), 3);
  const Eigen::MatrixXd kept = first;
  first = second;
  second = kept;
}

void HideFrames(MarkerTrajectories& trajectories, int marker, FrameInterval frames) {
  trajectories.positions.block(frames.begin, 3 * marker, frames.size(), 3).setConstant(kNaN);
}

// Compares positions exactly, with NaN equal to NaN.
void ExpectSame(const MarkerTrajectories& found, const MarkerTrajectories& expected) {
  int different = 0;
  for (Eigen::Index i = 0; i < found.positions.size(); ++i) {
    const double a = found.positions.data()[i];
    const double b = expected.positions.data()[i];
    different += !(a == b || (std::isnan(a) && std::isnan(b)));
  }
  EXPECT_EQ(different, 0);
}

const std::vector<LabelCluster> kThree{{"wrist", {0, 1, 2}}};

/// The distances that other trials show.
LabelOptions Usual() {
  return {.usual = {{{"a", "b"}, 0.0600}, {{"a", "c"}, 0.0897}, {{"b", "c"}, 0.0711}}};
}

MarkerTrajectories MoveNamed(int frames) {
  MarkerTrajectories trajectories = Move(Triangle(), frames);
  trajectories.names = {"a", "b", "c"};
  return trajectories;
}

TEST(CorrectLabels, OtherTrialsTellWhichPartOfATrialIsExchanged) {
  const MarkerTrajectories truth = MoveNamed(3000);
  for (const FrameInterval wrong : {FrameInterval{0, 2000}, FrameInterval{0, 3000}}) {
    MarkerTrajectories trajectories = truth;
    Exchange(trajectories, 0, 1, wrong);
    const auto labels = CorrectLabels(kThree, Usual(), trajectories);
    ASSERT_EQ(labels[0].swaps.size(), 1u);
    EXPECT_EQ(labels[0].swaps[0].frames, wrong);
    ExpectSame(trajectories, truth);
  }
}

TEST(CorrectLabels, OtherTrialsTellWhichPartOfATrialHasADisplacedMarker) {
  const MarkerTrajectories truth = MoveNamed(3000);
  for (const int begin : {1000, 0}) {
    MarkerTrajectories trajectories = truth;
    for (int frame = begin; frame < 3000; ++frame) {
      const Eigen::RowVector3d along =
          (truth.positions.block<1, 3>(frame, 3) - truth.positions.block<1, 3>(frame, 0))
              .normalized();
      trajectories.positions.block<1, 3>(frame, 0) -= 0.008 * along;
    }
    const auto labels = CorrectLabels(kThree, Usual(), trajectories);
    EXPECT_TRUE(labels[0].swaps.empty());
    if (begin == 0) {  // unlike the other trials, but the same throughout this one
      EXPECT_TRUE(labels[0].outliers.empty());
      EXPECT_NEAR(labels[0].distances[0], 0.068, 1e-4);
      continue;
    }
    ASSERT_EQ(labels[0].outliers.size(), 1u);
    EXPECT_EQ(labels[0].outliers[0].marker, 0);
    EXPECT_EQ(labels[0].outliers[0].frames, (FrameInterval{begin, 3000}));
  }
}

TEST(CorrectLabels, LeavesACleanClusterAlone) {
  MarkerTrajectories trajectories = Move(Triangle(), 3000);
  const MarkerTrajectories truth = trajectories;
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_FALSE(labels[0].ambiguous);
  EXPECT_TRUE(labels[0].swaps.empty() && labels[0].outliers.empty());
  ExpectSame(trajectories, truth);
  EXPECT_NEAR(labels[0].distances[0], 0.060, 2e-5);  // noise of 0.28 mm / sqrt(3000) is 0.005 mm
  // The tolerance is six times sqrt(2) times 0.2 mm. The median of 3000 frames is known to 3 %.
  EXPECT_NEAR(labels[0].tolerances[0], 1.70e-3, 0.15e-3);
}

TEST(CorrectLabels, UndoesExchangesForTwentySeconds) {
  MarkerTrajectories trajectories = Move(Triangle(), 6000);
  const MarkerTrajectories truth = trajectories;
  Exchange(trajectories, 0, 2, {1000, 3000});
  // The labels of all three markers are exchanged in a cycle.
  Exchange(trajectories, 0, 1, {4000, 4100});
  Exchange(trajectories, 1, 2, {4000, 4100});
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  ExpectSame(trajectories, truth);
  ASSERT_EQ(labels[0].swaps.size(), 2u);
  EXPECT_EQ(labels[0].swaps[0].frames, (FrameInterval{1000, 3000}));
  EXPECT_EQ(labels[0].swaps[0].permutation, (Permutation{2, 1, 0}));
  EXPECT_EQ(labels[0].swaps[1].frames, (FrameInterval{4000, 4100}));
  EXPECT_EQ(labels[0].swaps[1].permutation, (Permutation{2, 0, 1}));
}

TEST(CorrectLabels, CarriesAnExchangeThroughHiddenMarkers) {
  MarkerTrajectories trajectories = Move(Triangle(), 3000);
  HideFrames(trajectories, 1,
             {1200, 1300});  // the remaining distance is the same under the exchange
  HideFrames(trajectories, 0, {1500, 1550});
  HideFrames(trajectories, 2, {1520, 1530});  // leaves one marker
  HideFrames(trajectories, 0, {2200, 2210});  // outside the exchange
  const MarkerTrajectories truth = trajectories;
  Exchange(trajectories, 0, 2, {1000, 2000});
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  ExpectSame(trajectories, truth);
  ASSERT_EQ(labels[0].swaps.size(), 1u);
  EXPECT_EQ(labels[0].swaps[0].frames, (FrameInterval{1000, 2000}));
}

TEST(CorrectLabels, RemovesOutliersAlsoWithinAnExchange) {
  MarkerTrajectories trajectories = Move(Triangle(), 3000);
  MarkerTrajectories truth = trajectories;
  for (const int frame : {100, 101, 1500, 2900}) {
    const int marker = frame == 2900 ? 2 : 1;
    // The marker moves away from both others, so that it alone is to blame.
    const Eigen::RowVector3d away = 2.0 * trajectories.positions.block<1, 3>(frame, 3 * marker) -
                                    trajectories.positions.block<1, 3>(frame, 0) -
                                    trajectories.positions.block<1, 3>(frame, marker == 1 ? 6 : 3);
    trajectories.positions.block<1, 3>(frame, 3 * marker) += 0.01 * away.normalized();
    HideFrames(truth, marker, {frame, frame + 1});
  }
  Exchange(trajectories, 0, 2, {1000, 2000});
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  ExpectSame(trajectories, truth);
  ASSERT_EQ(labels[0].outliers.size(), 3u);
  EXPECT_EQ(labels[0].outliers[0].frames, (FrameInterval{100, 102}));
  EXPECT_EQ(labels[0].outliers[0].marker, 1);
  EXPECT_EQ(labels[0].outliers[2].marker, 2);
  ASSERT_EQ(labels[0].swaps.size(), 1u);
}

TEST(CorrectLabels, RemovesAClusterThatNothingExplains) {
  MarkerTrajectories trajectories = Move(Triangle(), 1000);
  trajectories.positions.row(500) *= 1.2;
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  EXPECT_EQ(labels[0].outliers.size(), 3u);
  EXPECT_TRUE(trajectories.positions.row(500).array().isNaN().all());
  EXPECT_TRUE(trajectories.positions.row(499).allFinite());
}

TEST(CorrectLabels, RemovesWhatItCannotPutRight) {
  Eigen::Matrix3Xd places = Triangle();
  places.col(2) << 0.030, 0.0645, 0.0295;  // isosceles: exchanging 0 and 1 changes no distance
  MarkerTrajectories trajectories = Move(places, 2000);
  Exchange(trajectories, 0, 2, {500, 600});
  Exchange(trajectories, 0, 1, {800, 900});  // only jumps show this exchange
  HideFrames(trajectories, 2, {850, 860});
  MarkerTrajectories expected = trajectories;
  expected.positions.middleRows(500, 100).setConstant(kNaN);
  expected.positions.middleRows(800, 100).setConstant(kNaN);
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  EXPECT_TRUE(labels[0].ambiguous);
  EXPECT_TRUE(labels[0].swaps.empty() && labels[0].outliers.empty());
  EXPECT_EQ(labels[0].undecided, (std::vector<FrameInterval>{{500, 600}, {800, 900}}));
  ExpectSame(trajectories, expected);

  // Outliers of the cluster are still removed.
  trajectories.positions(1500, 8) += 0.05;
  EXPECT_FALSE(CorrectLabels(kThree, {}, trajectories)[0].outliers.empty());
  EXPECT_TRUE(std::isnan(trajectories.positions(1500, 8)));
}

TEST(CorrectLabels, LeavesAJumpWithoutAWayBack) {
  MarkerTrajectories trajectories = Move(Triangle().leftCols(2), 2000);
  Exchange(trajectories, 0, 1, {800, 1100});  // 3 s: either part may be the exchanged one
  const MarkerTrajectories given = trajectories;
  const auto labels = CorrectLabels({{"two", {0, 1}}}, {}, trajectories);
  EXPECT_TRUE(labels[0].undecided.empty());
  ExpectSame(trajectories, given);
}

TEST(CorrectLabels, TakesClustersOfAnySize) {
  Random random(23);
  for (const int size : {1, 2, 4, 5, 7}) {
    Eigen::Matrix3Xd places(3, size);
    for (double& value : places.reshaped()) value = random.Uniform(-0.1, 0.1);
    MarkerTrajectories trajectories = Move(places, 1000);
    const MarkerTrajectories truth = trajectories;
    LabelCluster cluster{"c", {}};
    for (int m = 0; m < size; ++m) cluster.markers.push_back(m);
    if (size > 2) Exchange(trajectories, 0, size - 1, {300, 500});
    const auto labels = CorrectLabels({cluster}, {}, trajectories);
    EXPECT_EQ(labels[0].ambiguous, size <= 2) << size;
    EXPECT_EQ(labels[0].swaps.size(), size > 2 ? 1u : 0u) << size;
    ExpectSame(trajectories, truth);
  }
}

TEST(CorrectLabels, FindsTheShapeThoughAMarkerWasLostOrKnocked) {
  MarkerTrajectories trajectories = Move(Triangle(), 4000);
  HideFrames(trajectories, 0, {0, 2000});
  MarkerTrajectories truth = trajectories;
  Exchange(trajectories, 1, 2, {3000, 3200});
  CorrectLabels(kThree, {}, trajectories);
  ExpectSame(trajectories, truth);

  // The marker is knocked off by a centimetre for nearly half of the time in which marker 0 is seen
  // too.
  for (int frame = 3010; frame < 4000; ++frame) {
    const Eigen::RowVector3d away = 2.0 * trajectories.positions.block<1, 3>(frame, 3) -
                                    trajectories.positions.block<1, 3>(frame, 0) -
                                    trajectories.positions.block<1, 3>(frame, 6);
    trajectories.positions.block<1, 3>(frame, 3) += 0.01 * away.normalized();
  }
  const auto labels = CorrectLabels(kThree, {}, trajectories);
  ASSERT_EQ(labels[0].outliers.size(), 1u);
  EXPECT_EQ(labels[0].outliers[0].frames, (FrameInterval{3010, 4000}));
  EXPECT_EQ(labels[0].outliers[0].marker, 1);
}

// If two limbs' markers have each other's labels, neither fits its cluster, except by chance. A
// single marker that does not fit was displaced and is right up to then.
TEST(CorrectLabels, TwoMarkersThatAreOffMostOfTheTimeAreOffAllTheTime) {
  const auto left = [](int fitting_a, int fitting_d) {
    MarkerTrajectories trajectories = MoveNamed(1000);
    trajectories.names = {"a", "b", "c", "d", "e", "f"};
    trajectories.positions.conservativeResize(1000, 18);
    trajectories.positions.rightCols(9) = trajectories.positions.leftCols(9);
    LabelOptions usual = Usual();
    usual.usual.insert({{{"d", "e"}, 0.0600}, {{"d", "f"}, 0.0897}, {{"e", "f"}, 0.0711}});
    trajectories.positions.block(fitting_a, 0, 1000 - fitting_a, 3).array() += 0.05;
    trajectories.positions.block(fitting_d, 9, 1000 - fitting_d, 3).array() += 0.05;
    CorrectLabels({{"wrist", {0, 1, 2}}, {"knee", {3, 4, 5}}}, usual, trajectories);
    const auto seen = [&](int m) {
      return 1000 - trajectories.positions.col(3 * m).array().isNaN().count();
    };
    return std::pair(seen(0), seen(3));
  };
  EXPECT_EQ(left(300, 400), std::pair(0L, 0L));
  EXPECT_EQ(left(300, 1000), std::pair(300L, 1000L));
  EXPECT_EQ(left(300, 700), std::pair(300L, 700L));
}

TEST(CorrectLabels, RefusesWrongClusters) {
  MarkerTrajectories trajectories = Move(Triangle(), 10);
  EXPECT_THROW(CorrectLabels({{"c", {0, 3}}}, {}, trajectories), std::invalid_argument);
  EXPECT_THROW(CorrectLabels({{"c", {0, 1, 0}}}, {}, trajectories), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
