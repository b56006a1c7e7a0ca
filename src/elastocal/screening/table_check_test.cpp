// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/table_check.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/screening/row_shift.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

/// A posture table of a biped that hangs from its root link, with errors of usual size and cameras
/// at an unknown place.
class TableCheckTest : public testing::Test {
 protected:
  TableCheckTest() : table_(robot_.Empty({{.name = "a", .chains = {}}}, 30)) {
    table_.trials.clear();
    table_.trial.clear();
    Random random(5);
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(robot_.model.parameter_count());
    for (int i = 0; i < robot_.model.parameter_count(); ++i) {
      const Parameter& parameter = robot_.model.parameters[Size(i)];
      if (parameter.kind == ParameterKind::kWaistPose || IsElastic(parameter.kind)) continue;
      truth[i] = random.Normal(parameter.unit == ParameterUnit::kRadian ? 0.01 : 2e-3);
    }
    Geometry geometry = ApplyErrors(robot_.model, truth);
    PlaceWaist(Transform(Eigen::Translation3d(3.0, -1.0, 0.4)) * RotZ(2.0) * RotX(1.0),
               Vector6d::Zero(), geometry);
    for (int i = 0; i < table_.posture_count(); ++i) {
      table_.q.row(i) = 0.8 * RandomPosture(robot_.biped.tree, random).transpose();
      table_.markers.row(i) = MarkerPositions(robot_.model, geometry, table_.q.row(i).transpose())
                                  .reshaped()
                                  .transpose();
    }
    for (const char* name : {"WAIST", "TRUNK", "LFOOT", "RFOOT"}) {
      clusters_.push_back({name, {}});
      for (int m = 0; m < robot_.model.marker_count(); ++m) {
        if (robot_.model.markers[Size(m)].name.starts_with(name)) {
          clusters_.back().markers.push_back(m);
        }
      }
    }
  }

  int Coordinate(const std::string& joint) const {
    return robot_.biped.tree.joints[Size(FindJoint(robot_.biped.tree, joint))].coordinate;
  }

  TableSuspicions Find(const Recording& table) const {
    return FindTableSuspicions(robot_.model, table, clusters_);
  }
  std::string FirstOfLog(const Recording& table) const {
    const auto found = Find(table).log;
    return found.empty() ? "" : DescribeSuspicion(found.front(), robot_.biped.tree, table);
  }
  std::string FirstOfLabels(const Recording& table) const {
    const auto found = Find(table).labels;
    return found.empty() ? "" : DescribeSuspicion(found.front(), table);
  }

  /// The table with two markers exchanged in its first `count` postures.
  Recording Exchanged(int a, int b, int count) const {
    Recording changed = table_;
    for (int i = 0; i < count; ++i) {
      changed.markers.block<1, 3>(i, 3 * a) = table_.markers.block<1, 3>(i, 3 * b);
      changed.markers.block<1, 3>(i, 3 * b) = table_.markers.block<1, 3>(i, 3 * a);
    }
    return changed;
  }

  const StandingBiped robot_ = {};
  Recording table_;
  std::vector<LabelCluster> clusters_;
};

TEST_F(TableCheckTest, NothingIsSaidOfACleanTable) {
  EXPECT_EQ(FirstOfLog(table_), "");
  EXPECT_EQ(FirstOfLabels(table_), "");
}

TEST_F(TableCheckTest, RowsThatAreShiftedAreToldAndUndone) {
  EXPECT_FALSE(FindRowShift(robot_.model, table_));
  for (const bool free_root : {false, true}) {
    for (const int from : {0, 4, 20}) {
      for (const int rows : {1, -2}) {
        Recording changed = table_;
        changed.free_root = free_root;
        for (int i = from; i < table_.posture_count(); ++i) {
          // Rows that are shifted out at one end come in at the other, where they fit as badly as
          // any other.
          const int partner = (i - rows + table_.posture_count()) % table_.posture_count();
          changed.q.row(i) = table_.q.row(partner);
        }
        const std::optional<RowShift> shift = FindRowShift(robot_.model, changed);
        ASSERT_TRUE(shift) << from << " " << rows;
        EXPECT_EQ(shift->rows, rows);
        // The row that occurs twice fits before and after this place.
        EXPECT_NEAR(shift->from, from, rows > 0 ? 1 : 0);
        const Recording undone = WithoutShift(changed, *shift);
        const auto left = static_cast<Eigen::Index>(WithoutPartner(*shift, changed).size());
        EXPECT_EQ(undone.posture_count(), table_.posture_count() - left);
        EXPECT_LE(left, 2);
        EXPECT_FALSE(FindRowShift(robot_.model, undone));
        for (int i = 0; i < undone.posture_count(); ++i) {
          Eigen::Index row = 0;
          (table_.q.rowwise() - undone.q.row(i)).rowwise().norm().minCoeff(&row);
          EXPECT_TRUE(undone.markers.row(i) == table_.markers.row(row)) << i;
        }
      }
    }
  }
}

