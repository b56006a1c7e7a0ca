// SPDX-License-Identifier: Apache-2.0
#include "elastocal/runtime/c_header.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>

#include "elastocal/runtime/number_text.hpp"

namespace elastocal {
namespace {

// Letters and digits of C, whatever the locale of the process counts as such.
bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLower(char c) { return c >= 'a' && c <= 'z'; }
bool IsAlnum(char c) { return IsDigit(c) || IsLower(c) || (c >= 'A' && c <= 'Z'); }

std::string CNumber(double value) {
  if (std::isinf(value)) return value > 0 ? "1e308" : "-1e308";
  return NumberText(value);
}

template <typename List>
std::string NumberList(const List& values) {
  std::string text;
  for (double value : values) text += (text.empty() ? "" : ", ") + CNumber(value);
  return "{" + text + "}";
}

std::string IndexList(const int* values, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + std::to_string(values[i]);
  return "{" + text + "}";
}

std::string PoseText(const ec_pose& pose) {
  return "{" + NumberList(pose.R) + ", " + NumberList(pose.p) + "}";
}

std::string FrameText(const ec_frame& frame) {
  return "{" + std::to_string(frame.body) + ", " + PoseText(frame.pose) + "}";
}

std::string JointText(const ec_joint& joint) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << "{" << joint.parent << ", " << joint.coordinate << ", " << joint.prismatic << ", "
      << CNumber(joint.multiplier) << ", " << CNumber(joint.offset) << ",\n     "
      << PoseText(joint.twisted) << ",\n     " << CNumber(joint.theta) << ", " << CNumber(joint.r)
      << ", " << CNumber(joint.centre) << ", " << NumberList(joint.compliance) << ", "
      << NumberList(joint.root_compliance) << ",\n     " << PoseText(joint.body) << "}";
  return out.str();
}

std::string FootText(const ec_foot& foot) {
  return "{" + FrameText(foot.sole) + ", " + NumberList(foot.centre) + ", " + NumberList(foot.up) +
         ",\n     " + NumberList(foot.compliance) + "}";
}

std::string TipText(const ec_tip& tip) {
  return "{" + FrameText(tip.frame) + ", " + std::to_string(tip.foot) + ", " +
         std::to_string(tip.branch) + ", " + std::to_string(tip.freedom) + ", " +
         std::to_string(tip.yields) + ", " + CNumber(tip.arm) + "}";
}

std::string ShiftText(const ec_shift& shift) {
  return "{" + std::to_string(shift.joint) + ", " + std::to_string(shift.function) + ", " +
         std::to_string(shift.source) + ", " + CNumber(shift.amount) + ", " +
         CNumber(shift.centre) + ", " + CNumber(shift.scale) + "}";
}

std::string UpperName(const std::string& name) {
  std::string upper;
  for (char c : name) {
    upper += !IsAlnum(c) ? '_' : IsLower(c) ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return upper;
}

/// Unique names in C for these names; `NAME_COUNT` is reserved.
std::vector<std::string> UpperNames(const std::vector<std::string>& names) {
  std::set<std::string> taken{"COUNT"};
  std::vector<std::string> upper;
  for (const std::string& name : names) {
    const std::string wanted = UpperName(name);
    upper.push_back(wanted);
    for (int number = 2; !taken.insert(upper.back()).second; ++number) {
      upper.back() = wanted + "_" + std::to_string(number);
    }
  }
  return upper;
}

/// Makes a text safe inside a comment.
std::string CommentText(std::string text) {
  for (std::size_t at = 0; (at = text.find("*/", at)) != std::string::npos;) text[at] = ' ';
  return text;
}

/// Writes one header.
class CHeaderWriter {
 public:
  CHeaderWriter(const Compensator& robot, const CHeaderOptions& options)
      : robot_(robot.robot()), model_(robot.model()), options_(options), name_(options.prefix) {
    out_.imbue(std::locale::classic());  // no separators of thousands
  }

  std::string Write() {
    const std::string guard = UpperName(name_) + "_H";
    out_ << "/* " << CommentText(options_.heading) << " */\n#ifndef " << guard << "\n#define "
         << guard << "\n\n"
         << kRuntimeCore << "\n";
    Indices("Q", model_.coordinate_names, "entries of q");
    Indices("JOINT", model_.joint_names, "entries of torques");
    Indices("LINK", model_.link_names, "entries of the links of forward");
    Indices("TIP", model_.tip_names, "entries of the targets of command_poses");
    Feet();
    Constants();
    Robot();
    State();
    ChoicesOfCommands();
    Functions();
    out_ << "#endif /* " << guard << " */\n";
    return out_.str();
  }

 private:
  void Indices(const char* kind, const std::vector<std::string>& names, const char* what) {
    const std::string begin = UpperName(name_) + "_" + kind + "_";
    out_ << "/* " << what << " */\nenum {\n";
    const std::vector<std::string> upper = UpperNames(names);
    for (std::size_t i = 0; i < names.size(); ++i) {
      out_ << "  " << begin << upper[i] << " = " << i << ",";
      if (upper[i] != UpperName(names[i])) out_ << " /* " << CommentText(names[i]) << " */";
      out_ << "\n";
    }
    out_ << "  " << UpperName(name_) << "_" << kind << "_COUNT = " << names.size() << "\n};\n\n";
  }

  void Feet() {
    out_ << "/* feet that stand, to be added up; 0: the root link is held */\nenum {\n  "
         << UpperName(name_) << "_HELD = 0";
    const std::vector<std::string> upper = UpperNames(model_.foot_names);
    for (std::size_t i = 0; i < upper.size(); ++i) {
      out_ << ",\n  " << UpperName(name_) << "_ON_" << upper[i] << " = " << (1U << i);
    }
    out_ << "\n};\n\n";
  }

  template <typename Items, typename Text>
  void Table(const char* type, const char* name, const Items& items, const Text& text,
             const std::vector<std::string>* names = nullptr) {
    out_ << "static const " << type << " " << name_ << "_" << name << "["
         << std::max<std::size_t>(1, items.size()) << "] = {";
    for (std::size_t i = 0; i < items.size(); ++i) {
      out_ << (i > 0 ? "," : "") << "\n";
      if (names != nullptr) Comments((*names)[i]);
      out_ << "    " << text(items[i]);
    }
    out_ << (items.empty() ? "{0}" : "") << "};\n\n";
  }

  void Comments(const std::string& name) {
    out_ << "    /* " << CommentText(name);
    const auto lines = options_.comments.find(name);
    if (lines != options_.comments.end()) {
      for (const std::string& line : lines->second) out_ << "\n       " << CommentText(line);
    }
    out_ << " */\n";
  }

  void Numbers(const char* name, const double* values, std::size_t count) {
    out_ << "static const double " << name_ << "_" << name << "[" << count << "] = {";
    for (std::size_t i = 0; i < count; ++i) {
      out_ << (i == 0 ? "" : ",") << (i % 6 == 0 ? "\n    " : " ") << CNumber(values[i]);
    }
    out_ << "};\n\n";
  }

  void Whole(const char* name, const int* values, std::size_t count) {
    out_ << "static const int " << name_ << "_" << name << "[" << count
         << "] = " << IndexList(values, count) << ";\n\n";
  }

  void Constants() {
    Table("ec_joint", "nominal", model_.nominal, JointText);
    Table("ec_joint", "calibrated", model_.calibrated, JointText, &model_.joint_names);
    Table("ec_frame", "link", model_.links, FrameText);
    // An empty list gets one entry, which is never read.
    std::vector<ec_foot> feet = model_.feet;
    std::vector<std::string> names = model_.foot_names;
    if (feet.empty()) {
      feet.emplace_back();
      names.emplace_back("none");
    }
    Table("ec_foot", "foot", feet, FootText, &names);
    std::vector<ec_tip> tips = model_.tips;
    if (tips.empty()) tips.emplace_back();
    Table("ec_tip", "tip", tips, TipText);
    std::vector<ec_shift> shifts = model_.shifts;
    if (shifts.empty()) shifts.emplace_back();
    Table("ec_shift", "shift", shifts, ShiftText);
    Numbers("mass", model_.mass.data(), model_.mass.size());
    Numbers("moment", model_.moment.data(), model_.moment.size());
    Numbers("lower", model_.lower.data(), model_.lower.size());
    Numbers("upper", model_.upper.data(), model_.upper.size());
    Whole("leg_of_body", model_.leg_of_body.data(), model_.leg_of_body.size());
    const auto coordinates = static_cast<std::size_t>(robot_.coordinates);
    Whole("branch_of_q", robot_.branch_of_coordinate, coordinates);
    Whole("column_of_q", robot_.column_of_coordinate, coordinates);
    const int none = 0;
    const bool any = robot_.branches > 0;
    Whole("branch_size", any ? robot_.branch_size : &none,
          any ? static_cast<std::size_t>(robot_.branches) : 1);
  }

  void Robot() {
    out_ << "static const ec_robot " << name_ << "_robot = {\n    " << robot_.joints << ", "
         << robot_.coordinates << ", " << robot_.links << ", " << robot_.feet << ", " << robot_.tips
         << ", " << robot_.branches << ", " << robot_.shifts << ",\n    ";
    for (const char* table :
         {"nominal", "calibrated", "mass", "moment", "leg_of_body", "link", "foot", "tip", "shift",
          "branch_of_q", "column_of_q", "branch_size", "lower", "upper"}) {
      out_ << name_ << "_" << table << ", ";
    }
    out_ << "\n    " << CNumber(robot_.total_mass) << ", {" << CNumber(robot_.gravity[0]) << ", "
         << CNumber(robot_.gravity[1]) << ", " << CNumber(robot_.gravity[2]) << "},\n    {";
    for (int i = 0; i < 12; ++i) out_ << (i > 0 ? ", " : "") << CNumber(robot_.suspension[i]);
    out_ << "},\n    " << CNumber(robot_.torque_gain) << ", " << CNumber(robot_.largest_turn)
         << ", " << CNumber(robot_.largest_shift) << ", " << CNumber(robot_.largest_correction)
         << "};\n\n";
  }

  /// An array of the working memory, by its name in ec_memory.
  struct MemoryArray {
    const char* type;
    const char* name;
    int count;
  };

  std::vector<MemoryArray> Memory() const {
    const int joints = robot_.joints, coordinates = robot_.coordinates;
    int largest = 1;
    for (int i = 0; i < robot_.branches; ++i) largest = std::max(largest, robot_.branch_size[i]);
    return {{"ec_pose", "body", joints + 1},
            {"ec_pose", "twisted", joints},
            {"ec_pose", "target", robot_.tips},
            {"ec_pose", "sole", robot_.feet},
            {"double", "motion", 3 * joints},
            {"double", "axis", 3 * joints},
            {"double", "beyond", 4 * (joints + 1)},
            {"double", "load", 3 * joints},
            {"double", "root_load", 3 * joints},
            {"double", "normal", largest * largest},
            {"double", "factor", largest * largest},
            {"double", "gradient", largest},
            {"double", "step", largest},
            {"int", "held", largest},
            {"int", "loosed", largest},
            {"ec_search", "search", robot_.branches},
            {"double", "column", 6 * 64},
            {"double", "good_q", 3 * coordinates},
            {"double", "good_torque", 3 * joints},
            {"double", "work_q", coordinates},
            {"double", "best_q", coordinates},
            {"double", "kept_q", coordinates},
            {"double", "start_q", coordinates},
            {"double", "lowest", coordinates},
            {"double", "highest", coordinates},
            {"double", "most_change", coordinates},
            {"double", "last_q", coordinates},
            {"double", "last_command", coordinates},
            {"double", "given", coordinates},
            {"double", "pace", coordinates},
            {"ec_pose", "last_target", robot_.tips},
            {"unsigned", "stopped", coordinates},
            {"double", "shift", joints},
            {"double", "side", 2 * robot_.shifts},
            {"double", "from", 2 * robot_.shifts},
            {"double", "centre", 3 * robot_.feet},
            {"double", "share", robot_.feet}};
  }

  void State() {
    const std::vector<MemoryArray> memory = Memory();
    out_ << "/* Working memory, last good input and last command of one controller: static or on "
            "its\n   stack. It holds pointers into itself: not to be copied. */\n"
            "typedef struct {\n";
    for (const MemoryArray& array : memory) {
      out_ << "  " << array.type << " " << array.name << "[" << std::max(1, array.count) << "];\n";
    }
    out_ << "  ec_memory memory;\n} " << name_ << "_state;\n\n";
    out_ << "/* To be called once before anything else. */\nstatic inline void " << name_
         << "_init(" << name_ << "_state* s) {\n  ec_memory* m = &s->memory;\n";
    for (const MemoryArray& array : memory) {
      out_ << "  m->" << array.name << " = s->" << array.name << ";\n";
    }
    out_ << "  ec_reset(&" << name_ << "_robot, m);\n}\n\n";
  }

  void ChoicesOfCommands() {
    out_ << "/* No command changes by more from the last one, see ec_limit_changes above. */\n"
            "static inline void "
         << name_ << "_limit_changes(" << name_ << "_state* s, const double* most) {\n"
         << "  ec_limit_changes(&" << name_ << "_robot, most, &s->memory);\n}\n\n";
    out_ << "/* Corrections start and end gently, see ec_ease_changes above. */\n"
            "static inline void "
         << name_ << "_ease_changes(" << name_ << "_state* s, double calls) {\n"
         << "  ec_ease_changes(calls, &s->memory);\n}\n\n";
    out_ << "/* Forgets the last command and all input, see ec_forget above. */\n"
            "static inline void "
         << name_ << "_forget(" << name_ << "_state* s) {\n"
         << "  ec_forget(&" << name_ << "_robot, &s->memory);\n}\n\n";
    out_ << "/* Begins from the command at which the drives are, see ec_start_from above. */\n"
            "static inline int "
         << name_ << "_start_from(" << name_ << "_state* s, const double* command) {\n"
         << "  return ec_start_from(&" << name_ << "_robot, command, &s->memory);\n}\n\n";
  }

  void Functions() {
    const std::string state = name_ + "_state* s", robot = "&" + name_ + "_robot";
    out_ << "/* See ec_forward, ec_correct, ec_command and ec_command_poses above. */\n";
    out_ << "static inline unsigned " << name_ << "_forward(" << state
         << ", const double* q, const double* torque,\n    unsigned feet, ec_pose* links, "
            "ec_pose* root) {\n  return ec_forward("
         << robot << ", q, torque, feet, &s->memory, links, root);\n}\n\n";
    out_ << "static inline unsigned " << name_ << "_correct(" << state
         << ", const double* q, const double* torque,\n    unsigned feet, double* rigid, double* "
            "displacement) {\n  return ec_correct("
         << robot << ", q, torque, feet, &s->memory, rigid, displacement);\n}\n\n";
    out_ << "static inline unsigned " << name_ << "_command(" << state
         << ", const double* nominal, const double* torque,\n    unsigned feet, double* command, "
            "double* residual) {\n  return ec_command("
         << robot << ", nominal, torque, feet, &s->memory, command, residual);\n}\n\n";
    out_ << "static inline unsigned " << name_ << "_command_poses(" << state
         << ", const ec_pose* targets,\n    const double* nominal, const double* torque, unsigned "
            "feet, double* command,\n    double* residual) {\n  return ec_command_poses("
         << robot << ", targets, nominal, torque, feet, &s->memory, command, residual);\n}\n\n";
  }

  const ec_robot& robot_;
  const RuntimeModel& model_;
  const CHeaderOptions& options_;
  const std::string name_;
  std::ostringstream out_;
};

}  // namespace

bool IsCName(const std::string& name) {
  const auto fits = [](char c) { return IsAlnum(c) || c == '_'; };
  return !name.empty() && !IsDigit(name[0]) && std::all_of(name.begin(), name.end(), fits);
}

std::string MakeCHeader(RuntimeModel model, const CHeaderOptions& options) {
  if (!IsCName(options.prefix)) {
    throw std::invalid_argument("prefix '" + options.prefix + "': no C name");
  }
  const Compensator robot(std::move(model), options.limits);
  return CHeaderWriter(robot, options).Write();
}

}  // namespace elastocal
