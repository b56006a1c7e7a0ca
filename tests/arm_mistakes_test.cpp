// SPDX-License-Identifier: Apache-2.0
// Mistakes in the table of an arm that instruments see.
#include <functional>

#include "elastocal/mistakes/observed_faults.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "tests/arm_with_tracker.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TEST_F(ArmWithTracker, MistakesInTheJointsAreNamed) {
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")) *= -1.0;
  EXPECT_EQ(First(Calibrate(q))
                .find("elbow_joint: the sign of its positions is reversed (--accept "
                      "sign:elbow_joint corrects it);"),
            0u);
  q = q_;
  q.col(Coordinate("shoulder_joint")).swap(q.col(Coordinate("elbow_joint")));
  EXPECT_NE(First(Calibrate(q)).find(": their positions are exchanged (--accept exchange:"),
            std::string::npos);
  q.topRows(kPostures - 1) = q_.bottomRows(kPostures - 1);
  q.row(kPostures - 1) = q_.row(0);
  EXPECT_EQ(First(Calibrate(q))
                .find("what was observed belongs to the joint positions of the row "
                      "before (--accept rows:-1 corrects it);"),
            0u);
}

// A robot nearly explains these errors. What the fit leaves reveals them.
TEST_F(ArmWithTracker, FaultsOfTheTableAreNamed) {
  const Eigen::Index elbow = Coordinate("elbow_joint");
  Eigen::MatrixXd q = q_;
  q.col(elbow) *= 1.05;
  const std::string gain = First(Calibrate(q));
  EXPECT_EQ(gain.find("elbow_joint: its positions are 1.0"), 0u) << gain;
  // To first order, the gain would be 1.048.
  const std::string name = "--accept gain:elbow_joint=";
  ASSERT_NE(gain.find(name), std::string::npos) << gain;
  EXPECT_NEAR(std::stod(gain.substr(gain.find(name) + name.size())), 1.05, 5e-4);
  q = q_;
  q.col(elbow).tail(14).array() += 0.03;
  const std::string off = First(Calibrate(q));
  EXPECT_EQ(off.find("elbow_joint: its positions are off by 1."), 0u) << off;
  EXPECT_NE(off.find("table.csv:18 on (--accept offset:elbow_joint@table.csv:17="),
            std::string::npos)
      << off;
  q = q_;
  q.col(elbow).segment(8, 9).setConstant(q_(8, elbow));
  const std::string frozen = First(Calibrate(q));
  EXPECT_EQ(frozen.find("elbow_joint: its positions are frozen in 9 postures from "), 0u) << frozen;
  EXPECT_NE(frozen.find("table.csv:10 on, while it moved (--accept frozen:"), std::string::npos)
      << frozen;
}

// With an accepted correction, the calibration is that of the sound table.
TEST_F(ArmWithTracker, FaultsAreCorrectedOnRequest) {
  const Eigen::Index elbow = Coordinate("elbow_joint"), shoulder = Coordinate("shoulder_joint");
  const double sound = ContactRun::Judged(Calibrate(q_).calibrated).rows[0].rms;
  const auto expect_sound = [&](const Eigen::MatrixXd& q, const std::string& name) {
    const ContactRun run = Calibrate(q, {name});
    EXPECT_EQ(First(run), "") << name;
    EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 1.5 * sound) << name;
    const auto corrected = [](const std::string& warning) {
      return warning.starts_with("corrected on request: ");
    };
    EXPECT_TRUE(std::any_of(run.warnings.begin(), run.warnings.end(), corrected)) << name;
  };
  Eigen::MatrixXd q = q_;
  q.col(elbow) *= -1.0;
  expect_sound(q, "sign:elbow_joint");
  q = q_;
  q.col(elbow).swap(q.col(shoulder));
  expect_sound(q, "exchange:elbow_joint,shoulder_joint");
  q.topRows(kPostures - 1) = q_.bottomRows(kPostures - 1);
  q.row(kPostures - 1) = q_.row(0);
  expect_sound(q, "rows:-1");
  q = q_;
  q.col(elbow) *= 1.03;
  expect_sound(q, "gain:elbow_joint=1.03");
  q = q_;
  q.col(elbow).tail(14).array() += 0.03;
  expect_sound(q, "offset:elbow_joint@table.csv:17=1.71887");
  q = q_;
  q.col(elbow).segment(8, 9).setConstant(q_(8, elbow));
  expect_sound(q, "frozen:elbow_joint");
  for (Eigen::VectorXd& pose : poses_) pose.head<3>() *= 1.03;
  expect_sound(q_, "scale=1.03");
}

