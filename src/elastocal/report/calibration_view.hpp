// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial_summary.hpp"
#include "elastocal/validation/held_out.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Joints of a chain, by name: what tables can be filtered by.
struct ChainView {
  std::string name;
  std::vector<std::string> joints;
};

/// Markers on one link that are coloured together.
struct ClusterView {
  std::string name, link;
  std::vector<std::string> markers;
};

/// A collision sphere carried by a link, m.
struct SphereView {
  std::string link;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< in the frame of the link
  double radius = 0.0;
};

/// Where the end of a chain may go while it is calibrated: a box in the frame of a link, m.
struct WorkspaceView {
  std::string chain, link;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();
};

/// The underside of a foot: a rectangle in the plane z = 0 of a link, m.
struct SoleView {
  std::string link;
  Eigen::Vector2d min = Eigen::Vector2d::Zero(), max = Eigen::Vector2d::Zero();
};

/// What the 3-D view draws without any measurement.
struct RobotView {
  const RobotTree& tree;
  std::string urdf;                           ///< text of the robot description
  std::map<std::string, std::string> meshes;  ///< STL files, by the name that the URDF has for them
  std::vector<ChainView> chains;
  std::vector<SphereView> spheres;
  std::vector<WorkspaceView> workspaces;
  Eigen::VectorXd rest;         ///< the posture of rest, by coordinate, rad or m
  std::vector<Marker> markers;  ///< where the project has them
  std::vector<SoleView> soles;
};

/// robot_data.json: for folders without a calibration, so that a project can be looked at and a
/// planned motion played.
std::string MakeRobotDataJson(const RobotView& view);

/// All of a calibration that a page can show beyond summary.json. Keeps references to results that
/// the caller holds.
struct CalibrationView {
  RobotView robot;
  std::vector<ClusterView> clusters;

  const Recording& recording;  ///< that was calibrated from
  const ModelComparison& comparison;
  const Recording& validation;        ///< may have no postures
  const HeldOut* held_out = nullptr;  ///< of `validation`
  const std::vector<TrialSummary>& trials;
};

/// report_data.json (docs/formats.md): recorded postures and motions with measured and predicted
/// markers, errors by cluster, distributions of residuals, signals with the samples chosen of them.
/// Motions are thinned, so that a whole humanoid's experiment stays within some megabytes.
std::string MakeReportDataJson(const CalibrationView& view);

}  // namespace elastocal
