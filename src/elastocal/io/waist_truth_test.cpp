// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/waist_truth.hpp"

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

TEST(WaistTruth, ReadsBackWhatItWrote) {
  const ScratchFolder scratch;
  WaistTruth truth;
  truth.time_s = Eigen::Vector3d(0.0, 0.01, 0.02);
  for (double angle : {0.1, 1.7, 3.1}) {
    truth.T_camera_waist.push_back(FromXyzRpy({0.3 * angle, -1.0, 0.98}, {angle, -0.4, 2.0}));
  }
  WriteWaistTruth(scratch.path() / "waist.csv", truth);
  const WaistTruth read = ReadWaistTruth(scratch.path() / "waist.csv");
  EXPECT_EQ(read.time_s, truth.time_s);
  ASSERT_EQ(read.T_camera_waist.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(
        (read.T_camera_waist[i].matrix() - truth.T_camera_waist[i].matrix()).cwiseAbs().maxCoeff(),
        1e-15);
  }
}

TEST(WaistTruth, RefusesWhatIsNone) {
  const ScratchFolder scratch;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    const std::string file = scratch.Write("waist.csv", text);
    ExpectInputError([&] { ReadWaistTruth(file); }, parts);
  };
  refused("t,x,y,z\n", {"waist.csv", "t,x,y,z,qw,qx,qy,qz"});
  refused("t,x,y,z,qw,qx,qy,qz\n0,1,2\n", {"waist.csv:2", "3 cells"});
  refused("t,x,y,z,qw,qx,qy,qz\n0,1,2,3,1,0,0,a\n", {"waist.csv:2", "qz"});
  refused("t,x,y,z,qw,qx,qy,qz\n0,1,2,3,1,1,0,0\n", {"waist.csv:2", "unit length"});
}

}  // namespace
}  // namespace elastocal
