// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/pipeline/calibrated_robot.hpp"

namespace elastocal {

/// A form in which a calibration leaves the program.
struct ExportFormat {
  std::string name;  ///< as the command line has it
  std::string what;  ///< in a few words
};

/// All that ExportCalibration knows, in the order of its description.
std::vector<ExportFormat> ExportFormats();

struct ExportOptions {
  std::string format = "urdf";
  std::string prefix;  ///< of names in C; empty: that of the robot
  /// Only joints of which the calibration tells a displacement of at least so many standard
  /// deviations are exported; the others stay nominal. 0: all.
  double least_significance = 0.0;
  std::string version;              ///< of the program, for comments
  std::filesystem::path mjcf = {};  ///< the nominal model that format mjcf changes
  /// Only joints are exported that gain more than this on data that the calibration has not seen, m
  /// (FindHeldOutGains, for what the format carries); the others stay nominal.
  std::optional<double> least_gain = {};
  /// Joints that are called otherwise there (ReadMjcfJointNames).
  std::vector<std::string> mjcf_joints = {};
  /// The file that the text is for: an MJCF finds its meshes from there.
  std::filesystem::path output = {};
  bool mjcf_springs = false;  ///< of format mjcf: with springs in series with the joints
  /// For rigid formats: with the geometry of the elastic model (that of c99 and runtime), for
  /// programs that correct elasticity themselves; else with that of the URDF of `calibrate`.
  bool beside_springs = false;
  /// For format flex_joints: damping of the hips, N.m.s/rad; no calibration tells it.
  std::optional<double> hip_damping = {};
};

struct ExportedCalibration {
  std::string text;  ///< of the file
  /// Which joints stay nominal and why, where that was asked for (comments of the file, too), that
  /// a robot without chains has no commands to correct, and which frames nothing has told
  /// (DescribeOpenFrames).
  std::vector<std::string> notes;
};

/// A calibration as text in a format:
///
/// - c99: one self-contained header (runtime/c_header.hpp), with elasticity,
/// - runtime: the file that Compensator reads (runtime/runtime_model.hpp), with elasticity,
/// - urdf: the user's URDF with changed joint origins; as all rigid formats, with the errors that
///   the URDF by calibrate has (AsInUrdf), or those of the elastic model (`beside_springs`),
/// - urdf_encoder: the same with the joints' zeros left to the encoders,
/// - urdf_rising: that one, with the zeros added to the joints' element `calibration` (rising),
/// - linkages: the calibrated rods as a section of a project (io/linkage_file.hpp),
/// - xacro: what is added to the origins of the URDF, as xacro properties,
/// - pal: the seven numbers of each joint (xyz, rpy, zero of the encoder) as YAML,
/// - ros2_control: the zeros of the encoders as offsets of SimpleTransmission,
/// - mjcf: the user's MJCF with changed bodies, and the zeros as `ref` of its joints
///   (description/calibrated_mjcf.hpp); with `mjcf_springs` its elasticity as well,
/// - flex_joints: stiffnesses of the hips (MakeFlexJointsYaml).
///
/// A URDF is read back and compared with the model at 1000 postures (1e-9) before it is returned.
/// Throws InputError for an unknown format, with the nearest known one, and for mjcf without a
/// model or with one that is not that of the URDF; for options of another format; with `least_gain`
/// what FindHeldOutGains throws.
ExportedCalibration ExportCalibration(const CalibratedRobot& robot, const ExportOptions& options);

/// Whether a text is of ExportCalibration: a comment in each of its formats says so.
bool IsExported(const std::string& text);

}  // namespace elastocal
