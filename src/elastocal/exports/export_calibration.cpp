// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/export_calibration.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "elastocal/description/calibrated_mjcf.hpp"
#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/description/move_urdf.hpp"
#include "elastocal/description/series_springs.hpp"
#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/description/urdf_writer.hpp"
#include "elastocal/exports/export_texts.hpp"
#include "elastocal/exports/held_out_gains.hpp"
#include "elastocal/exports/open_frames.hpp"
#include "elastocal/exports/runtime_causes.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/files/xml_edit.hpp"
#include "elastocal/io/linkage_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/runtime/c_header.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

/// Part of the comment with the version in every exported file, by which IsExported recognises it.
constexpr const char* kMadeBy = "Made by elastocal ";

constexpr const char* kBesideSprings =
    "Geometry of the elastic model: for programs that correct elasticity themselves";

/// Whether names with this prefix may be those that the header has of its own (ec_foot, EC_ARM).
bool IsOfTheHeader(const std::string& prefix) {
  std::string lower;
  for (unsigned char c : prefix) lower += static_cast<char>(std::tolower(c));
  return lower == "ec" || lower.starts_with("ec_");
}

/// Converts a name to one that is valid in C.
std::string CPrefix(const std::string& name) {
  std::string prefix;
  for (unsigned char c : name) {
    prefix += std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  }
  if (prefix.empty() || std::isdigit(static_cast<unsigned char>(prefix[0])) != 0 ||
      IsOfTheHeader(prefix)) {
    prefix = "robot_" + prefix;
  }
  return prefix;
}

/// Comments of the header on each joint and leg: errors with unit and standard deviation.
std::map<std::string, std::vector<std::string>> ParameterComments(
    const CalibrationEstimate& estimate) {
  std::map<std::string, std::vector<std::string>> comments;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    const std::size_t dot = parameter.name.rfind('.');
    comments[parameter.name.substr(0, dot)].push_back(
        fmt::format("{} = {:.6g} {}, sd {:.2g}", parameter.name.substr(dot + 1), parameter.value,
                    parameter.unit, parameter.sd));
  }
  return comments;
}

CalibrationResult ResultOf(const StoredRobot& robot) {
  CalibrationResult result;
  result.model = robot.model;
  result.delta = robot.errors;
  return result;
}

std::vector<Leg> LegsOf(const Project& project) {
  std::vector<NamedChain> chains;
  for (const Chain& chain : project.chains) {
    chains.push_back({chain.name, chain.from_link, chain.tip_link});
  }
  return FindLegs(project.tree, chains);
}

/// Whether the format has a place for compliances.
bool HasSprings(const ExportOptions& options) {
  const std::string& format = options.format;
  return format == "c99" || format == "runtime" || format == "flex_joints" ||
         (format == "mjcf" && options.mjcf_springs);
}

/// Whether the export is used with compliances, in the same file or beside it.
bool HasLoads(const ExportOptions& options) {
  return HasSprings(options) || options.beside_springs;
}

/// Whether anything gives way in the calibration.
bool HasElasticity(const StoredCalibration& calibration) {
  return std::ranges::any_of(calibration.soles, &SoleSpring::told) ||
         std::ranges::any_of(calibration.joint_errors, [](const auto& error) {
           return error.second != 0.0 && error.first.find(".compliance") != std::string::npos;
         });
}

/// Throws InputError for an option about springs if there are none.
void CheckHasElasticity(const StoredCalibration& calibration, const ExportOptions& options) {
  if (HasElasticity(calibration)) return;
  const std::string option = options.mjcf_springs     ? "--mjcf-springs"
                             : options.beside_springs ? "--beside-springs"
                                                      : "";
  if (option.empty()) return;
  throw InputError(option + ": " + calibration.source +
                   " has no springs, so that the option would do nothing");
}

/// Whether the format is another form of the calibrated URDF, or is used with it (linkages).
bool IsRigid(const ExportOptions& options) { return !HasLoads(options); }

CalibratedUrdf UrdfOf(const CalibratedRobot& robot, const StoredCalibration& calibration,
                      ZeroOffsets zero_offsets) {
  const CalibrationResult result = ResultOf(RestoreRobot(robot.project, calibration));
  const std::string file = robot.project.urdf.string();
  return MakeCalibratedUrdf(ReadFile(robot.project.urdf), file, result, zero_offsets);
}

