// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/truth_file.hpp"

#include <cmath>

#include <yaml-cpp/emitter.h>

#include "elastocal/io/posture_checks.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kRadPerDeg = M_PI / 180.0;

/// Writes numbers with all digits.
class TruthWriter {
 public:
  YAML::Emitter yaml;

  void Key(const std::string& key) { yaml << YAML::Key << key << YAML::Value; }
  void Value(const std::string& key, double value) {
    Key(key);
    yaml << FormatNumber(value);
  }
  template <typename Vector>
  void List(const std::string& key, const Vector& values) {
    Key(key);
    List(values);
  }
  template <typename Vector>
  void List(const Vector& values) {
    yaml << YAML::Flow << YAML::BeginSeq;
    for (const double value : values) yaml << FormatNumber(value);
    yaml << YAML::EndSeq;
  }
};

void WriteJoints(const VirtualExperiment& experiment, const RobotTree& described,
                 TruthWriter& writer) {
  const TrueRobot& robot = experiment.robot;
  writer.Key("joints");
  writer.yaml << YAML::BeginMap;
  for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
    const Joint& joint = robot.tree.joints[k];
    const auto index = static_cast<Eigen::Index>(k);
    const Transform error = described.joints[k].T_parent_child.inverse() * joint.T_parent_child;
    const Eigen::AngleAxisd turn(error.linear());
    const bool slides = joint.type == JointType::kPrismatic;
    writer.Key(joint.name);
    writer.yaml << YAML::BeginMap;
    writer.Value(slides ? "offset_mm" : "offset_deg",
                 robot.offset[index] / (slides ? 1e-3 : kRadPerDeg));
    writer.List("shift_mm", Eigen::Vector3d(1e3 * error.translation()));
    writer.List("turn_deg", Eigen::Vector3d(turn.angle() / kRadPerDeg * turn.axis()));
    writer.Value(slides ? "compliance_m_per_n" : "compliance_rad_per_nm", robot.compliance[index]);
    if (robot.link_compliance[k].any()) {
      writer.List("carrier_compliance", robot.link_compliance[k]);
    }
    writer.Value(slides ? "friction_n" : "friction_nm", robot.friction[index]);
    if (robot.torque_sensor[k]) {
      writer.Value("torque_gain", robot.torque_gain[index]);
      writer.Value("torque_bias", robot.torque_bias[index]);
    }
    writer.yaml << YAML::EndMap;
  }
  writer.yaml << YAML::EndMap;
}

/// Writes errors of rods, by the names of their parameters.
void WriteRods(const TrueRobot& robot, TruthWriter& writer) {
  if (robot.described.linkages.empty()) return;
  writer.Key("rods");
  writer.yaml << YAML::BeginMap;
  for (std::size_t i = 0; i < robot.described.linkages.size(); ++i) {
    Eigen::Index at = 0;
    for (const Rod& rod : robot.described.linkages[i].rods) {
      for (const auto& [quantity, sd] : rod.uncertain) {
        writer.Key(rod.motor + "." + RodQuantityName(quantity));
        writer.yaml << YAML::Flow << YAML::BeginMap;
        writer.Value("value", robot.linkage_errors[i][at++]);
        writer.Key("unit");
        writer.yaml << UnitName(quantity == RodQuantity::kZero ? ParameterUnit::kRadian
                                                               : ParameterUnit::kMetre)
                    << YAML::EndMap;
      }
    }
  }
  writer.yaml << YAML::EndMap;
}

void WriteLinks(const TrueRobot& robot, TruthWriter& writer) {
  writer.Key("links");
  writer.yaml << YAML::BeginMap;
  for (const Link& link : robot.tree.links) {
    if (link.mass <= 0.0) continue;
    writer.Key(link.name);
    writer.yaml << YAML::BeginMap;
    writer.Value("mass_kg", link.mass);
    writer.List("com_mm", Eigen::Vector3d(1e3 * link.com));
    writer.yaml << YAML::EndMap;
  }
  writer.yaml << YAML::EndMap;
}

