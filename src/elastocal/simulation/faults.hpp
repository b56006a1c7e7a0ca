#pragma once

#include "elastocal/simulation/sensors.hpp"

namespace elastocal {

/// Puts the faults of marker data into what the cameras see of trial `index`: positions, frames x
/// 3 N_M, before noise for what moves markers (`PushMarkers`) and after it for what the cameras
/// lose or confuse (`LoseMarkers`). Both add a sentence for each fault to `said`.
void PushMarkers(const Faults& faults, const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials, std::size_t index,
                 const TrueMotion& motion, Eigen::MatrixXd& positions,
                 std::vector<std::string>& said);
void LoseMarkers(const Faults& faults, const std::vector<PlannedTrial>& trials, std::size_t index,
                 const std::vector<std::string>& names, double rate_hz, Random& random,
                 Eigen::MatrixXd& positions, std::vector<std::string>& said);

/// The same for the torques of a log and its end.
void SpoilLog(const Faults& faults, const std::vector<PlannedTrial>& trials, std::size_t index,
              JointLog& log, std::vector<std::string>& said);

/// Throws InputError where a fault names what does not exist, or can be seen in no trial.
void CheckFaults(const Faults& faults, const TrueRobot& robot,
                 const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials);

}  // namespace elastocal