TEST_F(ArmWithTracker, NamesThatCorrectNothingAreRefused) {
  const auto refused = [&](const std::string& name, const std::string& why) {
    ExpectInputError([&] { Calibrate(q_, {name}); }, {"--accept " + name, why});
  };
  refused("sign:elbow", "no moving joint 'elbow'");
  refused("exchange:elbow_joint", "exchange:JOINT,JOINT was expected");
  refused("frozen:elbow_joint", "not the same in five rows");
  refused("rows:0", "rows:+1");
  refused("rows:1.5", "rows:+1");
  refused("offset:elbow_joint@other.csv=2", "in a file 'other.csv'");
  refused("offset:elbow_joint@table.csv:31=2", "no posture 31");
  refused("labels:A,B", "no instrument is called 'A'; there are: tool");
  refused("labels:tool", "labels:NAME,NAME was expected");
  refused("sign:elbow_joint@other.csv", "in a file 'other.csv'");
  refused("sign:elbow_joint@table.csv:31", "no posture 31");
  refused("sign:elbow_joint@table.csv:x", "the number of a posture");
  refused("frozen:elbow_joint@table.csv", "frozen:JOINT was expected, for all files");
  refused("knock:tool", "sign:JOINT, exchange:JOINT,JOINT");
  ExpectInputError(
      [&] {
        Calibrate(q_, {"sign:elbow_joint", "sign:elbow_joint"});
      },
      {"given twice"});
}

TEST_F(ArmWithTracker, ADriftIsNamed) {
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")) += Eigen::VectorXd::LinSpaced(kPostures, 0.0, 0.02);
  const std::string drift = First(Calibrate(q));
  EXPECT_EQ(drift.find("elbow_joint: its positions drift by 1."), 0u) << drift;
  EXPECT_NE(drift.find("deg from the first row to the last (measure again);"), std::string::npos)
      << drift;
}

TEST_F(ArmWithTracker, ABodyThatWasBumpedIsNamed) {
  const Eigen::Vector3d shift(0.003, 0.004, 0.0);
  for (std::size_t i = 15; i < poses_.size(); ++i) {
    Eigen::VectorXd& pose = poses_[i];
    pose.head<3>() += Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]) * shift;
  }
  const std::string bumped = First(Calibrate(q_));
  EXPECT_EQ(bumped.find("tool was moved on its link by some "), 0u) << bumped;
  EXPECT_NE(bumped.find("table.csv:17 (calibrate the rows before and after apart);"),
            std::string::npos)
      << bumped;
}

