// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/simulate_observations.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/planning/observed_stance.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/simulation/level_feet.hpp"
#include "elastocal/simulation/stream_seed.hpp"
#include "elastocal/simulation/touch_table.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// Draws the virtual robot and all truth around it.
VirtualExperiment DrawRobot(const Project& project, const ObservationSetup& setup,
                            const VirtualExperimentOptions& options) {
  VirtualExperiment experiment;
  experiment.options = options;
  experiment.options.truth.seed = options.robot_seed.value_or(options.seed);
  DescribedRobot described = DescribeRobot(project);
  for (const ContactFoot& foot : setup.feet) {
    described.chains.push_back({project.tree.links[Size(foot.link)].name, 0, foot.link});
  }
  experiment.described_tree = described.tree;
  experiment.robot = DrawTrueRobot(
      NominalRobot(described.tree, {}, FindLegs(described.tree, described.chains), {}),
      experiment.options.truth);
  for (const ContactFoot& foot : setup.feet) {
    const auto& legs = experiment.robot.legs;
    if (std::any_of(legs.begin(), legs.end(),
                    [&](const Leg& leg) { return leg.foot_link == foot.link; })) {
      continue;
    }
    throw InputError(project.file.string() + ": the foot " +
                     Quote(project.tree.links[Size(foot.link)].name) +
                     " of contact.feet is above the others in the zero posture; a robot whose feet "
                     "are on one level there is simulated");
  }
  return experiment;
}

std::vector<QuantityValue> DrawQuantities(const Project& project, const ObservationSetup& setup,
                                          double table_height_sd, std::uint64_t seed) {
  constexpr double kMost = 0.1;  // of unknown quantities, m and rad
  const Spread spread = FirstSpread(setup.sources);
  std::vector<QuantityValue> values;
  for (const Quantity& quantity : setup.quantities) {
    Random random(StreamSeed(seed, "quantity " + quantity.name));
    QuantityValue value{quantity.origin, Eigen::VectorXd::Zero(quantity.size())};
    for (int k = 0; k < quantity.size(); ++k) {
      value.x[k] = random.Normal(std::min(kMost, spread[quantity.sources[Size(k)]]));
    }
    values.push_back(std::move(value));
  }
  for (std::size_t p = 0; p < setup.plates.size(); ++p) {
    if (!project.contact->tables[p]) continue;
    QuantityValue& table = values[Size(setup.instruments[p]->quantities[1])];
    table.origin.translation() = project.contact->tables[p]->centre;
    table.x[0] *= table_height_sd / kMost;
  }
  return values;
}

/// The true plate.
PhysicalPlate TruePlate(const ObservationSetup& setup, std::size_t plate,
                        const std::vector<QuantityValue>& quantities, double edge) {
  PhysicalPlate physical = DescribedPlate(setup.plates[plate], edge);
  const Eigen::VectorXd& tilts = quantities[Size(setup.instruments[plate]->quantities[0])].x;
  physical.T_link_face = physical.T_link_face * RotX(tilts[0]) * RotY(tilts[1]);
  return physical;
}

/// A robot that goes through postures and is measured in each of them.
class Laboratory {
 public:
  Laboratory(const Project& project, ObservedRecording& recording, const Eigen::VectorXd& first)
      : project_(project),
        recording_(recording),
        options_(recording.robot.options),
        random_(StreamSeed(options_.seed, "instruments")),
        feet_(Feet(first)),
        command_(feet_ ? feet_->Yield(first) : first),
        robot_(recording.robot.robot, Support(), command_, options_.physics, Plates()) {
    Wait(kSettle_s);
  }

  SimulatedPosture Play(int plate, const Eigen::VectorXd& posture, const std::string& name) {
    const Eigen::VectorXd q = feet_ ? feet_->Yield(posture) : posture;
    SimulatedPosture seen{plate, {}, {}};
    if (plate < 0) {
      MoveTo(q);
    } else if (!LayDown(plate, q)) {
      recording_.warnings.push_back(name +
                                    ": the plate did not come to lie flush; the touch is "
                                    "left out");
      seen.plate = kGivenUp;
    }
    Wait(kSettle_s);
    seen.encoders = Encoders();
    seen.measured.resize(recording_.setup.instruments.size());
    const bool shown = plate < 0 || !project_.contact->plate_column.empty();
    for (std::size_t n = recording_.setup.plates.size(); shown && n < seen.measured.size(); ++n) {
      seen.measured[n] = Measure(*recording_.setup.instruments[n]);
    }
    if (plate >= 0) robot_.PlaceTable(plate, Transform(Eigen::Translation3d(0, 0, -100)));
    return seen;
  }

