// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/simulation/sensors.hpp"

namespace elastocal {

/// Adds the faults of marker data to the positions that the cameras see in trial `index`, frames x
/// 3 N_M. `PushMarkers` moves markers and is called before noise is added; `LoseMarkers` loses or
/// exchanges markers and is called after it. Both add a sentence for each fault to `said`.
void PushMarkers(const Faults& faults, const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials, std::size_t index,
                 const TrueMotion& motion, Eigen::MatrixXd& positions,
                 std::vector<std::string>& said);
void LoseMarkers(const Faults& faults, const std::vector<PlannedTrial>& trials, std::size_t index,
                 const std::vector<std::string>& names, double rate_hz, Random& random,
                 Eigen::MatrixXd& positions, std::vector<std::string>& said);

/// Adds the faults of a log: in its torques and at its end.
void SpoilLog(const Faults& faults, const std::vector<PlannedTrial>& trials, std::size_t index,
              JointLog& log, std::vector<std::string>& said);

/// Throws InputError if a fault names something that does not exist, or has no effect in any trial.
void CheckFaults(const Faults& faults, const TrueRobot& robot,
                 const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials);

}  // namespace elastocal
