// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/nocp.hpp"

#include <gtest/gtest.h>

#include "elastocal/posture/assess.hpp"
#include "elastocal/posture/certificate.hpp"
#include "elastocal/posture/exchange.hpp"
#include "elastocal/posture/ioops.hpp"
#include "tests/leg_problem.hpp"

namespace elastocal {
namespace {

PostureSet RandomSet(PostureProblem& problem, int size, std::uint64_t seed) {
  return RandomDesign(problem, size, seed).set;
}

/// Options that suffice for the small leg of these tests.
NocpOptions Quick(int max_postures = 12) {
  NocpOptions options;
  options.plateau.max_postures = max_postures;
  options.cocp = {.patience = 1, .candidates = 10};
  return options;
}

CertificateOptions QuickCertificate() { return {.starts = 4, .candidates = 50}; }

void ExpectFeasible(PostureProblem& problem, const PostureSet& set) {
  for (const Eigen::VectorXd& x : set.postures()) {
    EXPECT_LE(WorstViolation(problem.feasible, x).amount, kFeasible)
        << WorstViolation(problem.feasible, x).what;
  }
}

TEST(PartialOptim, ImprovesTheChosenPosturesOnly) {
  LegProblem leg;
  PostureSet set = RandomSet(leg.problem, 6, 1);
  const PostureSet before = set;
  EXPECT_TRUE(PartialOptim(leg.problem, {1, 4}, set));
  EXPECT_GT(set.Index(Criterion::kO1), before.Index(Criterion::kO1));
  for (int k : {0, 2, 3, 5}) EXPECT_EQ(set.posture(k), before.posture(k));
  ExpectFeasible(leg.problem, set);
}

TEST(PartialOptim, EndsWhereNoSmallStepImproves) {
  LegProblem leg;
  PostureSet set = RandomSet(leg.problem, 6, 2);
  PartialOptimOptions options;
  options.tolerance = 1e-8;
  options.max_iterations = 300;
  PartialOptim(leg.problem, {3}, set, options);
  const double best = set.Index(Criterion::kO1);
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::VectorXd x = set.posture(3) + random.NormalVector(4, 1e-3);
    if (WorstViolation(leg.problem.feasible, x).amount > 0.0) continue;
    PostureSet moved = set;
    moved.Replace(leg.problem, 3, x);
    EXPECT_LT(moved.Index(Criterion::kO1), best * (1.0 + 1e-6));
  }
}

TEST(FindWorst, BothReadingsOfAlgorithm1) {
  LegProblem leg;
  PostureSet set = RandomSet(leg.problem, 6, 3);
  set.Add(leg.problem, set.posture(0));  // a repeated posture: one of the two is worth least
  const int least = FindWorst(set, Criterion::kO1, WorstIndex::kLeastLoss);
  const int most = FindWorst(set, Criterion::kO1, WorstIndex::kAsPrinted);
  const Eigen::VectorXd without = IndicesWithoutEach(set, Criterion::kO1);
  EXPECT_EQ(without[least], without.maxCoeff());
  EXPECT_EQ(without[most], without.minCoeff());
  EXPECT_NE(FindWorst(set, Criterion::kO1, WorstIndex::kLeastLoss, {least}), least);
}

TEST(CocpStudy, TheReadingByTheTextIsBetterThanTheOneAsPrinted) {
  double by_text = 0.0, as_printed = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    LegProblem leg;
    PostureSet a = RandomSet(leg.problem, 8, seed), b = a;
    Cocp(leg.problem, a);
    Cocp(leg.problem, b, {.reading = WorstIndex::kAsPrinted});
    by_text += a.Index(Criterion::kO1);
    as_printed += b.Index(Criterion::kO1);
    EXPECT_GE(b.Index(Criterion::kO1), RandomSet(leg.problem, 8, seed).Index(Criterion::kO1));
  }
  EXPECT_GT(by_text, as_printed);
}

TEST(NocpStudy, ReachesThePlateauWithinTheBound) {
  LegProblem leg;
  const DesignResult result = Nocp(leg.problem, 1, Quick(32));
  EXPECT_EQ(result.status, DesignResult::Status::kPlateau);
  EXPECT_EQ(result.set.size(), result.sizes[result.sizes.size() - 3]);
  ExpectFeasible(leg.problem, result.set);
  const Certificate certificate = CertifyBound(leg.problem, result.set, QuickCertificate());
  const double o1 = result.set.Index(Criterion::kO1);
  EXPECT_LE(o1, certificate.bound);
  EXPECT_GT(o1, 0.97 * certificate.bound);
  EXPECT_LE(certificate.attained, certificate.bound);
}