std::string MjcfOf(const CalibratedRobot& robot, const StoredCalibration& calibration,
                   const CalibratedUrdf& apart, const ExportOptions& options) {
  const std::string file = options.mjcf.string();
  RobotTree calibrated = ParseUrdf(apart.text, robot.project.urdf.string() + " (calibrated)");
  std::vector<SeriesSpring> springs;
  if (options.mjcf_springs) {
    springs = SeriesSprings(ResultOf(RestoreRobot(robot.project, calibration)), calibrated,
                            LegsOf(robot.project));
    const auto soles = SpringsOfSoles(calibration.soles, calibrated, LegsOf(robot.project));
    springs.insert(springs.end(), soles.begin(), soles.end());
  }
  const std::string text = MakeCalibratedMjcf(
      ReadFile(options.mjcf), file, robot.project.tree, calibrated, apart.encoder_offsets, springs,
      ReadMjcfJointNames(robot.project.tree, options.mjcf_joints));
  if (options.output.empty()) return text;
  return MoveMjcf(text, file, options.mjcf.parent_path(), options.output.parent_path());
}

/// The part of a calibration that is exported.
struct Kept {
  StoredCalibration calibration;      ///< without the errors of joints that stay nominal
  std::set<std::string> nominal;      ///< joints and legs that stay nominal
  std::vector<std::string> comments;  ///< names of these joints, with the reason
};

/// Names of the causes that the format carries.
std::set<std::string> CarriedCauses(const CalibratedRobot& robot, const ExportOptions& options) {
  if (options.format != "c99" && options.format != "runtime") return {};
  return CausesAtRunTime(robot.project.tree, robot.calibration);
}

/// Names of the causes that the format does not carry.
std::set<std::string> CausesLeftOut(const CalibratedRobot& robot, const ExportOptions& options) {
  const std::set<std::string> carried = CarriedCauses(robot, options);
  std::set<std::string> left_out;
  for (const Correction& cause : PossibleCorrections(robot.project.tree, std::nullopt)) {
    if (!carried.contains(cause.name)) left_out.insert(cause.name);
  }
  return left_out;
}

/// Joints and legs whose exported errors are hardly determined.
std::set<std::string> Insignificant(const CalibrationEstimate& estimate,
                                    const StoredCalibration& exported,
                                    const std::set<std::string>& left_out, double least) {
  std::map<std::string, double> largest;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    if (parameter.external) continue;
    double& most = largest[OwnerName(parameter.name)];
    const auto found = exported.joint_errors.find(parameter.name);
    if (found == exported.joint_errors.end() || !(parameter.sd > 0.0)) continue;
    if (left_out.contains(parameter.name)) continue;
    most = std::max(most, std::abs(found->second) / parameter.sd);
  }
  std::set<std::string> names;
  for (const auto& [name, most] : largest) {
    if (most < least) names.insert(name);
  }
  return names;
}

Kept KeepWhatHelps(const CalibratedRobot& robot, const CalibrationEstimate& estimate,
                   const ExportOptions& options) {
  Kept kept{IsRigid(options) ? AsInUrdf(robot.calibration) : robot.calibration, {}, {}};
  if (options.least_significance > 0.0) {
    kept.nominal = Insignificant(estimate, kept.calibration, CausesLeftOut(robot, options),
                                 options.least_significance);
    for (const std::string& name : kept.nominal) {
      kept.comments.push_back(
          fmt::format("{} is nominal: no error of {:g} standard deviations or more", name,
                      options.least_significance));
    }
  }
  const auto return_to_nominal = [&] {
    for (auto& [name, value] : kept.calibration.joint_errors) {
      if (kept.nominal.contains(OwnerName(name))) value = 0.0;
    }
  };
  return_to_nominal();
  if (!options.least_gain) return kept;
  const HeldOutGains gains = FindHeldOutGains(robot, {.least = *options.least_gain,
                                                      .with_loads = HasLoads(options),
                                                      .nominal = kept.nominal,
                                                      .causes = CarriedCauses(robot, options)});
  for (const JointGain& joint : gains.study.joints) {
    if (!joint.kept) kept.nominal.insert(joint.owner);
  }
  return_to_nominal();
  for (const std::string& line : DescribeGains(gains)) kept.comments.push_back(line);
  return kept;
}

