// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/observations.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Eigenvalues>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

constexpr double kLeastLever = 1e-4;  // m: markers closer to a line tell no rotation about it

Eigen::Matrix3Xd Positions(const Recording& recording, int posture,
                           const std::vector<int>& markers) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t k = 0; k < markers.size(); ++k) {
    positions.col(static_cast<Eigen::Index>(k)) = MarkerPosition(recording, posture, markers[k]);
  }
  return positions;
}

}  // namespace

ObservationMask SeenMask(const Recording& recording) {
  ObservationMask mask(recording.posture_count(), recording.marker_count());
  for (int i = 0; i < mask.rows(); ++i) {
    for (int m = 0; m < mask.cols(); ++m) mask(i, m) = Seen(recording, i, m);
  }
  return mask;
}

Eigen::ArrayXd BodyObservation::Variances(const Noise& noise, int group) const {
  return noise.Variance(group, NoiseSource::kMarker) +
         noise.Variance(group, NoiseSource::kBodyPosition) * by_position;
}

Eigen::ArrayXd BodyObservation::Shares(const Noise& noise, int group, NoiseSource source) const {
  const Eigen::ArrayXd all = Variances(noise, group);
  const double variance = noise.Variance(group, source);
  if (source == NoiseSource::kMarker) return variance / all;
  if (source == NoiseSource::kBodyPosition) return variance * by_position / all;
  return Eigen::ArrayXd::Zero(all.size());
}

Eigen::ArrayXd BodyObservation::Counts(const Noise& noise, int group, double samples_each) const {
  return 1.0 / (1.0 + (samples_each - 1.0) * Shares(noise, group, NoiseSource::kBodyPosition));
}

BodyObservation MakeBodyObservation(int posture, int body, std::vector<int> markers,
                                    const Eigen::Matrix3Xd& positions) {
  const Eigen::Index count = positions.cols();
  BodyObservation observation;
  observation.posture = posture;
  observation.body = body;
  observation.markers = std::move(markers);
  const Eigen::Index size = 3 * count;
  observation.by_position.setZero(size);
  observation.by_position.head<3>().setConstant(static_cast<double>(count));
  if (count == 1) {
    observation.basis.setIdentity(3, 3);
    return observation;
  }
  const Eigen::Matrix3Xd from_centre = positions.colwise() - positions.rowwise().mean();
  Eigen::MatrixXd shared(size, 6);
  for (Eigen::Index k = 0; k < count; ++k) {
    shared.block<3, 3>(3 * k, 0).setIdentity();
    shared.block<3, 3>(3 * k, 3) = -Skew(from_centre.col(k));
  }
  // Displacements are orthogonal to rotations about the centre; the principal rotations are
  // orthogonal to each other.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turns(shared.rightCols<3>().transpose() *
                                                             shared.rightCols<3>());
  Eigen::MatrixXd first(size, 6);
  first.leftCols<3>() = shared.leftCols<3>() / std::sqrt(static_cast<double>(count));
  Eigen::Index rows = 3;
  for (int k = 2; k >= 0; --k) {
    const double inertia = turns.eigenvalues()[k];
    if (!(inertia > kLeastLever * kLeastLever)) break;
    first.col(rows) = shared.rightCols<3>() * turns.eigenvectors().col(k) / std::sqrt(inertia);
    ++rows;
  }
  observation.rotation_rows = rows - 3;
  observation.basis = OrthogonalFactor(first.leftCols(rows));
  observation.basis.leftCols(rows) = first.leftCols(rows);
  return observation;
}

Selection Select(const ErrorModel& model, const Recording& recording, ObservationMask markers,
                 std::vector<char> tied) {
  Selection selection;
  const ObservationMask seen = SeenMask(recording);
  std::vector<BodyObservation> left_out;
  for (int i = 0; i < recording.posture_count(); ++i) {
    std::map<int, std::vector<int>> of_body;
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (!seen(i, m)) continue;
      const int body = model.tree.links[model.markers[m].link].body;
      if (markers(i, m)) {
        of_body[body].push_back(m);
      } else {
        left_out.push_back(MakeBodyObservation(i, body, {m}, Positions(recording, i, {m})));
        left_out.back().used = false;
      }
    }
    for (auto& [body, of] : of_body) {
      const Eigen::Matrix3Xd positions = Positions(recording, i, of);
      selection.bodies.push_back(MakeBodyObservation(i, body, std::move(of), positions));
    }
  }
  selection.bodies.insert(selection.bodies.end(), std::make_move_iterator(left_out.begin()),
                          std::make_move_iterator(left_out.end()));
  selection.markers = std::move(markers);
  selection.tied = std::move(tied);
  return selection;
}

Selection SelectAll(const ErrorModel& model, const Recording& recording) {
  return Select(model, recording, SeenMask(recording),
                std::vector<char>(recording.posture_count(), 1));
}

}  // namespace elastocal
