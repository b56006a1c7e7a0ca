// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <type_traits>

#include "elastocal/runtime/number_text.hpp"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {
namespace {

constexpr const char* kKind = "elastocal-runtime-model ";
constexpr int kFormat = 5;
constexpr int kMost = 10000;  // entries of a list; a robot has some dozens

// One description of the file serves both directions: `archive(name, value)` writes a line, or
// reads it and checks the name.

class Writer {
 public:
  explicit Writer(std::ostream& out) : out_(out) {}

  void operator()(const char* name, std::string& text) { out_ << name << ' ' << text << '\n'; }
  void operator()(const char* name, double& value) {
    Begin(name);
    Value(value);
    out_ << '\n';
  }
  template <typename Item>
  void operator()(const char* name, std::vector<Item>& items) {
    Begin(name);
    out_ << ' ' << std::to_string(items.size()) << '\n';
    for (Item& item : items) {
      Items(*this, item);
      out_ << '\n';
    }
  }

  // Numbers are texts before they come to the stream, whose locale may have decimal commas.
  void Value(double& value) { out_ << ' ' << NumberText(value); }
  void Value(int& value) { out_ << ' ' << std::to_string(value); }
  void Name(std::string& name) { out_ << ' ' << name; }

 private:
  void Begin(const char* name) { out_ << name; }
  std::ostream& out_;
};

class Reader {
 public:
  Reader(std::istream& in, std::string source) : in_(in), source_(std::move(source)) {}

  void operator()(const char* name, std::string& text) {
    Begin(name);
    std::getline(in_ >> std::ws, text);
  }
  void operator()(const char* name, double& value) {
    Begin(name);
    Value(value);
  }
  template <typename Item>
  void operator()(const char* name, std::vector<Item>& items) {
    Begin(name);
    int count = -1;
    Value(count);
    if (count < 0 || count > kMost) Fail(std::to_string(count), "a number of entries up to 10000");
    items.resize(static_cast<std::size_t>(count));
    for (Item& item : items) Items(*this, item);
  }

  template <typename Number>
  void Value(Number& value) {
    constexpr bool kWhole = std::is_integral_v<Number>;
    std::string word;
    Value(word);
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    bool good = error == std::errc() && stop == end;
    if constexpr (!kWhole) {
      const bool may_be_infinite = name_ == "lower" || name_ == "upper";
      good = good && (may_be_infinite ? !std::isnan(value) : std::isfinite(value));
    }
    if (!good) Fail("'" + word + "'", kWhole ? "a whole number" : "a number that is finite");
  }
  void Value(std::string& value) {
    value.clear();
    if (!(in_ >> value)) Fail("the end of the file", "a value");
  }

  /// Reads the rest of the line, because a name may contain blanks.
  void Name(std::string& name) {
    if (!std::getline(in_ >> std::ws, name)) Fail("the end of the file", "a name");
    while (!name.empty() && name.back() == '\r') name.pop_back();
  }

  [[noreturn]] void Fail(const std::string& found, const std::string& expected) const {
    throw std::runtime_error(source_ + ": entry '" + name_ + "': found " + found + "; " + expected +
                             " was expected");
  }
  void Check(bool good, const char* name, const std::string& expected) {
    name_ = name;
    if (!good) Fail("something else", expected);
  }
  void CheckLimits(const std::string& coordinate, double lower, double upper) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    name_ = "upper";
    if (lower > upper) {
      Fail(NumberText(upper) + " for '" + coordinate + "'",
           "at least " + NumberText(lower) + ", which is its entry of 'lower',");
    }
    if (lower == kInfinity || upper == -kInfinity) {
      Fail("'" + coordinate + "' from " + NumberText(lower) + " to " + NumberText(upper),
           "a range of positions");
    }
  }

 private:
  void Begin(const char* name) {
    name_ = name;
    while ((in_ >> std::ws).peek() == '#') {
      in_.ignore(std::numeric_limits<std::streamsize>::max(), '\n');  // a comment
    }
    std::string word;
    Value(word);
    if (word != name) Fail("'" + word + "'", "this entry");
  }

  std::istream& in_;
  std::string source_, name_;
};

template <typename Archive>
void Items(Archive& archive, ec_pose& pose) {
  for (double& value : pose.R) archive.Value(value);
  for (double& value : pose.p) archive.Value(value);
}

template <typename Archive, typename Scalar>
requires std::is_arithmetic_v<Scalar>
void Items(Archive& archive, Scalar& value) { archive.Value(value); }

template <typename Archive>
void Items(Archive& archive, std::string& name) {
  archive.Name(name);
}

template <typename Archive>
void Items(Archive& archive, ec_frame& frame) {
  archive.Value(frame.body);
  Items(archive, frame.pose);
}

template <typename Archive>
void Items(Archive& archive, ec_joint& joint) {
  archive.Value(joint.parent);
  archive.Value(joint.coordinate);
  archive.Value(joint.prismatic);
  archive.Value(joint.multiplier);
  archive.Value(joint.offset);
  Items(archive, joint.twisted);
  archive.Value(joint.theta);
  archive.Value(joint.r);
  archive.Value(joint.centre);
  for (double& value : joint.compliance) archive.Value(value);
  for (double& value : joint.root_compliance) archive.Value(value);
  Items(archive, joint.body);
}

template <typename Archive>
void Items(Archive& archive, ec_foot& foot) {
  Items(archive, foot.sole);
  for (double& value : foot.centre) archive.Value(value);
  for (double& value : foot.up) archive.Value(value);
  for (double& value : foot.compliance) archive.Value(value);
}

