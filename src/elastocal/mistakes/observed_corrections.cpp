// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/observed_corrections.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kMostRowsFurther = 10;

[[noreturn]] void RefuseName(const std::string& name, const std::string& why) {
  throw InputError("--accept " + name + ": " + why);
}

int CoordinateOf(const std::string& name, const std::string& joint, const RobotTree& tree) {
  for (const Joint& candidate : tree.joints) {
    if (candidate.name == joint && !candidate.mimic) return candidate.coordinate;
  }
  RefuseName(name, "the robot has no moving joint '" + joint + "'");
}

std::string JointName(const RobotTree& tree, int coordinate) {
  return JointOfCoordinate(tree, coordinate).name;
}

std::vector<char> PosturesNamed(const std::string& name, const std::string& file, int from,
                                const Observations& observations) {
  std::vector<char> here = PosturesOf(observations, file, from);
  if (std::find(here.begin(), here.end(), 1) == here.end()) {
    RefuseName(name, fmt::format("there is no posture {} in a file '{}'", from, file));
  }
  return here;
}

std::string ApplyStated(const std::string& name, const StatedCorrection& correction,
                        const ObservedRobot& model, Observations& observations) {
  const std::vector<char> here =
      PosturesNamed(name, correction.trial, correction.from, observations);
  if (correction.kind == FaultKind::kCameraScale) {
    const auto& instruments = model.setup.instruments;
    if (std::none_of(instruments.begin(), instruments.end(),
                     [](const auto& of) { return LengthsMeasured(*of) > 0; })) {
      RefuseName(
          name,
          "no instrument measures lengths; of tags, size_mm in the project is to be corrected");
    }
    for (Observation& observation : observations.all) {
      if (here[Size(observation.posture)] == 0) continue;
      const int lengths = LengthsMeasured(model.instrument(observation.instrument));
      observation.measured.head(lengths) /= correction.size;
    }
    return fmt::format("positions and lengths as measured were divided by {:g} ({})",
                       correction.size, name);
  }
  for (int i = 0; i < observations.posture_count(); ++i) {
    if (here[Size(i)] == 0) continue;
    double& position = observations.q(i, correction.coordinate);
    position = correction.kind == FaultKind::kJointGain ? position / correction.size
                                                        : position - correction.size;
  }
  return fmt::format("{}: {}", correction.joint, name);
}

/// The parts of a name such as "sign:a3@day2.csv:14".
struct NamedCorrection {
  std::string word;  ///< for example "sign"
  std::string of;    ///< for example "a3"
  std::string file = {};
  int from = 1;

  std::string where() const {
    if (file.empty()) return "";
    return from > 1 ? fmt::format(" from posture {} of {} on", from, file) : " in " + file;
  }
};

NamedCorrection ParseName(const std::string& name) {
  NamedCorrection parsed;
  const std::size_t colon = name.find(':');
  parsed.word = name.substr(0, colon);
  parsed.of = colon == std::string::npos ? "" : name.substr(colon + 1);
  const std::size_t at = parsed.of.rfind('@');
  if (at == std::string::npos) return parsed;
  parsed.file = parsed.of.substr(at + 1);
  parsed.of.resize(at);
  const std::size_t last = parsed.file.rfind(':');
  if (last != std::string::npos) {
    const auto from = ParseNumber(parsed.file.substr(last + 1));
    if (!from || *from != std::round(*from) || !(*from >= 1.0 && *from < 1e9)) {
      RefuseName(name, "the number of a posture was expected after FILE:");
    }
    parsed.from = static_cast<int>(*from);
    parsed.file.resize(last);
  }
  if (parsed.file.empty()) RefuseName(name, "the name of a file was expected after @");
  return parsed;
}

std::pair<std::string, std::string> ParsePair(const std::string& name, const std::string& of,
                                              const char* expected) {
  const std::size_t comma = of.find(',');
  if (comma == std::string::npos) RefuseName(name, std::string(expected) + " was expected");
  return {of.substr(0, comma), of.substr(comma + 1)};
}