/// The text of an XML file with comments at its beginning.
std::string WithXmlComment(const std::string& text, const std::string& source,
                           const std::vector<std::string>& comments) {
  const XmlText xml(text, source);
  std::string comment = XmlComment(comments);
  comment.pop_back();  // the line end, which the text has already
  return ApplyEdits(text, {InsertElement(text, xml.Root(), comment)});
}

std::string CHeaderOf(const CalibratedRobot& robot, const Kept& kept,
                      const CalibrationEstimate& estimate, const std::string& heading,
                      const std::string& given, const CompensatorOptions& limits) {
  const std::string prefix = given.empty() ? CPrefix(robot.project.tree.name) : given;
  if (!IsCName(prefix)) {
    throw InputError("--prefix " + prefix +
                     ": letters, digits and '_', the first no digit, were expected");
  }
  if (IsOfTheHeader(prefix)) {
    throw InputError("--prefix " + prefix +
                     ": names of the header's own begin with 'ec_'; another prefix was expected");
  }
  return MakeCHeader(MakeRuntimeModel(robot.project, kept.calibration),
                     {prefix, heading, ParameterComments(estimate), limits});
}

/// The text with comments after the line that tells the format.
std::string RuntimeFileOf(const CalibratedRobot& robot, const Kept& kept,
                          const std::vector<std::string>& heading) {
  std::ostringstream out;
  WriteRuntimeModel(MakeRuntimeModel(robot.project, kept.calibration), out);
  std::string text = out.str();
  return text.insert(text.find('\n') + 1, YamlComment(heading));
}

std::string LinkagesOf(const CalibratedRobot& robot, const Kept& kept,
                       const std::vector<std::string>& heading) {
  if (robot.project.tree.linkages.empty()) {
    throw InputError("format linkages: the robot has no linkages");
  }
  return YamlComment(heading) +
         MakeLinkagesYaml(ResultOf(RestoreRobot(robot.project, kept.calibration)));
}

/// The estimate without the errors of joints that stay nominal.
CalibrationEstimate Exported(CalibrationEstimate estimate, const std::set<std::string>& nominal) {
  std::erase_if(estimate.parameters, [&](const ParameterEstimate& parameter) {
    return nominal.contains(OwnerName(parameter.name));
  });
  return estimate;
}

void CheckExportOptions(const ExportOptions& options) {
  const std::string& format = options.format;
  std::vector<std::string> known;
  for (const ExportFormat& one : ExportFormats()) known.push_back(one.name);
  if (std::ranges::find(known, format) == known.end()) {
    throw InputError(fmt::format("export format '{}'; one of {} was expected{}", format,
                                 fmt::join(known, ", "), DidYouMean(format, known)));
  }
  if (format == "mjcf" && options.mjcf.empty()) {
    throw InputError("format mjcf: the nominal model was expected (--mjcf FILE)");
  }
  if (format != "mjcf" && !options.mjcf.empty()) {
    throw InputError("format " + format + ": --mjcf is about format mjcf");
  }
  if (format != "c99" && !options.prefix.empty()) {
    throw InputError("format " + format + ": --prefix is about format c99");
  }
  if (format != "mjcf" && !options.mjcf_joints.empty()) {
    throw InputError("format " + format + ": --mjcf-joints is about format mjcf");
  }
  if (format != "mjcf" && options.mjcf_springs) {
    throw InputError("format " + format + ": --mjcf-springs is about format mjcf");
  }
  if (options.beside_springs && HasSprings(options)) {
    throw InputError("format " + format +
                     ": --beside-springs is about formats without springs (urdf, ...)");
  }
  if (format != "flex_joints" && options.hip_damping) {
    throw InputError("format " + format + ": --hip-damping is about format flex_joints");
  }
}

/// A URDF with the heading, as it finds its meshes from the folder of the output.
std::string FinishedUrdf(const CalibratedRobot& robot, const std::string& urdf,
                         const std::vector<std::string>& heading, const ExportOptions& options) {
  const std::string source = robot.project.urdf.string();
  const std::string text = WithXmlComment(urdf, source, heading);
  if (options.output.empty()) return text;
  return MoveUrdf(text, source, robot.project.urdf.parent_path(), options.output.parent_path());
}