  static constexpr int kGivenUp = -2;

 private:
  static constexpr double kSettle_s = 0.5;

  std::vector<int> Support() const {
    std::vector<int> support;
    for (const ContactFoot& foot : recording_.setup.feet) support.push_back(foot.link);
    return support;
  }
  std::optional<LevelFeet> Feet(const Eigen::VectorXd& first) const {
    if (recording_.setup.feet.empty()) return {};
    return LevelFeet(recording_.robot.robot, Support(), first);
  }
  std::vector<PhysicalPlate> Plates() const {
    std::vector<PhysicalPlate> plates;
    for (std::size_t p = 0; p < recording_.setup.plates.size(); ++p) {
      plates.push_back(
          TruePlate(recording_.setup, p, recording_.quantities, options_.instruments.plate_edge));
    }
    return plates;
  }

  void Wait(double duration_s) {
    const int steps = static_cast<int>(std::lround(duration_s / robot_.time_step_s()));
    for (int i = 0; i < steps; ++i) robot_.Step();
  }

  void MoveTo(const Eigen::VectorXd& q) {
    constexpr double kMove_s = 0.5;
    const int steps = static_cast<int>(std::lround(kMove_s / robot_.time_step_s()));
    const Eigen::VectorXd from = command_;
    for (int i = 1; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      command_ = from + s * s * (3.0 - 2.0 * s) * (q - from);
      robot_.Command(command_);
      robot_.Step();
    }
    Wait(kSettle_s);
  }

  /// Pose of an uneven table below the hand.
  Transform TableUnder(int plate) {
    const QuantityValue& table =
        recording_.quantities[Size(recording_.setup.instruments[Size(plate)]->quantities[1])];
    const Eigen::Vector3d p = robot_.PlatePose(plate).translation();
    const Eigen::Vector3d n = table.Normal();
    const double height = random_.Normal(options_.instruments.touch_height_sd);
    Transform T = Transform::Identity();
    T.translation() = p + (height - table.HeightOver(p)) * n;
    T.linear() = RotationBetween(Eigen::Vector3d::UnitZ(), n);
    const double tilt = options_.instruments.touch_tilt_sd;
    const double about_x = random_.Normal(tilt);
    return T * RotX(about_x) * RotY(random_.Normal(tilt));
  }

  /// Height of the plate's lowest corner above a table.
  double Clearance(int plate, const Transform& T_world_table) const {
    const double half = 0.5 * options_.instruments.plate_edge;
    const Transform T = T_world_table.inverse() * robot_.PlatePose(plate);
    return T.translation().z() - half * (std::abs(T.linear()(2, 0)) + std::abs(T.linear()(2, 1)));
  }

  bool LayDown(int plate, const Eigen::VectorXd& q) {
    constexpr double kAbove = 0.015;  // m
    constexpr int kRaises = 5;
    const PhysicalPlate described =
        DescribedPlate(recording_.setup.plates[Size(plate)], options_.instruments.plate_edge);
    MovingChain arm(project_.tree, HandCoordinates(project_.tree, recording_.setup, plate), q);
    Eigen::VectorXd above = q;
    Vector6d up = Vector6d::Zero();
    up[2] = kAbove;
    Transform T_world_table = Transform::Identity();
    for (int i = 0; i < kRaises; ++i) {
      MovePlate(described, up, arm, above);
      MoveTo(above);
      if (i == 0) T_world_table = TableUnder(plate);
      if (Clearance(plate, T_world_table) > 0.25 * kAbove) break;
    }
    robot_.PlaceTable(plate, T_world_table);
    return TouchTable(robot_, plate, described, arm, options_.instruments.touch, command_).flush;
  }

