// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

/// A format in which a calibration is exported.
struct ExportFormat {
  std::string name;  ///< name on the command line
  std::string what;  ///< description in a few words
};

/// All formats of ExportCalibration, in the order of its description.
std::vector<ExportFormat> ExportFormats();

/// Settings of ExportCalibration.
struct ExportOptions {
  std::string format = "urdf";
  std::string prefix = {};  ///< prefix of names in C; empty: the name of the robot
  /// Only joints are exported whose displacement is at least this many standard deviations; the
  /// others stay nominal. 0: all.
  double least_significance = 0.0;
  std::string version = {};         ///< version of the program, for comments
  std::filesystem::path mjcf = {};  ///< the nominal model that the format mjcf changes
  /// Only joints are exported that gain more than this on data that the calibration has not seen, m
  /// (FindHeldOutGains, for what the format carries); the others stay nominal. Empty: all.
  std::optional<double> least_gain = {};
  /// Names of joints that are called differently in the MJCF (ReadMjcfJointNames).
  std::vector<std::string> mjcf_joints = {};
  /// Path of the file to be written, relative to which a URDF or an MJCF finds its meshes.
  std::filesystem::path output = {};
  bool mjcf_springs = false;  ///< for the format mjcf: with springs in series with the joints
  /// For rigid formats: export the geometry of the elastic model (as c99 and runtime do), for
  /// programs that compensate elasticity themselves. If false: the geometry of the URDF by
  /// `calibrate`.
  bool beside_springs = false;
  /// For the format flex_joints: damping of the hips, N.m.s/rad, which no calibration tells.
  std::optional<double> hip_damping = {};
  /// For the format c99: the low-pass filter and the limits that the header has fixed.
  CompensatorOptions limits = {};
};

struct ExportedCalibration {
  std::string text;  ///< contents of the file
  /// Notes that are also comments of the file: which joints stay nominal and why (if requested),
  /// that a robot without chains has no commands to correct, and which frames are not determined
  /// (DescribeOpenFrames).
  std::vector<std::string> notes;
};

/// Writes a calibration as text in a format:
///
/// - c99: one self-contained header (runtime/c_header.hpp), with elasticity;
/// - runtime: the file that Compensator reads (runtime/runtime_model.hpp), with elasticity;
/// - urdf: the user's URDF with changed joint origins. Like all rigid formats, it has the errors of
///   the URDF by calibrate (AsInUrdf), or those of the elastic model (`beside_springs`);
/// - urdf_encoder: the same, with the joints' zeros left to the encoders;
/// - urdf_rising: as urdf_encoder, with the zeros added to the joints' element `calibration`
///   (rising);
/// - linkages: the calibrated rods, of the same geometry as urdf, as a section of a project
///   (io/linkage_file.hpp);
/// - xacro: what is added to the origins of the URDF, as xacro properties;
/// - pal: the seven numbers of each joint (xyz, rpy, zero of the encoder) as YAML;
/// - ros2_control: the zeros of the encoders as offsets of SimpleTransmission;
/// - mjcf: the user's MJCF with changed bodies, and the zeros as `ref` of its joints
///   (description/calibrated_mjcf.hpp), with `mjcf_springs` also its elasticity;
/// - flex_joints: stiffnesses of the hips (MakeFlexJointsYaml).
///
/// A URDF is read back and compared with the model in 1000 postures (1e-9) before it is returned.
/// Throws InputError for an unknown format (the message names the nearest known one), for mjcf
/// without a model or with one that is not that of the URDF, for options of another format, for
/// options about springs if the calibration has none, and with `least_gain` as FindHeldOutGains.
ExportedCalibration ExportCalibration(const CalibratedRobot& robot, const ExportOptions& options);

/// Whether a text was written by ExportCalibration, by the comment that each of its formats
/// contains.
bool IsExported(const std::string& text);

}  // namespace elastocal