// On the second of two days, a joint has a wrong gain, or the tracker has a wrong scale.
TEST_F(ArmWithTracker, AFaultOfOneFileIsNamed) {
  constexpr int kFirstDay = 18;
  const auto first_of = [&](const Eigen::MatrixXd& q, const std::vector<std::string>& accept) {
    const auto first = Table(q.topRows(kFirstDay), "first.csv");
    const auto second = Table(q.bottomRows(kPostures - kFirstDay), "second.csv", kFirstDay);
    return First(CalibrateContacts(project_, {first, second}, {.folds = 5, .accept = accept}));
  };
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")).tail(kPostures - kFirstDay) *= 1.03;
  const std::string gain = first_of(q, {});
  EXPECT_EQ(gain.find("elbow_joint: its positions are 1.0"), 0u) << gain;
  EXPECT_NE(gain.find("--accept gain:elbow_joint@second.csv=1.0"), std::string::npos) << gain;
  EXPECT_EQ(first_of(q, {"gain:elbow_joint@second.csv=1.03"}), "");
  for (std::size_t i = kFirstDay; i < poses_.size(); ++i) poses_[i].head<3>() *= 1.02;
  const std::string scale = first_of(q_, {});
  EXPECT_EQ(scale.find("lengths as they were measured in "), 0u) << scale;
  EXPECT_NE(scale.find("--accept scale:second.csv=1.0"), std::string::npos) << scale;
  EXPECT_EQ(first_of(q_, {"scale:second.csv=1.02"}), "");
}

TEST_F(ArmWithTracker, ATrackerThatWasMovedIsNamed) {
  for (std::size_t i = 12; i < poses_.size(); ++i) poses_[i][1] += 0.006;
  const std::string moved = First(Calibrate(q_));
  EXPECT_EQ(moved.find("laser was moved by some "), 0u) << moved;
  EXPECT_NE(moved.find("table.csv:14 (each file is a session of its own: split"), std::string::npos)
      << moved;
}

TEST_F(ArmWithTracker, AWrongScaleIsNamed) {
  for (Eigen::VectorXd& pose : poses_) pose.head<3>() *= 1.03;
  const std::string scale = First(Calibrate(q_));
  const std::string seem = "lengths as they were measured seem ";
  ASSERT_EQ(scale.find(seem), 0u) << scale;
  // The tolerance is 0.2 %, because of the errors of the lengths.
  EXPECT_NEAR(std::stod(scale.substr(seem.size())), 1.03, 6e-3);
}

// This mistake has no name: the estimate would need parameters that no robot has.
TEST_F(ArmWithTracker, WhatNoRobotExplainsIsRefused) {
  std::reverse(poses_.begin(), poses_.end());
  const ContactRun run = Calibrate(q_);
  EXPECT_FALSE(run.deployable());
  EXPECT_NE(First(run).find("rotation of tool off by"), std::string::npos) << First(run);
}

// The mistakes begin in some row, or are in one of two files.
TEST_F(ArmWithTracker, MistakesInAPartOfTheTableAreNamed) {
  constexpr int kFrom = 14;
  const Eigen::Index elbow = Coordinate("elbow_joint"), shoulder = Coordinate("shoulder_joint");
  Eigen::MatrixXd sign = q_, exchange = q_, rows = q_;
  sign.col(elbow).tail(kPostures - kFrom) *= -1.0;
  exchange.col(elbow).tail(kPostures - kFrom) = q_.col(shoulder).tail(kPostures - kFrom);
  exchange.col(shoulder).tail(kPostures - kFrom) = q_.col(elbow).tail(kPostures - kFrom);
  rows.middleRows(kFrom + 1, kPostures - kFrom - 1) = q_.middleRows(kFrom, kPostures - kFrom - 1);
  const std::pair<Eigen::MatrixXd, std::string> mistakes[] = {
      {sign, "sign:elbow_joint@"},
      {exchange, "exchange:shoulder_joint,elbow_joint@"},
      {rows, "rows:+1@"}};
  for (const auto& [q, name] : mistakes) {
    SCOPED_TRACE(name);
    const std::string one = First(Calibrate(q));
    const std::size_t at = one.find(name + "table.csv:");
    ASSERT_NE(at, std::string::npos) << one;
    EXPECT_NEAR(std::stoi(one.substr(at + name.size() + 10)), kFrom + 1, 1) << one;
    const auto first = Table(q.topRows(kFrom), "first.csv");
    const auto second = Table(q.bottomRows(kPostures - kFrom), "second.csv", kFrom);
    const auto calibrated = [&](const std::vector<std::string>& accept) {
      return First(CalibrateContacts(project_, {first, second}, {.folds = 5, .accept = accept}));
    };
    const std::string of_file = calibrated({});
    EXPECT_NE(of_file.find("--accept " + name + "second.csv corrects it"), std::string::npos)
        << of_file;
    EXPECT_EQ(calibrated({name + "second.csv"}), "");
  }
}