  Eigen::VectorXd Encoders() const {
    const RobotTree& tree = project_.tree;
    const int bits = options_.sensors.encoder_bits;
    const double step = bits > 0 ? 2.0 * M_PI * std::pow(0.5, bits) : 0.0;
    const Eigen::VectorXd by_joint = robot_.Encoders();
    Eigen::VectorXd encoders(tree.coordinate_count());
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const int k = tree.coordinate_joint[Size(c)];
      const bool turns = tree.joints[Size(k)].type == JointType::kRevolute;
      encoders[c] = step > 0.0 && turns ? step * std::round(by_joint[k] / step) : by_joint[k];
    }
    return encoders;
  }

  Eigen::VectorXd Measure(const Instrument& instrument) {
    Sight sight;
    for (int link : instrument.links) sight.T_floor_link.push_back(robot_.LinkPose(link));
    for (int index : instrument.quantities) {
      sight.values.push_back(recording_.quantities[Size(index)]);
    }
    if (!instrument.Sees(sight)) return {};
    return WithNoise(instrument, instrument.Predict(sight));
  }

  double NoiseOf(SourceUnit unit) const {
    const InstrumentOptions& of = options_.instruments;
    switch (unit) {
      case SourceUnit::kMetre:
        return of.length_sd;
      case SourceUnit::kRadian:
        return of.rotation_sd;
      case SourceUnit::kAcceleration:
        return of.acceleration_sd;
      case SourceUnit::kPixel:
        return of.pixel_sd;
      default:
        return 0.0;
    }
  }

  Eigen::VectorXd WithNoise(const Instrument& instrument, Eigen::VectorXd measured) {
    const std::vector<RowMeaning> rows = instrument.rows();
    Eigen::VectorXd noise(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      noise[static_cast<Eigen::Index>(i)] = random_.Normal(NoiseOf(rows[i].unit));
    }
    if (rows.front().unit == SourceUnit::kPixel) {
      const Eigen::VectorXd blur = random_.NormalVector(2, options_.instruments.blur_sd);
      noise += blur.replicate(noise.size() / 2, 1);
    }
    if (measured.size() == noise.size()) return measured + noise;
    // Noise of a pose: position, then rotation about the body's axes.
    measured.head<3>() += noise.head<3>();
    const Eigen::Quaterniond attitude(Eigen::Vector4d(measured.tail<4>()));
    const Eigen::Matrix3d turn = RotationFromVector(noise.tail<3>());
    measured.tail<4>() = (attitude * Eigen::Quaterniond(turn)).coeffs();
    return measured;
  }

  const Project& project_;
  ObservedRecording& recording_;
  const VirtualExperimentOptions& options_;
  Random random_;
  std::optional<LevelFeet> feet_;
  Eigen::VectorXd command_;
  VirtualRobot robot_;
};

/// Plate of a set of postures; -1: instruments look.
int PlateOf(const ChainPostures& of, const ObservationSetup& setup) {
  if (of.chain == kLooks) return -1;
  std::vector<std::string> names = {kLooks};
  for (std::size_t p = 0; p < setup.plates.size(); ++p) {
    if (setup.plates[p].name == of.chain) return static_cast<int>(p);
    names.push_back(setup.plates[p].name);
  }
  throw InputError("postures of " + Quote(of.chain) +
                   ": the name of a plate, or 'instruments', was expected" +
                   DidYouMean(of.chain.substr(0, 60), names));
}

}  // namespace

ObservedRecording SimulateObservations(const Project& project,
                                       const std::vector<ChainPostures>& postures,
                                       const VirtualExperimentOptions& options,
                                       const Progress& progress) {
  const ObservedPostureSampler stance(project, 0);
  ObservedRecording recording;
  recording.setup = stance.setup();
  recording.robot = DrawRobot(project, recording.setup, options);
  recording.quantities =
      DrawQuantities(project, recording.setup, options.instruments.table_height_sd,
                     options.robot_seed.value_or(options.seed));
  Laboratory laboratory(project, recording, stance.robot().rest);
  int total = 0;
  for (const ChainPostures& of : postures) total += static_cast<int>(of.q.size());
  int done = 0;
  for (const ChainPostures& of : postures) {
    const int plate = PlateOf(of, recording.setup);
    if (plate >= 0 && !project.contact->tables[Size(plate)]) {
      throw InputError(project.file.string() + ": contact.plates: " + Quote(of.chain) +
                       " has no 'table: {centre_mm, size_mm}', which says where it touches");
    }
    for (std::size_t i = 0; i < of.q.size(); ++i) {
      const std::string name = "posture " + std::to_string(i + 1) + " of " + Quote(of.chain);
      SimulatedPosture seen = laboratory.Play(plate, of.q[i], name);
      if (seen.plate != Laboratory::kGivenUp) recording.postures.push_back(std::move(seen));
      if (progress) progress(++done, total);
    }
  }
  return recording;
}

}  // namespace elastocal
