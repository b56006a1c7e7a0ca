// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/synthetic_recording.hpp"

#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

Eigen::VectorXd DrawErrors(const ErrorModel& model, const std::vector<int>& parameters,
                           const std::map<ParameterKind, double>& sd, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i : parameters) {
    const auto found = sd.find(model.parameters[i].kind);
    if (found != sd.end()) delta[i] = random.Normal(found->second);
  }
  return delta;
}

Recording MakeSyntheticRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                 const SyntheticOptions& options) {
  Random random(options.seed);
  Recording recording;
  recording.source = "synthetic recording";
  for (const Marker& marker : model.markers) recording.marker_names.push_back(marker.name);
  recording.q.resize(options.postures, model.tree.coordinate_count());
  recording.markers.resize(options.postures, 3 * model.marker_count());
  const Geometry geometry = ApplyErrors(model, delta);
  for (int i = 0; i < options.postures; ++i) {
    const Eigen::VectorXd q = RandomPosture(model.tree, random);
    const Eigen::Matrix3Xd positions = MarkerPositions(model, geometry, q);
    recording.q.row(i) = q.transpose();
    recording.markers.row(i) =
        positions.reshaped().transpose() +
        random.NormalVector(3 * model.marker_count(), options.marker_sd).transpose();
  }
  return recording;
}

}  // namespace elastocal