TEST(NocpStudy, SameSeedSamePostures) {
  LegProblem a, b;
  const DesignResult first = Nocp(a.problem, 5, Quick(8)), second = Nocp(b.problem, 5, Quick(8));
  ASSERT_EQ(first.set.size(), second.set.size());
  for (int k = 0; k < first.set.size(); ++k) {
    EXPECT_EQ(first.set.posture(k), second.set.posture(k));
  }
}

TEST(NocpStudy, BeatsTheOtherAlgorithms) {
  LegProblem leg;
  NocpOptions options = Quick();
  options.plateau.tolerance = -1.0;
  const double nocp = Nocp(leg.problem, 1, options).set.Index(Criterion::kO1);
  const PostureSet random = RandomSet(leg.problem, 12, 1);
  EXPECT_GT(nocp, random.Index(Criterion::kO1));
  EXPECT_GT(nocp, ExchangeDesign(leg.problem, 12, 1, {.pool = 300}).indices[0]);
  PostureSet ioops = random;
  Ioops(leg.problem, ioops, 1);
  ExpectFeasible(leg.problem, ioops);
  EXPECT_GT(ioops.Index(Criterion::kO1), random.Index(Criterion::kO1));
}

TEST(Nocp, SaysWhichLimitLeavesNothing) {
  const ErrorModel model = MakeErrorModel(MakeLegRobot(), LegMarkers(MakeLegRobot()));
  const MotionSetup motion = LegMotion(model.tree);
  ChainSetup setup = LegSetup(model.tree);
  setup.floor_z = -0.2;
  const BaseParameters base = FindChainParameters(model, motion, setup, {});
  PostureProblem problem = MakeChainProblem(model, base.kept, motion, setup);
  const DesignResult result = Nocp(problem, 1);
  EXPECT_EQ(result.status, DesignResult::Status::kNoPosture);
  EXPECT_NE(result.blame.find("above the floor"), std::string::npos);
}

TEST(Nocp, SaysThatTheRankIsLost) {
  LegProblem leg;
  std::vector<int> all;
  for (int i = 0; i < leg.model.parameter_count(); ++i) all.push_back(i);
  PostureProblem problem = MakeChainProblem(leg.model, all, leg.motion, leg.setup);
  NocpOptions options;
  options.plateau.max_postures = 8;
  EXPECT_EQ(Nocp(problem, 1, options).status, DesignResult::Status::kRankDeficient);
}

TEST(FindPlateau, TakesTwoStillAdditionsInTurn) {
  EXPECT_EQ(FindPlateau({0.5, 0.5}, 1e-3), -1);
  EXPECT_EQ(FindPlateau({0.5, 0.6, 0.6}, 1e-3), -1);
  EXPECT_EQ(FindPlateau({0.5, 0.6, 0.6003, 0.5998}, 1e-3), 1);
  EXPECT_EQ(FindPlateau({0.5, 0.6, 0.59, 0.61, 0.6, 0.61}, 1e-3), 3);  // slow growth is no plateau
  EXPECT_EQ(FindPlateau({0.0, 0.0, 0.0}, 1e-3), -1);                   // no information yet
}

TEST(CertifyBoundStudy, HoldsForEverySetThatOtherSeedsFind) {
  LegProblem leg;
  const DesignResult design = Nocp(leg.problem, 2, Quick(8));
  const Certificate certificate = CertifyBound(leg.problem, design.set, QuickCertificate());
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    PostureSet set = RandomSet(leg.problem, 8, seed);
    Cocp(leg.problem, set);
    EXPECT_LE(set.Index(Criterion::kO1), certificate.bound);
  }
}

TEST(AssessPosturesStudy, FindsTheRepeatedPostureAndAnAddition) {
  LegProblem leg;
  PostureSet set = Nocp(leg.problem, 1, Quick()).set;
  const int size = set.size();
  set.Add(leg.problem, leg.motion.rest);
  const Assessment assessment =
      AssessPostures(leg.problem, set, {.certificate = QuickCertificate()});
  EXPECT_EQ(assessment.adds_least, size);  // the posture of rest, which no design chose
  EXPECT_GT(assessment.o1_with_addition, 0.0);
  EXPECT_LE(WorstViolation(leg.problem.feasible, assessment.best_addition).amount, kFeasible);
  EXPECT_GT(assessment.efficiency, 0.9);
  EXPECT_LT(assessment.efficiency, 1.0);
  EXPECT_TRUE(assessment.parameter_sd.allFinite());
}

TEST(AssessPostures, SaysWhatIsNotDetermined) {
  LegProblem leg;
  const PostureSet set = MakePostureSet(leg.problem, {leg.motion.rest, leg.motion.rest});
  const Assessment assessment =
      AssessPostures(leg.problem, set, {.certificate = QuickCertificate()});
  EXPECT_EQ(assessment.indices.o1, 0.0);
  EXPECT_TRUE(std::isinf(assessment.parameter_sd.maxCoeff()));
}

}  // namespace
}  // namespace elastocal
