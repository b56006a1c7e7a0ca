// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/spoiling_cluster.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/mistakes/find_faults.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/loose_clusters.hpp"
#include "tests/faulty_arm.hpp"

namespace elastocal {
namespace {

class SpoilingCluster : public FaultyArm {
 protected:
  /// Moves a cluster along z during the recording.
  void Slip(const std::string& cluster, double by) {
    for (int m = 0; m < recorded_.marker_count(); ++m) {
      if (!recorded_.marker_names[Size(m)].starts_with(cluster)) continue;
      recorded_.markers.col(3 * m + 2) +=
          Eigen::VectorXd::LinSpaced(recorded_.posture_count(), 0.0, by);
    }
  }

  CalibrationResult Fit() const {
    return Calibrate(model_, recorded_, base_, kKind, project_.calibration);
  }
};

// The slip is more than half a millimetre and less than ten times the errors of the others. The
// cluster is refused because it spoils their estimates.
TEST_F(SpoilingCluster, ThatSlipsSlowlyIsRefused) {
  Slip("TOOL", 8e-3);
  Measurements measured;
  measured.calibration = recorded_;
  const ModelComparison comparison =
      CompareModels(Fit(), model_, recorded_, base_, project_.calibration);
  const auto loose = FindLooseCluster(comparison.largest(), recorded_,
                                      SeenClusters(project_, recorded_), project_.calibration);
  ASSERT_TRUE(loose);
  EXPECT_FALSE(IsTooLoose(*loose)) << Describe(*loose);
  const std::vector<std::string> said =
      FindFaults(project_, {}, measured, {model_, base_}, recorded_, comparison);
  ASSERT_EQ(said.size(), 1u);
  ExpectIn(said[0], "cluster TOOL: its markers are elsewhere");
  ExpectIn(said[0], "Without cluster TOOL the error of all other markers falls");
}

// The loose cluster has another place in each posture and so has little weight. The estimates by
// the others stay the same.
TEST_F(SpoilingCluster, ThatIsLooseAndSpoilsNothingIsKept) {
  Random random(7);
  for (int i = 0; i < recorded_.posture_count(); ++i) {
    const Eigen::RowVector3d by(random.Normal(1e-3), random.Normal(1e-3), random.Normal(1e-3));
    for (int m = 0; m < recorded_.marker_count(); ++m) {
      if (!recorded_.marker_names[Size(m)].starts_with("TOOL")) continue;
      recorded_.markers.block<1, 3>(i, 3 * m) += by;
    }
  }
  const CalibrationResult fit = Fit();
  EXPECT_TRUE(
      FindLooseCluster(fit, recorded_, SeenClusters(project_, recorded_), project_.calibration));
  EXPECT_EQ(FindSpoilingCluster(project_, {model_, base_}, recorded_, fit),
            std::vector<std::string>());
}

}  // namespace
}  // namespace elastocal
