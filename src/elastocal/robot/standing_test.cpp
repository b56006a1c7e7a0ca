// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/standing.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const Sole kLeft{.link = 1, .lower = {-0.1, -0.05}, .upper = {0.12, 0.05}};
const Sole kRight{.link = 2, .lower = {-0.1, -0.05}, .upper = {0.12, 0.05}};

TEST(SupportPolygon, OfOneSoleIsItsRectangle) {
  const Polygon polygon = SupportPolygon({kLeft}, {Offset(1, 2, 0)});
  ASSERT_EQ(polygon.cols(), 4);
  EXPECT_NEAR(InsideMargin(polygon, {1.01, 2}), 0.05, 1e-15);
  EXPECT_NEAR(InsideMargin(polygon, {1.10, 2}), 0.02, 1e-15);
  EXPECT_NEAR(InsideMargin(polygon, {1.20, 2}), -0.08, 1e-15);
}

TEST(SupportPolygon, OfTwoSolesBridgesTheGap) {
  const Polygon polygon = SupportPolygon({kLeft, kRight}, {Offset(0, 0.1, 0), Offset(0, -0.1, 0)});
  EXPECT_EQ(polygon.cols(), 4);  // a rectangle, since points on an edge are no corners
  EXPECT_NEAR(InsideMargin(polygon, {0.01, 0}), 0.11, 1e-15);
  const Polygon apart = SupportPolygon({kLeft, kRight}, {Offset(0.1, 0.1, 0), Offset(0, -0.1, 0)});
  EXPECT_EQ(apart.cols(), 6);
  // The point is inside the edge through the corners (0.22, 0.05) and (0.12, -0.15), whose slope is
  // 2.
  EXPECT_NEAR(InsideMargin(apart, {0.17 - 0.01 * std::sqrt(5.0) / 2.0, -0.05}), 0.01, 1e-12);
}

TEST(ConvexHull, HasAllPointsInsideAndItsCornersAmongThem) {
  Random random(1);
  Eigen::Matrix2Xd points(2, 40);
  for (int i = 0; i < points.cols(); ++i) points.col(i) = random.NormalVector(2, 1.0);
  const Polygon hull = ConvexHull(points);
  for (int i = 0; i < points.cols(); ++i) EXPECT_GE(InsideMargin(hull, points.col(i)), -1e-12);
  for (int i = 0; i < hull.cols(); ++i) {
    EXPECT_EQ((points.colwise() - hull.col(i)).colwise().norm().minCoeff(), 0.0);
  }
}

TEST(ZeroMomentPoint, IsWhereTheForcePresses) {
  const Vector3d force(30, -20, 700), at(0.1, -0.2, 0.0);
  const Vector2d found = ZeroMomentPoint(force, at.cross(force) + Vector3d(0, 0, 5));
  EXPECT_LT((found - at.head<2>()).norm(), 1e-15);
}

TEST(ShareWrench, AddsUpAndPressesBetweenTheFeet) {
  const std::vector<Transform> T = {Offset(0, 0.1, 0), Offset(0, -0.1, 0)};
  const Vector3d force(30, -20, 700);
  for (const double y : {0.1, 0.05, 0.0, -0.1, -0.12}) {
    const Vector3d at(0.02, y, 0.0);
    const Vector3d moment = at.cross(force) + Vector3d(0, 0, 5);
    const auto wrenches = ShareWrench({kLeft, kRight}, T, force, moment);
    ASSERT_EQ(wrenches.size(), 2u);
    EXPECT_LT((wrenches[0].force + wrenches[1].force - force).norm(), 1e-12);
    EXPECT_LT((wrenches[0].moment + wrenches[1].moment - moment).norm(), 1e-12);
    const double share = std::min(1.0, std::max(0.0, (y + 0.1) / 0.2));
    EXPECT_NEAR(wrenches[0].force.z(), share * 700, 1e-10);
    if (share > 0.0) {
      const Vector2d pressed = ZeroMomentPoint(wrenches[0].force, wrenches[0].moment);
      EXPECT_NEAR(pressed.x(), 0.02, 1e-14);
    }
  }
  EXPECT_EQ(ShareWrench({kLeft}, {T[0]}, force, force)[0].force, force);
  EXPECT_THROW(ShareWrench({}, {}, force, force), std::invalid_argument);
}

TEST(ShareWrench, OfFourFeetAddsUpAndNoFootPulls) {
  const std::vector<Eigen::Vector3d> places = {
      {0.2, 0.1, 0.02}, {0.2, -0.1, 0.02}, {-0.2, 0.1, 0.02}, {-0.2, -0.1, 0.02}};
  std::vector<Sole> soles;
  std::vector<Transform> T;
  for (std::size_t i = 0; i < 4; ++i) {
    soles.push_back({static_cast<int>(i), {0, 0}, {0, 0}, 0.02});
    T.emplace_back(Eigen::Translation3d(places[i]));
  }
  const auto share = [&](const Eigen::Vector3d& at) {
    const Eigen::Vector3d force(3.0, -2.0, 100.0), moment = at.cross(force);
    const auto wrenches = ShareWrench(soles, T, force, moment);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), turn = sum;
    for (const LinkWrench& wrench : wrenches) {
      EXPECT_GE(wrench.force.z(), -1e-9);
      sum += wrench.force;
      turn += wrench.moment;
    }
    EXPECT_LT((sum - force).norm(), 1e-9);
    EXPECT_LT((turn - moment).norm(), 1e-9);
    return wrenches;
  };
  for (const LinkWrench& wrench : share({0, 0, 0})) EXPECT_NEAR(wrench.force.z(), 25.0, 1e-9);
  // Beyond the middle of two edges, the far foot carries nothing. The lever rule gives the loads of
  // the other three.
  const auto near = share({0.15, 0.06, 0});
  EXPECT_NEAR(near[0].force.z(), 67.5, 1e-9);
  EXPECT_NEAR(near[1].force.z(), 20.0, 1e-9);
  EXPECT_NEAR(near[2].force.z(), 12.5, 1e-9);
  EXPECT_EQ(near[3].force.z(), 0.0);
}

}  // namespace
}  // namespace elastocal