void WriteLegs(const VirtualExperiment& experiment, TruthWriter& writer) {
  const RobotTree& tree = experiment.robot.tree;
  writer.Key("legs");
  writer.yaml << YAML::BeginMap;
  for (std::size_t l = 0; l < experiment.legs.size(); ++l) {
    const LegCompliance& leg = experiment.legs[l];
    writer.Key(leg.chain);
    writer.yaml << YAML::BeginMap;
    writer.Key("foot");
    writer.yaml << tree.links[static_cast<std::size_t>(leg.foot_link)].name;
    writer.List("stiffness", leg.compliance.stiffness);
    writer.Key("compliance");
    writer.yaml << YAML::BeginSeq;
    for (int i = 0; i < 6; ++i) writer.List(Vector6d(leg.compliance.C_foot.row(i).transpose()));
    writer.yaml << YAML::EndSeq;
    writer.Key("posture_rad");
    writer.yaml << YAML::Flow << YAML::BeginMap;
    for (int k : experiment.robot.legs[l].joints) {
      const Joint& joint = tree.joints[static_cast<std::size_t>(k)];
      writer.Value(joint.name, JointPosition(joint, leg.posture));
    }
    writer.yaml << YAML::EndMap;
    writer.List("foot_compliance", experiment.robot.foot_compliance[l]);
    writer.yaml << YAML::EndMap;
  }
  writer.yaml << YAML::EndMap;
}

void WriteTrials(const VirtualExperiment& experiment, const std::vector<std::size_t>& trials,
                 const std::vector<SensorTruth>& sensors, TruthWriter& writer) {
  writer.Key("trials");
  writer.yaml << YAML::BeginMap;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    writer.Key(experiment.trials[trials[i]].name);
    writer.yaml << YAML::BeginMap;
    writer.Value("lag_s", sensors[i].lag_s);
    writer.Value("drift_ppm", sensors[i].drift_ppm);
    writer.Key("faults");
    writer.yaml << YAML::BeginSeq;
    for (const std::string& fault : sensors[i].faults) writer.yaml << fault;
    writer.yaml << YAML::EndSeq << YAML::EndMap;
  }
  writer.yaml << YAML::EndMap;
}

void WriteSeed(const VirtualExperimentOptions& options, TruthWriter& writer) {
  writer.Key("seed");
  writer.yaml << options.seed;
  if (!options.robot_seed) return;
  writer.Key("robot_seed");
  writer.yaml << *options.robot_seed;
}

}  // namespace

std::string FormatTruth(const VirtualExperiment& experiment, const std::vector<std::size_t>& trials,
                        const std::vector<SensorTruth>& sensors) {
  TruthWriter writer;
  writer.yaml << YAML::BeginMap;
  WriteSeed(experiment.options, writer);
  WriteLegs(experiment, writer);
  WriteTrials(experiment, trials, sensors, writer);
  WriteJoints(experiment, experiment.described_tree, writer);
  WriteRods(experiment.robot, writer);
  WriteLinks(experiment.robot, writer);
  writer.Key("markers_mm");
  writer.yaml << YAML::BeginMap;
  for (const Marker& marker : experiment.robot.markers) {
    writer.List(marker.name, Eigen::Vector3d(1e3 * marker.p_link_marker));
  }
  writer.yaml << YAML::EndMap << YAML::EndMap;
  return std::string(writer.yaml.c_str()) + "\n";
}

std::string FormatMatchedTruth(const MatchedExperiment& experiment,
                               const std::vector<std::size_t>& trials,
                               const std::vector<SensorTruth>& sensors) {
  TruthWriter writer;
  writer.yaml << YAML::BeginMap;
  writer.Key("matched");
  writer.yaml << true;
  WriteSeed(experiment.plan.options, writer);
  WriteTrials(experiment.plan, trials, sensors, writer);
  writer.Key("parameters");
  writer.yaml << YAML::BeginMap;
  for (int i = 0; i < experiment.model.parameter_count(); ++i) {
    if (experiment.truth[i] == 0.0) continue;
    const Parameter& parameter = experiment.model.parameters[i];
    writer.Key(parameter.name);
    writer.yaml << YAML::Flow << YAML::BeginMap;
    writer.Value("value", experiment.truth[i]);
    writer.Key("unit");
    writer.yaml << UnitName(parameter.unit) << YAML::EndMap;
  }
  writer.yaml << YAML::EndMap << YAML::EndMap;
  return std::string(writer.yaml.c_str()) + "\n";
}

}  // namespace elastocal
