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

/// Joints of a chain, by name, by which tables can be filtered.
struct ChainView {
  std::string name;
  std::vector<std::string> joints;
};

/// Markers on one link that have one colour.
struct ClusterView {
  std::string name, link;
  std::vector<std::string> markers;
};

/// A collision sphere on a link, m.
struct SphereView {
  std::string link;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< in the frame of the link
  double radius = 0.0;
};

/// Allowed workspace of the end of a chain during calibration: a box in the frame of a link, m.
struct WorkspaceView {
  std::string chain, link;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();
};

/// Sole of a foot: a rectangle in the plane z = 0 of a link, m.
struct SoleView {
  std::string link;
  Eigen::Vector2d min = Eigen::Vector2d::Zero(), max = Eigen::Vector2d::Zero();
};

/// What the 3-D view draws without measurements.
struct RobotView {
  const RobotTree& tree;
  std::string urdf;                           ///< text of the robot description
  std::map<std::string, std::string> meshes;  ///< contents of STL files, by their names in the URDF
  std::vector<ChainView> chains;
  std::vector<SphereView> spheres;
  std::vector<WorkspaceView> workspaces;
  Eigen::VectorXd rest;         ///< the posture of rest, by coordinate, rad or m
  std::vector<Marker> markers;  ///< with nominal positions
  std::vector<SoleView> soles;
};

/// robot_data.json: for folders without a calibration, so that a project can be viewed and a
/// planned motion played.
std::string MakeRobotDataJson(const RobotView& view);

/// Everything of a calibration that a page shows beyond summary.json. Keeps references to results
/// that the caller holds.
struct CalibrationView {
  RobotView robot;
  std::vector<ClusterView> clusters;

  const Recording& recording;  ///< the recording that was used for the calibration
  const ModelComparison& comparison;
  const Recording& validation;        ///< may have no postures
  const HeldOut* held_out = nullptr;  ///< errors on `validation`; null: none
  const std::vector<TrialSummary>& trials;
};

/// report_data.json (docs/formats.md): recorded postures and motions with measured and predicted
/// markers, errors by cluster, distributions of residuals, and signals with the samples chosen from
/// them. Motions are thinned, so that the experiment of a whole humanoid takes some megabytes.
std::string MakeReportDataJson(const CalibrationView& view);

}  // namespace elastocal