template <typename Archive>
void Items(Archive& archive, ec_tip& tip) {
  Items(archive, tip.frame);
  archive.Value(tip.foot);
}

template <typename Archive>
void Items(Archive& archive, ec_shift& shift) {
  archive.Value(shift.joint);
  archive.Value(shift.function);
  archive.Value(shift.source);
  archive.Value(shift.amount);
  archive.Value(shift.centre);
  archive.Value(shift.scale);
}

template <typename Archive>
void Entries(Archive& archive, RuntimeModel& model) {
  archive("robot", model.robot);
  archive("calibration", model.calibration);
  archive("fingerprint", model.fingerprint);
  archive("gravity", model.gravity);
  archive("suspension", model.suspension);
  archive("joints", model.joint_names);
  archive("coordinates", model.coordinate_names);
  archive("links", model.link_names);
  archive("feet", model.foot_names);
  archive("tips", model.tip_names);
  archive("nominal", model.nominal);
  archive("calibrated", model.calibrated);
  archive("mass", model.mass);
  archive("moment", model.moment);
  archive("leg_of_body", model.leg_of_body);
  archive("link", model.links);
  archive("foot", model.feet);
  archive("tip", model.tips);
  archive("shift", model.shifts);
  archive("lower", model.lower);
  archive("upper", model.upper);
}

bool Within(int index, std::size_t size) { return index >= 0 && index < static_cast<int>(size); }

bool GoodJoints(const std::vector<ec_joint>& joints, std::size_t coordinates) {
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (!Within(joints[k].parent, k + 1) || !Within(joints[k].coordinate, coordinates))
      return false;
    if (!std::isfinite(joints[k].theta + joints[k].r + joints[k].multiplier)) return false;
  }
  return true;
}

void CheckSizes(const RuntimeModel& model, Reader& reader) {
  const std::size_t joints = model.joint_names.size(), bodies = joints + 1;
  const std::size_t coordinates = model.coordinate_names.size();
  const auto good_frame = [&](const ec_frame& frame) { return Within(frame.body, bodies); };
  reader.Check(joints > 0, "joints", "at least one");
  reader.Check(model.nominal.size() == joints && GoodJoints(model.nominal, coordinates), "nominal",
               "an entry for each joint, each behind the one that carries it");
  reader.Check(model.calibrated.size() == joints && GoodJoints(model.calibrated, coordinates),
               "calibrated", "an entry for each joint, each behind the one that carries it");
  reader.Check(model.gravity.size() == 3, "gravity", "three numbers");
  reader.Check(model.suspension.size() == 12, "suspension", "twelve numbers");
  reader.Check(model.mass.size() == bodies, "mass", "an entry for each body");
  reader.Check(model.moment.size() == 3 * bodies, "moment", "three entries for each body");
  reader.Check(model.leg_of_body.size() == bodies, "leg_of_body", "an entry for each body");
  reader.Check(model.links.size() == model.link_names.size(), "link", "an entry for each link");
  for (const ec_frame& link : model.links) reader.Check(good_frame(link), "link", "a body");
  reader.Check(model.feet.size() == model.foot_names.size() && model.feet.size() <= 32, "foot",
               "an entry for each of at most 32 feet");
  for (const ec_foot& foot : model.feet) reader.Check(good_frame(foot.sole), "foot", "a body");
  reader.Check(model.tips.size() == model.tip_names.size(), "tip", "an entry for each tip");
  for (const ec_tip& tip : model.tips) {
    reader.Check(good_frame(tip.frame) && tip.frame.body > 0 && tip.foot >= -1 &&
                     tip.foot < model.foot_count(),
                 "tip", "a body beyond the root link, and a foot or -1");
  }
  for (const ec_shift& shift : model.shifts) {
    reader.Check(Within(shift.joint, joints) && Within(shift.source, joints) &&
                     shift.function >= EC_SIN && shift.function <= EC_HYSTERESIS &&
                     shift.scale > 0.0 && std::isfinite(shift.amount + shift.centre),
                 "shift",
                 "a joint, a function of the posture that this library knows (another version of "
                 "elastocal may know more), and numbers");
  }
  reader.Check(model.lower.size() == coordinates && model.upper.size() == coordinates, "lower",
               "an entry for each coordinate");
  for (std::size_t c = 0; c < coordinates; ++c) {
    reader.CheckLimits(model.coordinate_names[c], model.lower[c], model.upper[c]);
  }
}

}  // namespace

void WriteRuntimeModel(const RuntimeModel& model, std::ostream& out) {
  out << kKind << kFormat << '\n';
  Writer writer(out);
  RuntimeModel copy = model;
  Entries(writer, copy);
  out << "end\n";
}

RuntimeModel ReadRuntimeModel(std::istream& in, const std::string& source) {
  std::string heading;
  std::getline(in, heading);
  while (!heading.empty() && heading.back() == '\r') heading.pop_back();
  if (const std::string expected = kKind + std::to_string(kFormat); heading != expected) {
    std::string message =
        source + ": line 1: '" + expected + "' was expected (elastocal export --format runtime)";
    if (heading.rfind(kKind, 0) == 0) {
      message += "; found '" + heading +
                 "': export it again by an elastocal of the same version as this library";
    }
    throw std::runtime_error(message);
  }
  RuntimeModel model;
  Reader reader(in, source);
  Entries(reader, model);
  std::string end;
  in >> end;
  reader.Check(end == "end", "end", "this word: the file was cut");
  CheckSizes(model, reader);
  return model;
}

RuntimeModel ReadRuntimeModel(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return ReadRuntimeModel(in, file.string());
}

}  // namespace elastocal
