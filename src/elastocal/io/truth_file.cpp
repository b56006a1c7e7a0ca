#include "elastocal/io/truth_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <yaml-cpp/emitter.h>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/qtm_tsv.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = M_PI / 180.0;
constexpr std::array kColumns = {"t", "x", "y", "z", "qw", "qx", "qy", "qz"};

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
                 robot.offset[index] / (slides ? 1e-3 : kDegree));
    writer.List("shift_mm", Eigen::Vector3d(1e3 * error.translation()));
    writer.List("turn_deg", Eigen::Vector3d(turn.angle() / kDegree * turn.axis()));
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
    writer.List("stiffness", leg.base.stiffness);
    writer.Key("compliance");
    writer.yaml << YAML::BeginSeq;
    for (int i = 0; i < 6; ++i) writer.List(Vector6d(leg.base.C_foot.row(i).transpose()));
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

}  // namespace

DescribedRobot DescribeRobot(const Project& project) {
  DescribedRobot robot;
  robot.tree = project.tree;
  robot.markers = project.markers;
  robot.torque_sensors = project.torque_sensors;
  for (const Chain& chain : project.chains) {
    robot.chains.push_back({chain.name, chain.from_link, chain.tip_link});
  }
  for (const MarkerCluster& cluster : project.clusters) {
    robot.clusters.push_back({cluster.name, cluster.markers});
  }
  return robot;
}

WaistTruth ReadWaistTruth(const fs::path& file) {
  std::ifstream stream = OpenTable(file);
  Table table(stream, file.string());
  if (!std::equal(kColumns.begin(), kColumns.end(), table.header().begin(), table.header().end())) {
    throw InputError(file.string() + ": the header t,x,y,z,qw,qx,qy,qz was expected");
  }
  WaistTruth truth;
  std::vector<double> time_s;
  while (table.Next()) {
    const auto number = [&](int column) { return table.Number(column); };
    const Eigen::Quaterniond q(number(4), number(5), number(6), number(7));
    if (!(std::abs(q.norm() - 1.0) < 1e-6)) {
      table.Fail("columns 'qw' to 'qz': a quaternion of unit length was expected");
    }
    Transform T = Transform::Identity();
    T.linear() = q.normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(number(1), number(2), number(3));
    truth.T_camera_waist.push_back(T);
    time_s.push_back(number(0));
  }
  truth.time_s =
      Eigen::Map<const Eigen::VectorXd>(time_s.data(), static_cast<Eigen::Index>(time_s.size()));
  return truth;
}

void WriteWaistTruth(const fs::path& file, const WaistTruth& truth) {
  TableWriter table;
  for (const char* column : kColumns) table.Add(column);
  table.EndRow();
  for (std::size_t i = 0; i < truth.T_camera_waist.size(); ++i) {
    const Transform& T = truth.T_camera_waist[i];
    const Eigen::Quaterniond q(T.linear());
    table.Add(truth.time_s[static_cast<Eigen::Index>(i)]);
    for (double value : T.translation()) table.Add(value);
    for (double value : {q.w(), q.x(), q.y(), q.z()}) table.Add(value);
    table.EndRow();
  }
  WriteFile(file, table.text());
}

void WriteTruth(const fs::path& folder, const VirtualExperiment& experiment,
                const std::vector<std::size_t>& trials, const std::vector<SensorTruth>& sensors) {
  TruthWriter writer;
  writer.yaml << YAML::BeginMap;
  writer.Key("seed");
  writer.yaml << experiment.options.seed;
  WriteLegs(experiment, writer);
  WriteTrials(experiment, trials, sensors, writer);
  WriteJoints(experiment, experiment.described_tree, writer);
  WriteLinks(experiment.robot, writer);
  writer.Key("markers_mm");
  writer.yaml << YAML::BeginMap;
  for (const Marker& marker : experiment.robot.markers) {
    writer.List(marker.name, Eigen::Vector3d(1e3 * marker.p_link_marker));
  }
  writer.yaml << YAML::EndMap << YAML::EndMap;
  WriteFile(folder / "truth.yaml", std::string(writer.yaml.c_str()) + "\n");
}

void WriteMatchedTruth(const fs::path& folder, const MatchedExperiment& experiment,
                       const std::vector<std::size_t>& trials,
                       const std::vector<SensorTruth>& sensors) {
  TruthWriter writer;
  writer.yaml << YAML::BeginMap;
  writer.Key("matched");
  writer.yaml << true;
  writer.Key("seed");
  writer.yaml << experiment.plan.options.seed;
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
  WriteFile(folder / "truth.yaml", std::string(writer.yaml.c_str()) + "\n");
}

TrialFiles WriteSimulatedTrial(const fs::path& folder, const PlannedTrial& plan,
                               const SimulatedTrial& trial) {
  TrialFiles files;
  files.name = plan.name;
  files.kind = plan.kind;
  files.chains = plan.chains;
  files.support = plan.support;
  files.markers = folder / (plan.name + ".tsv");
  files.joints = folder / (plan.name + ".csv");
  files.truth = folder / (plan.name + "_waist.csv");
  WriteQtmTsv(files.markers, trial.raw.markers);
  WriteJointLog(files.joints, trial.raw.joints);
  WaistTruth waist;
  waist.T_camera_waist = trial.motion.T_camera_waist;
  waist.time_s = Eigen::VectorXd::LinSpaced(
      trial.motion.frame_count(), 0.0, (trial.motion.frame_count() - 1) / trial.motion.rate_hz);
  WriteWaistTruth(files.truth, waist);
  return files;
}

}  // namespace elastocal