std::string TextOf(const CalibratedRobot& robot, const Kept& kept, const ExportOptions& options) {
  const std::string& format = options.format;
  const CalibrationEstimate estimate =
      Exported(ReadCalibrationFiles(FindCalibrationFiles(robot.calibration.source)), kept.nominal);
  std::vector<std::string> heading{fmt::format("{}, calibrated from {}. {}{} of {}",
                                               robot.project.tree.name, robot.calibration.recording,
                                               kMadeBy, options.version, robot.calibration.source)};
  if (options.beside_springs) heading.emplace_back(kBesideSprings);
  heading.insert(heading.end(), kept.comments.begin(), kept.comments.end());
  if (format == "c99") {
    return CHeaderOf(robot, kept, estimate, fmt::format("{}", fmt::join(heading, "\n   ")),
                     options.prefix, options.limits);
  }
  if (format == "runtime") return RuntimeFileOf(robot, kept, heading);
  if (format == "linkages") return LinkagesOf(robot, kept, heading);
  const std::string source = robot.project.urdf.string();
  if (format == "urdf") {
    return FinishedUrdf(robot, UrdfOf(robot, kept.calibration, ZeroOffsets::kOrigin).text, heading,
                        options);
  }
  const CalibratedUrdf apart = UrdfOf(robot, kept.calibration, ZeroOffsets::kEncoder);
  if (format == "urdf_encoder") return FinishedUrdf(robot, apart.text, heading, options);
  if (format == "urdf_rising") {
    return FinishedUrdf(robot, ShiftReferencePositions(apart.text, source, apart.encoder_offsets),
                        heading, options);
  }
  if (format == "mjcf") {
    return WithXmlComment(MjcfOf(robot, kept.calibration, apart, options), options.mjcf.string(),
                          heading);
  }
  if (format == "xacro") {
    return WithXmlComment(MakeXacroOffsets(apart), source, heading);
  }
  if (format == "pal") return MakePalYaml(apart, heading);
  if (format == "ros2_control") return MakeRos2Transmissions(apart, heading);
  return MakeFlexJointsYaml(ResultOf(RestoreRobot(robot.project, kept.calibration)),
                            ParseUrdf(apart.text, source + " (calibrated)"), LegsOf(robot.project),
                            estimate, options.hip_damping, heading);
}

}  // namespace

std::vector<ExportFormat> ExportFormats() {
  return {{"c99", "a self-contained C99 header: forward, correct and command, with elasticity"},
          {"runtime", "the model that elastocal::Compensator reads, with elasticity"},
          {"urdf", "the URDF with calibrated joint origins"},
          {"urdf_encoder", "the same with the joints' zeros left to the encoders (see pal)"},
          {"urdf_rising", "that one, the zeros added to <calibration rising>"},
          {"linkages", "the calibrated rods of a robot with linkages, as a section of a project"},
          {"xacro", "what is added to the joint origins, as xacro properties"},
          {"pal", "seven numbers a joint: xyz, rpy and the zero of the encoder (YAML)"},
          {"ros2_control", "the zeros of the encoders as offsets of transmissions"},
          {"mjcf", "the model of --mjcf with calibrated bodies, the zeros as ref of its joints"},
          {"flex_joints", "stiffness of the hips for the estimator flex-joints (YAML)"}};
}

ExportedCalibration ExportCalibration(const CalibratedRobot& robot, const ExportOptions& options) {
  CheckExportOptions(options);
  CheckHasElasticity(robot.calibration, options);
  const CalibrationEstimate estimate = ReadEstimate(robot.calibration.source);
  const Kept kept = KeepWhatHelps(robot, estimate, options);
  ExportedCalibration exported{TextOf(robot, kept, options), kept.comments};
  for (const std::string& open : DescribeOpenFrames(robot.project, estimate)) {
    exported.notes.push_back(open);
  }
  const bool at_run_time = options.format == "c99" || options.format == "runtime";
  if (at_run_time && MakeRuntimeModel(robot.project, kept.calibration).tips.empty()) {
    exported.notes.push_back("Commands are left as they are: " + NothingToCorrect());
  }
  if (HasSprings(options) && !HasElasticity(kept.calibration)) {
    exported.notes.emplace_back("Nothing gives way in what is exported: geometry alone");
  }
  if (const std::string differs = GravityThatDiffers(robot.calibration);
      at_run_time && !differs.empty()) {
    exported.notes.push_back(differs);
  }
  return exported;
}

bool IsExported(const std::string& text) { return text.find(kMadeBy) != std::string::npos; }

}  // namespace elastocal