// A robot of a tenth of the size, such as a hand, moves its markers by a tenth.
TEST_F(TableCheckTest, RowsOfASmallRobotThatAreShiftedAreTold) {
  constexpr double kScale = 0.1;
  Biped small = robot_.biped;
  for (Joint& joint : small.tree.joints) joint.T_parent_child.translation() *= kScale;
  for (Link& link : small.tree.links) link.T_body_link.translation() *= kScale;
  for (Marker& marker : small.markers) marker.p_link_marker *= kScale;
  const ErrorModel model = MakeErrorModel(small.tree, small.markers, {}, robot_.model.elasticity);
  Recording table = table_;
  Random random(6);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[Size(i)];
    if (parameter.kind == ParameterKind::kWaistPose || IsElastic(parameter.kind)) continue;
    truth[i] = random.Normal(parameter.unit == ParameterUnit::kRadian ? 0.01 : kScale * 2e-3);
  }
  const Geometry geometry = ApplyErrors(model, truth);
  for (int i = 0; i < table.posture_count(); ++i) {
    table.markers.row(i) =
        MarkerPositions(model, geometry, table.q.row(i).transpose()).reshaped().transpose();
  }
  EXPECT_FALSE(FindRowShift(model, table));
  for (const bool free_root : {false, true}) {
    Recording shifted = table;
    shifted.free_root = free_root;
    shifted.q.bottomRows(29) = table.q.topRows(29);
    const std::optional<RowShift> shift = FindRowShift(model, shifted);
    ASSERT_TRUE(shift);
    EXPECT_EQ(shift->rows, 1);
  }
}

TEST_F(TableCheckTest, AShiftOfRowsIsSaidWithItsLine) {
  EXPECT_EQ(DescribeShift({.rows = 1}, table_),
            "markers belong to the joint positions of the next row");
  EXPECT_EQ(DescribeShift({.rows = -2, .from = 4}, table_),
            "markers belong to the joint positions of 2 rows before, from posture 5 on");
  Recording read = table_;
  for (int i = 0; i < read.posture_count(); ++i) read.line.push_back(2 + i);
  EXPECT_EQ(DescribeShift({.rows = -1, .from = 4}, read),
            "markers belong to the joint positions of the row before, from line 6 on");
}

TEST_F(TableCheckTest, AReversedSignIsToldAndUndone) {
  for (const char* joint : {"left_1", "right_4"}) {
    Recording changed = table_;
    changed.q.col(Coordinate(joint)) *= -1.0;
    EXPECT_EQ(FirstOfLog(changed), std::string(joint) + ": the sign of its positions is reversed");
    EXPECT_TRUE(WithoutMistake(changed, Find(changed).log.front(), robot_.biped.tree).q ==
                table_.q);
  }
}

TEST_F(TableCheckTest, ExchangedJointsAreTold) {
  Recording changed = table_;
  changed.q.col(Coordinate("left_3")).swap(changed.q.col(Coordinate("left_4")));
  EXPECT_EQ(FirstOfLog(changed), "left_3 and left_4: their positions are exchanged");
}

// A joint may rest for some postures. It is frozen only if the markers contradict it.
TEST_F(TableCheckTest, AFrozenJointIsToldAndARestingOneIsNot) {
  const int knee = Coordinate("left_4");
  Recording changed = table_;
  changed.q.col(knee).segment(10, 8).setConstant(changed.q(10, knee));
  EXPECT_EQ(FirstOfLog(changed), "left_4: its positions are frozen, while it moved, in 8 postures");
  EXPECT_EQ(WithoutMistake(changed, Find(changed).log.front(), robot_.biped.tree).posture_count(),
            22);

  Recording rests = table_;
  rests.q.col(knee).segment(10, 8).setConstant(rests.q(10, knee));
  const Geometry nominal =
      ApplyErrors(robot_.model, Eigen::VectorXd::Zero(robot_.model.parameter_count()));
  for (int i = 0; i < rests.posture_count(); ++i) {
    rests.markers.row(i) =
        MarkerPositions(robot_.model, nominal, rests.q.row(i).transpose()).reshaped().transpose();
  }
  EXPECT_EQ(FirstOfLog(rests), "");
}

TEST_F(TableCheckTest, ExchangedLabelsAreTold) {
  const int left = clusters_[2].markers[0], right = clusters_[3].markers[1];
  EXPECT_EQ(FirstOfLabels(Exchanged(left, right, table_.posture_count())),
            "the labels of " + table_.marker_names[Size(left)] + " and " +
                table_.marker_names[Size(right)] + " are exchanged");
  Recording feet = table_;
  for (std::size_t k = 0; k < 3; ++k) {
    const int l = clusters_[2].markers[k], r = clusters_[3].markers[k];
    feet.markers.middleCols(3 * l, 3).swap(feet.markers.middleCols(3 * r, 3));
  }
  EXPECT_EQ(FirstOfLabels(feet), "the labels of LFOOT and RFOOT are exchanged");
}

TEST_F(TableCheckTest, LabelsExchangedInSomePosturesAreTold) {
  const int a = clusters_[2].markers[0], b = clusters_[2].markers[1];
  const Recording changed = Exchanged(a, b, 7);
  EXPECT_EQ(FirstOfLabels(changed), "the labels of " + table_.marker_names[Size(a)] + " and " +
                                        table_.marker_names[Size(b)] +
                                        " are exchanged in 7 postures");
  EXPECT_TRUE(WithoutExchange(changed, Find(changed).labels.front()).markers == table_.markers);
  EXPECT_EQ(FirstOfLabels(Exchanged(a, b, 2)), "");  // two of thirty are outliers
}

}  // namespace
}  // namespace elastocal
