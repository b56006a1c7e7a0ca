// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/seen_tag.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// A camera without distortion maps planes projectively, so only rounding remains.
TEST(SeenTag, CornersOfALargerTagAreThoseThatItShows) {
  SeenTag tag;
  tag.camera = {600.0, 620.0, 320.0, 240.0};
  tag.camera_carried = tag.tag_carried = false;
  tag.p_tag_corner << -0.04, 0.04, 0.04, -0.04,  //
      -0.04, -0.04, 0.04, 0.04,                  //
      0.0, 0.0, 0.0, 0.0;
  Sight sight;
  Transform T_floor_tag = RotY(M_PI - 0.7) * RotX(0.4);
  T_floor_tag.translation() << 0.1, -0.05, 0.5;
  sight.values = {{Transform::Identity(), Eigen::VectorXd::Zero(6)},
                  {T_floor_tag, Eigen::VectorXd::Zero(6)},
                  {Transform::Identity(), Eigen::VectorXd::Zero(Camera::kNumbers)}};
  const Eigen::VectorXd seen = tag.Predict(sight);
  SeenTag larger = tag;
  larger.p_tag_corner *= 1.25;
  EXPECT_GT((larger.Predict(sight) - seen).norm(), 10.0);
  EXPECT_LT((CornersOfLargerTag(seen, 1.25) - larger.Predict(sight)).norm(), 1e-9);
  EXPECT_LT((CornersOfLargerTag(seen, 1.0) - seen).norm(), 1e-9);
}

}  // namespace
}  // namespace elastocal