int InstrumentOf(const std::string& name, const std::string& instrument,
                 const ObservedRobot& model) {
  std::string known;
  for (std::size_t i = 0; i < model.setup.instruments.size(); ++i) {
    const std::string& candidate = model.setup.instruments[i]->name;
    if (candidate == instrument) return static_cast<int>(i);
    known += (known.empty() ? "" : ", ") + candidate;
  }
  RefuseName(name, "no instrument is called '" + instrument + "'; there are: " + known);
}

/// Makes the correction of a name; returns its description.
std::string ApplyName(const std::string& name, const ObservedRobot& model,
                      Observations& observations) {
  const RobotTree& tree = model.robot.tree;
  if (const auto stated = ParseStatedCorrection(name, tree)) {
    return ApplyStated(name, *stated, model, observations);
  }
  const NamedCorrection named = ParseName(name);
  const std::string& of = named.of;
  const std::vector<char> here = PosturesNamed(name, named.file, named.from, observations);
  Eigen::MatrixXd& q = observations.q;
  if (named.word == "sign") {
    const int c = CoordinateOf(name, of, tree);
    for (int i = 0; i < q.rows(); ++i) {
      if (here[Size(i)] != 0) q(i, c) *= -1.0;
    }
    return of + ": the sign of its positions was reversed" + named.where();
  }
  if (named.word == "exchange") {
    const auto [a, b] = ParsePair(name, of, "exchange:JOINT,JOINT");
    const int first = CoordinateOf(name, a, tree), second = CoordinateOf(name, b, tree);
    for (int i = 0; i < q.rows(); ++i) {
      if (here[Size(i)] != 0) std::swap(q(i, first), q(i, second));
    }
    return a + " and " + b + ": their positions were exchanged" + named.where();
  }
  if (named.word == "labels") {
    const auto [a, b] = ParsePair(name, of, "labels:NAME,NAME");
    const int first = InstrumentOf(name, a, model), second = InstrumentOf(name, b, model);
    if (!MeasureAlike(model, first, second)) {
      RefuseName(name, "two instruments of one kind were expected");
    }
    observations = WithLabelsExchanged(observations, first, second, here);
    return a + " and " + b + ": what they measured was exchanged" + named.where();
  }
  if (named.word == "frozen") {
    if (!named.file.empty()) RefuseName(name, "frozen:JOINT was expected, for all files");
    const auto frozen = FindFrozen(observations, CoordinateOf(name, of, tree));
    if (!frozen) RefuseName(name, "its positions are not the same in five rows one after another");
    observations = WithoutFault(*frozen, model, observations);
    return fmt::format("{}: {} postures in which it is frozen were left out", of, frozen->count);
  }
  if (named.word == "rows") {
    const auto rows = ParseNumber(of.starts_with('+') ? of.substr(1) : of);
    const bool whole = rows && *rows == std::round(*rows) && *rows != 0.0;
    if (!whole || std::abs(*rows) > kMostRowsFurther) {
      RefuseName(name, fmt::format("rows:+1, up to {} rows to either side, was expected",
                                   kMostRowsFurther));
    }
    observations = WithRowsOf(observations, static_cast<int>(*rows), here);
    return fmt::format("what was observed was taken for the joint positions {} rows further{}", of,
                       named.where());
  }
  RefuseName(name,
             "sign:JOINT, exchange:JOINT,JOINT, labels:NAME,NAME, frozen:JOINT, rows:COUNT, "
             "gain:JOINT=FACTOR, offset:JOINT@FILE:POSTURE=SIZE or scale=FACTOR was expected");
}

}  // namespace