/// A tracker sees one body on the arm's tool and one on its forearm.
class ArmWithTwoBodies : public ArmWithTracker {
 protected:
  ArmWithTwoBodies() {
    std::ofstream(folder_.path() / "bodies.yaml")
        << "robot: {urdf: " << SourceFile("tests/robots/arm6.urdf").string() << "}\n"
        << "instruments:\n"
           "  trackers: [{name: laser}]\n"
           "  poses:\n"
           "    - {name: tool, link: tool, tracker: laser, xyz_mm: [30, 10, 20], rpy_deg: [5, 3, "
           "-4], mounting_sd_mm: 2, mounting_sd_deg: 2}\n"
           "    - {name: arm, link: forearm, tracker: laser, xyz_mm: [0, 60, 10], rpy_deg: [9, 3, "
           "40], mounting_sd_mm: 2, mounting_sd_deg: 2}\n";
    project_ = ReadProject(folder_.path() / "bodies.yaml");
    model_ = MakeObservedRobot(project_.tree, project_.placement, project_.contact->setup, {}, {});
    ObservedValues truth = truth_;
    truth.quantities.clear();
    for (const Quantity& quantity : model_.setup.quantities) {
      truth.quantities.push_back({quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
    }
    seen_ = WithEveryInstrument(model_, q_);
    const auto sights = SightsOf(model_, seen_, truth, ObservedLoads(model_, seen_, truth.robot));
    for (std::size_t i = 0; i < sights.size(); ++i) {
      Observation& of = seen_.all[i];
      of.measured = model_.instrument(of.instrument).Predict(sights[i]);
    }
  }

  std::string MistakeOf(const std::function<void(Observation&)>& spoil) const {
    Observations spoilt = seen_;
    for (Observation& of : spoilt.all) spoil(of);
    const std::vector<std::string> found = FindObservedMistakes(model_, spoilt);
    return found.empty() ? "" : found.front();
  }

  Observations seen_;
};

// Only one of the rows is wrong. Otherwise "rows:-2", which drops it, would explain as much.
TEST_F(ArmWithTwoBodies, ARowThatContradictsAllOthersIsNamed) {
  const std::string found = MistakeOf([](Observation& of) {
    if (of.posture == kPostures - 1) of.measured[0] += 0.3;
  });
  EXPECT_EQ(found.find("table.csv:" + std::to_string(kPostures + 1) +
                       ": what the row shows contradicts all others"),
            0u)
      << found;
}

TEST_F(ArmWithTwoBodies, OtherConventionsAreNamed) {
  EXPECT_EQ(MistakeOf([](Observation&) {}), "");
  EXPECT_EQ(MistakeOf([&](Observation& of) {
              const Eigen::Vector4d xyzw = of.measured.tail<4>();
              of.measured.tail<4>() << xyzw[3], xyzw.head<3>();
            }),
            "w comes first in the quaternions of bodies: x, y, z, w was expected");
  EXPECT_EQ(MistakeOf([](Observation& of) {
              of.measured.segment<3>(3) *= -1.0;
            }).find("the attitudes of bodies are those of the tracker in the body: "),
            0u);
  EXPECT_EQ(MistakeOf([](Observation& of) {
              of.measured.segment<3>(3) *= -1.0;
              const Eigen::Quaterniond back(Eigen::Vector4d(of.measured.tail<4>()));
              of.measured.head<3>() = -(back * of.measured.head<3>().eval());
            }).find("the poses of bodies are those of the tracker in the body: "),
            0u);
  EXPECT_EQ(MistakeOf([](Observation& of) {
              of.measured[2] *= -1.0;
              of.measured.segment<2>(3) *= -1.0;
            }).find("one axis of the tracker is reversed: "),
            0u);
  EXPECT_EQ(MistakeOf([](Observation& of) {
              of.measured[1] *= -1.0;
            }).find("y of the positions of bodies is reversed, but not in their attitudes: "),
            0u);
}

TEST_F(ArmWithTwoBodies, AnotherConventionOfOneBodyIsNamed) {
  EXPECT_EQ(MistakeOf([](Observation& of) {
              if (of.instrument != 1) return;
              const Eigen::Vector4d xyzw = of.measured.tail<4>();
              of.measured.tail<4>() << xyzw[3], xyzw.head<3>();
            }),
            "w comes first in the quaternions of bodies (arm alone): x, y, z, w was expected");
}

// Apart from the robot's own lengths, only a height gauge tells a length.
TEST_F(ArmWithTracker, MistakesOfAGaugeAreNamed) {
  const Project project = ParseProject(
      "robot: {urdf: " + SourceFile("tests/robots/arm6.urdf").string() +
          "}\nrecording: {not_recorded_mm: {finger_left_joint: 10}}\ninstruments:\n"
          "  planes: [{name: floor}]\n  distances: [{name: gauge, link: tool, plane: floor, "
          "point_mm: [10, 0, 80]}]\n  inertial_units: [{name: imu, link: flange, rpy_deg: [10, 0, "
          "90], mounting_sd_deg: 5}]\n",
      (folder_.path() / "gauge.yaml").string());
  const ObservedRobot model =
      MakeObservedRobot(project.tree, project.placement, project.contact->setup, {}, {});
  ObservedValues truth;
  truth.robot = truth_.robot;
  for (const Quantity& quantity : model.setup.quantities) {
    truth.quantities.push_back({quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
  }
  Observations seen;
  seen.files = {"table.csv"};
  seen.q = q_;
  for (int i = 0; i < kPostures; ++i) {
    seen.postures.push_back({0, i + 2});
    for (int k = 0; k < 2; ++k) seen.all.push_back({i, k, {}, {}});
  }
  Random random(5);
  const auto sights = SightsOf(model, seen, truth, ObservedLoads(model, seen, truth.robot));
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Instrument& instrument = model.instrument(seen.all[i].instrument);
    const Eigen::VectorXd shown = instrument.Predict(sights[i]);
    const double noise = shown.size() == 1 ? 5e-5 : 0.01;
    seen.all[i].measured = shown + random.NormalVector(static_cast<int>(shown.size()), noise);
  }
  const auto with = [&](double factor) {
    Observations spoilt = seen;
    for (Observation& of : spoilt.all) {
      if (of.measured.size() == 1) of.measured *= factor;
    }
    return spoilt;
  };
  const auto fault_of = [&](const Observations& of) {
    return FindObservedFault(model, of, EstimateObserved(model, of, {}).fit);
  };
  EXPECT_EQ(fault_of(seen), "");
  const std::string scale = fault_of(with(1.03));
  EXPECT_EQ(scale.find("lengths as they were measured seem 1.0"), 0u) << scale;
  const auto sign = FindObservedMistakes(model, with(-1.0));
  ASSERT_EQ(sign.size(), 1u);
  EXPECT_EQ(sign[0].find("heights have the opposite sign: "), 0u) << sign[0];
  EXPECT_EQ(FindObservedMistakes(model, with(1.0 / 0.0254)),
            std::vector<std::string>{"heights are in inches: m was expected"});
}

TEST_F(ArmWithTwoBodies, ExchangedLabelsAreNamed) {
  EXPECT_EQ(MistakeOf([](Observation& of) { of.instrument = 1 - of.instrument; }),
            "tool and arm: what they measured is exchanged (--accept labels:tool,arm corrects it)");
}

}  // namespace
}  // namespace elastocal
