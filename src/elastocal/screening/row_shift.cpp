// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/row_shift.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kMisplaced = 0.02;        // m: beyond errors of a robot and of markers
constexpr double kMisplacedShare = 0.015;  // share of the robot's size, if that is smaller
constexpr double kLeftUnshifted = 0.6;     // largest share of the misfit that is left
constexpr int kMostShifted = 3;            // rows
constexpr int kLeastShiftedRows = 4;
constexpr int kMostSearched = 2000;  // rows of a long table that are searched, its first ones

/// The table with the nominal markers of each row.
class ShiftSearch {
 public:
  ShiftSearch(const ErrorModel& model, const Recording& recording)
      : recording_(recording),
        rows_(std::min(recording.posture_count(), kMostSearched)),
        misplaced_(std::min(kMisplaced, kMisplacedShare * RobotSize(model.tree))) {
    ErrorModel at_origin = model;
    at_origin.T_ref_waist = Transform::Identity();
    const Geometry geometry =
        ApplyErrors(at_origin, Eigen::VectorXd::Zero(at_origin.parameter_count()));
    for (int i = 0; i < rows_; ++i) {
      InterruptionPoint();
      nominal_.push_back(MarkerPositions(at_origin, geometry, recording.q.row(i).transpose()));
    }
  }

  std::optional<RowShift> Best() const {
    std::optional<RowShift> best;
    if (rows_ < 2 * kLeastShiftedRows) return best;
    const int last_quarter = rows_ - std::max(rows_ / 4, kLeastShiftedRows);
    if (Typical(Errors(last_quarter, 0, Place(last_quarter, 0))) <= misplaced_) return best;
    for (int rows = -kMostShifted; rows <= kMostShifted; ++rows) {
      if (rows == 0) continue;
      for (const int begin : {0, rows_ / 4, rows_ / 2, last_quarter}) {
        const std::optional<RowShift> shift = Try(begin, rows);
        if (shift && (!best || shift->after < best->after)) best = shift;
      }
    }
    return best;
  }

 private:
  bool HasPartner(int row, int shifted) const {
    return row + shifted >= 0 && row + shifted < rows_;
  }

  /// Pose of the root link by the rows from `begin` on; nothing for a free root.
  std::optional<Transform> Place(int begin, int shifted) const {
    if (recording_.free_root) return std::nullopt;
    return PlaceBy(begin, rows_, shifted);
  }

  std::optional<Transform> PlaceBy(int begin, int end, int shifted) const {
    std::vector<Eigen::Vector3d> nominal, measured;
    for (int i = begin; i < end; ++i) {
      if (!HasPartner(i, shifted)) continue;
      for (int m = 0; m < recording_.marker_count(); ++m) {
        if (!Seen(recording_, i, m)) continue;
        nominal.emplace_back(nominal_[Size(i + shifted)].col(m));
        measured.push_back(MarkerPosition(recording_, i, m));
      }
    }
    return FitRigid(nominal, measured);
  }

  /// Distance of the markers of a row from the nominal ones of its partner, median, m; NaN where it
  /// is unknown.
  double Error(int row, int shifted, const std::optional<Transform>& T_ref_root) const {
    if (!HasPartner(row, shifted)) return std::nan("");
    const auto T = recording_.free_root ? PlaceBy(row, row + 1, shifted) : T_ref_root;
    if (!T) return std::nan("");
    std::vector<double> distances;
    for (int m = 0; m < recording_.marker_count(); ++m) {
      if (!Seen(recording_, row, m)) continue;
      const Eigen::Vector3d nominal = nominal_[Size(row + shifted)].col(m);
      distances.push_back((*T * nominal - MarkerPosition(recording_, row, m)).norm());
    }
    return Median(distances);
  }

  std::vector<double> Errors(int begin, int shifted,
                             const std::optional<Transform>& T_ref_root) const {
    std::vector<double> errors;
    for (int i = begin; i < rows_; ++i) errors.push_back(Error(i, shifted, T_ref_root));
    return errors;
  }