std::string NameInAccept(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

std::vector<std::string> CorrectObservations(const std::vector<std::string>& accepted,
                                             const ObservedRobot& model,
                                             Observations& observations) {
  std::vector<std::string> undone;
  std::set<std::string> done;
  for (const std::string& name : accepted) {
    if (!done.insert(name).second) RefuseName(name, "given twice");
    undone.push_back(ApplyName(name, model, observations));
  }
  if (!undone.empty()) NoteApproach(observations);
  return undone;
}

std::optional<std::string> NameOfFault(const ObservationFault& fault, const ObservedRobot& model,
                                       const Observations& observations) {
  if (fault.kind == ObservationFaultKind::kMoved || fault.kind == ObservationFaultKind::kTagSize ||
      fault.kind == ObservationFaultKind::kJointDrift) {
    return std::nullopt;
  }
  const std::string in = fault.file < 0 ? "" : NameInAccept(observations.files[Size(fault.file)]);
  if (fault.kind == ObservationFaultKind::kScale) {
    return fmt::format("scale{}{}={:.5f}", in.empty() ? "" : ":", in, 1.0 + fault.size);
  }
  const RobotTree& tree = model.robot.tree;
  const std::string joint = JointName(tree, fault.coordinate);
  if (fault.kind == ObservationFaultKind::kJointFrozen) return "frozen:" + joint;
  if (fault.kind == ObservationFaultKind::kJointGain) {
    return fmt::format("gain:{}{}={:.5f}", joint, in.empty() ? "" : "@" + in, 1.0 + fault.size);
  }
  const bool slides = JointOfCoordinate(tree, fault.coordinate).type == JointType::kPrismatic;
  const double size = fault.size / (slides ? 1e-3 : M_PI / 180.0);
  std::string names;
  int number = 0;  // number of the posture in its file
  for (int i = 0; i < observations.posture_count(); ++i) {
    const int file = observations.postures[Size(i)].file;
    const bool begins = i == 0 || file != observations.postures[Size(i - 1)].file;
    number = begins ? 1 : number + 1;
    if (i < fault.posture || (i > fault.posture && !begins)) continue;
    names += fmt::format("{}offset:{}@{}{}={:.4f}", names.empty() ? "" : " ", joint,
                         NameInAccept(observations.files[Size(file)]),
                         number > 1 ? fmt::format(":{}", number) : "", size);
  }
  return names;
}

std::vector<char> PosturesOf(const Observations& observations, const std::string& file, int from) {
  std::vector<char> here(Size(observations.posture_count()), 0);
  int number = 0;  // number of the posture in its file
  for (int i = 0; i < observations.posture_count(); ++i) {
    const int of = observations.postures[Size(i)].file;
    const bool begins = i == 0 || of != observations.postures[Size(i - 1)].file;
    number = begins ? 1 : number + 1;
    const bool of_file = file.empty() || NameInAccept(observations.files[Size(of)]) == file;
    here[Size(i)] = of_file && number >= from ? 1 : 0;
  }
  return here;
}

Observations WithRowsOf(const Observations& observations, int further,
                        const std::vector<char>& here) {
  Observations moved = observations;
  std::vector<int> kept;
  for (int i = 0; i < observations.posture_count(); ++i) {
    if (here[Size(i)] == 0) {
      kept.push_back(i);
      continue;
    }
    const int partner = i + further;
    if (partner < 0 || partner >= observations.posture_count()) continue;
    if (observations.postures[Size(partner)].file != observations.postures[Size(i)].file) continue;
    moved.q.row(i) = observations.q.row(partner);
    kept.push_back(i);
  }
  return SelectPostures(moved, kept);
}

bool MeasureAlike(const ObservedRobot& model, int a, int b) {
  const Instrument &first = model.instrument(a), &second = model.instrument(b);
  return !model.IsPlate(a) && !model.IsPlate(b) &&
         std::string_view(first.kind()) == second.kind() &&
         first.measured_size() == second.measured_size();
}

Observations WithLabelsExchanged(const Observations& observations, int a, int b,
                                 const std::vector<char>& here) {
  std::map<int, const Observation*> of_a, of_b;  // by posture
  for (const Observation& observation : observations.all) {
    if (observation.instrument == a) of_a[observation.posture] = &observation;
    if (observation.instrument == b) of_b[observation.posture] = &observation;
  }
  // Effects on the quantities of the other instrument, as in the next posture that it measured (or
  // the last one).
  const auto effects_of = [](const std::map<int, const Observation*>& other, int posture) {
    if (other.empty()) return std::vector<int>();
    const auto next = other.lower_bound(posture);
    return next == other.end() ? other.rbegin()->second->effects : next->second->effects;
  };
  Observations exchanged = observations;
  for (Observation& observation : exchanged.all) {
    const bool is_a = observation.instrument == a;
    if (here[Size(observation.posture)] == 0 || (!is_a && observation.instrument != b)) continue;
    observation.instrument = is_a ? b : a;
    observation.effects = effects_of(is_a ? of_b : of_a, observation.posture);
  }
  return exchanged;
}

}  // namespace elastocal
