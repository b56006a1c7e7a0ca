// SPDX-License-Identifier: Apache-2.0
// Mistakes in the log of a robot with joints that motors move by rods.
#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/plain_mistakes.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/linked_biped.hpp"
#include "tests/plain_mistakes.hpp"

namespace elastocal {
namespace {

class PlainMistakesOfLinks : public LinkedBiped {
 protected:
  PlainMistakesOfLinks()
      : recorded_(MakeSyntheticRecording(model_, Truth(1), {.postures = 30, .marker_sd = 2e-4})) {}

  const Rod& Motor(int linkage, int rod) const {
    return project_.tree.linkages[Size(linkage)].rods[Size(rod)];
  }

  Recording recorded_;
};

TEST_F(PlainMistakesOfLinks, MotorsOfRods) {
  EXPECT_EQ(First(FindPlainMistakes(project_, recorded_)), "");
  const std::vector<LogSuspicion> possible = PossibleLogMistakes(recorded_, project_.tree);
  int tried = 0;
  for (const LogSuspicion& mistake : possible) {
    if (mistake.linkage < 0 || tried == 3) continue;
    // The table is refused when it is read if the mistake leaves rods that cannot close.
    Recording wrong;
    try {
      wrong = WithoutMistake(recorded_, mistake, project_.tree);
    } catch (const InputError&) {
      continue;
    }
    ++tried;
    const std::string name = NameOf(mistake, project_.tree);
    ExpectNamed(FindPlainMistakes(project_, wrong), "", "(--accept " + name + " corrects it)");
    Measurements measured;
    measured.calibration = wrong;
    AcceptMistakes(project_, {name}, measured);
    EXPECT_LT((measured.calibration.q - recorded_.q).cwiseAbs().maxCoeff(), 1e-9) << name;
  }
  EXPECT_GE(tried, 2);
}

// In trials, the markers show each joint and so each motor.
TEST_F(PlainMistakesOfLinks, MotorsOfRodsInTrials) {
  recorded_.trials = {{.name = "a", .chains = {}}};
  recorded_.trial.assign(Size(recorded_.posture_count()), 0);
  EXPECT_TRUE(FindLogSuspicions(model_, recorded_).empty());
  const RobotTree& tree = project_.tree;
  std::vector<int> all(Size(recorded_.posture_count()));
  std::iota(all.begin(), all.end(), 0);
  const LogSuspicion of_ankle = {.coordinate = 0, .linkage = 1, .postures = all};
  LogSuspicion exchanged = of_ankle;
  exchanged.kind = LogContradiction::kExchange;
  exchanged.other = 1;
  for (const LogSuspicion& mistake : {of_ankle, exchanged}) {
    const Recording wrong = WithoutMistake(recorded_, mistake, tree);
    const std::vector<LogSuspicion> found = FindLogSuspicions(model_, wrong);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(NameOf(found.front(), tree), NameOf(mistake, tree));
    EXPECT_NE(DescribeSuspicion(found.front(), tree, wrong).find("left_ankle_outer"),
              std::string::npos);
    EXPECT_LT((WithoutMistake(wrong, found.front(), tree).q - recorded_.q).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace elastocal