  /// Median of the known values; NaN where there is none.
  static double Typical(const std::vector<double>& errors) {
    std::vector<double> told;
    std::copy_if(errors.begin(), errors.end(), std::back_inserter(told),
                 [](double error) { return std::isfinite(error); });
    return Median(told);
  }

  /// The shift by `rows` rows, if the rows from `begin` on place the root link.
  std::optional<RowShift> Try(int begin, int rows) const {
    const std::optional<Transform> T_ref_root = Place(begin, rows);
    const std::vector<double> as_is = Errors(0, 0, T_ref_root);
    const std::vector<double> shifted = Errors(0, rows, T_ref_root);
    RowShift shift{.rows = rows, .from = FirstShifted(as_is, shifted)};
    if (rows_ - shift.from < kLeastShiftedRows) return std::nullopt;
    shift.before = Typical({as_is.begin() + shift.from, as_is.end()});
    shift.after = Typical({shifted.begin() + shift.from, shifted.end()});
    const double head = Typical({as_is.begin(), as_is.begin() + shift.from});
    if (!(shift.before > misplaced_) || !(shift.after <= kLeftUnshifted * shift.before) ||
        head > kLeftUnshifted * shift.before) {
      return std::nullopt;
    }
    return shift;
  }

  /// The row at which the sum of errors (unshifted before it, shifted from it on) is smallest;
  /// before it also the rows that fit neither way, whose joints are the lost ones.
  int FirstShifted(const std::vector<double>& as_is, const std::vector<double>& shifted) const {
    double sum = 0.0, least = 0.0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < as_is.size(); ++i) {
      if (std::isfinite(as_is[i]) && std::isfinite(shifted[i])) sum += as_is[i] - shifted[i];
      if (sum < least) {
        least = sum;
        first = i + 1;
      }
    }
    while (first > 0 && as_is[first - 1] > misplaced_) --first;
    return static_cast<int>(first);
  }

  const Recording& recording_;
  int rows_;
  double misplaced_;  ///< m
  /// Nominal markers in the root link's frame, by the joints of each row.
  std::vector<Eigen::Matrix3Xd> nominal_;
};

}  // namespace

std::optional<RowShift> FindRowShift(const ErrorModel& model, const Recording& recording) {
  if (!recording.trials.empty()) return std::nullopt;
  return ShiftSearch(model, recording).Best();
}

std::vector<int> WithoutPartner(const RowShift& shift, const Recording& recording) {
  std::vector<int> alone;
  for (int i = shift.from; i < recording.posture_count(); ++i) {
    const int partner = i + shift.rows;
    if (partner < shift.from || partner >= recording.posture_count()) alone.push_back(i);
  }
  return alone;
}

Recording WithoutShift(const Recording& recording, const RowShift& shift) {
  const std::vector<int> alone = WithoutPartner(shift, recording);
  std::vector<int> markers, joints;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (std::binary_search(alone.begin(), alone.end(), i)) continue;
    markers.push_back(i);
    joints.push_back(i < shift.from ? i : i + shift.rows);
  }
  Recording corrected = SelectPostures(recording, markers);
  corrected.q = recording.q(joints, Eigen::all);
  if (recording.torques.rows() > 0) corrected.torques = recording.torques(joints, Eigen::all);
  if (recording.wrenches.rows() > 0) corrected.wrenches = recording.wrenches(joints, Eigen::all);
  if (recording.approach.rows() > 0) corrected.approach = recording.approach(joints, Eigen::all);
  return corrected;
}

std::string DescribeShift(const RowShift& shift, const Recording& recording) {
  const int rows = std::abs(shift.rows);
  std::string text = "markers belong to the joint positions of ";
  text += rows == 1 ? (shift.rows > 0 ? "the next row" : "the row before")
                    : std::to_string(rows) + " rows " + (shift.rows > 0 ? "further" : "before");
  if (shift.from == 0) return text;
  return text + ", from " +
         (recording.line.empty()
              ? "posture " + std::to_string(shift.from + 1)
              : "line " + std::to_string(recording.line[static_cast<std::size_t>(shift.from)])) +
         " on";
}

}  // namespace elastocal
