#include "elastocal/cli/session.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace elastocal::cli {
namespace {

/// Markers that were seen at least once.
std::vector<int> SeenMarkers(const Recording& recording) {
  std::vector<int> seen;
  for (int m = 0; m < recording.marker_count(); ++m) {
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!Seen(recording, i, m)) continue;
      seen.push_back(m);
      break;
    }
  }
  return seen;
}

void LeaveOutUnseen(Recording& recording, std::vector<std::string>& warnings) {
  const std::vector<int> seen = SeenMarkers(recording);
  std::vector<std::string> names;
  std::vector<int> columns;
  for (int m : seen) {
    names.push_back(recording.marker_names[m]);
    for (int i = 0; i < 3; ++i) columns.push_back(3 * m + i);
  }
  for (const std::string& name : recording.marker_names) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      warnings.push_back("marker " + name + " was never seen and is left out");
    }
  }
  recording.markers = Eigen::MatrixXd(recording.markers(Eigen::all, columns));
  recording.marker_names = names;
}

void WarnOfLostRank(const ErrorModel& model, const IdentifiabilityOptions& options,
                    const BaseParameters& base, std::vector<std::string>& warnings) {
  if (static_cast<int>(base.kept.size()) >= base.theoretical_count || !base.held.empty()) return;
  warnings.push_back(fmt::format(
      "only {} of {} parameters are identifiable: the nominal marker positions are special (on a "
      "joint axis?). Lost: {}. Give markers positions off the axes, however rough.",
      base.kept.size(), base.theoretical_count,
      JoinNames(model.parameters, LostBySpecialMarkers(model, options))));
}

}  // namespace

Session OpenSession(const std::filesystem::path& project, const std::filesystem::path& recording) {
  Session session;
  session.project = ReadProject(project);
  PostureTable table = ReadPostureTable(recording, session.project);
  session.recording = std::move(table.recording);
  session.warnings = std::move(table.warnings);
  LeaveOutUnseen(session.recording, session.warnings);
  const ErrorModel all =
      MakeErrorModel(session.project.tree, session.project.markers, session.project.placement);
  session.model = SelectMarkers(all, session.recording.marker_names);
  const IdentifiabilityOptions& options = session.project.identifiability;
  session.base = FindBaseParameters(session.model, options);
  WarnOfLostRank(session.model, options, session.base, session.warnings);
  return session;
}

Progress TerminalProgress(const std::string& what, bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [what](int done, int total) {
    fmt::print(stderr, "\r{} {}/{}", what, done, total);
    if (done == total) fmt::print(stderr, "\r{:{}}\r", "", what.size() + 20);
    std::fflush(stderr);
  };
}

void Print(bool quiet, const std::string& text) {
  if (!quiet) fmt::print("{}", text);
}

void PrintWarnings(bool quiet, const std::vector<std::string>& warnings) {
  if (quiet) return;
  for (const std::string& warning : warnings) spdlog::warn("{}", warning);
}

double InUserUnits(const Parameter& parameter, double value) {
  return value * (parameter.unit == ParameterUnit::kRadian ? 180.0 / M_PI : 1e3);
}

const char* UserUnit(const Parameter& parameter) {
  return parameter.unit == ParameterUnit::kRadian ? "deg" : "mm";
}

std::string JoinNames(const std::vector<Parameter>& parameters, const std::vector<int>& which) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (int i : which) {
    const std::string& name = parameters[i].name;
    const std::size_t dot = name.rfind('.');
    const std::string owner = name.substr(0, dot);
    if (groups.empty() || groups.back().first != owner) groups.push_back({owner, ""});
    std::string& constants = groups.back().second;
    constants += (constants.empty() ? "" : ",") + name.substr(dot + 1);
  }
  std::string text;
  for (const auto& [owner, constants] : groups) {
    text += (text.empty() ? "" : ", ") + owner + "." +
            (constants.find(',') == std::string::npos ? constants : "{" + constants + "}");
  }
  return text;
}

}  // namespace elastocal::cli
