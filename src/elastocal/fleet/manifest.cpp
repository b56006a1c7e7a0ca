// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/manifest.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr int kMostTasks = 1'000'000;
constexpr std::size_t kLongestName = 100;

/// Settings that all tasks of a manifest share.
struct Common {
  fs::path folder, output, project;
  std::vector<std::string> calibrate;
};

void ExpectName(const YamlValue& value, const std::string& name) {
  const bool fine = !name.empty() && name.size() <= kLongestName && name.front() != '.' &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-';
                    });
  value.Expect(fine, "a name of letters, digits, '_', '.' and '-', not beginning with '.'");
}

fs::path PathOf(const YamlValue& value, const fs::path& folder) {
  return (folder / value.Text()).lexically_normal();
}

/// Options of a command line: `{kfold: 10, elastic: true}` as `--kfold 10 --elastic`. Files are
/// relative to `folder`.
std::vector<std::string> ReadWords(const std::optional<YamlValue>& options,
                                   const fs::path& folder) {
  const std::set<std::string> files{"prior", "postures", "motion", "settings", "marker-places"};
  std::vector<std::string> words;
  if (!options) return words;
  for (const auto& [key, value] : options->Entries()) {
    const bool taken = key == "recording" || key == "output" || key == "json";
    options->Expect(!taken, "options that the batch does not set itself (" + key + ")");
    if (value.IsScalar() && files.contains(key)) {
      words.insert(words.end(), {"--" + key, PathOf(value, folder).string()});
    } else if (value.IsScalar() && value.Text() == "true") {
      words.push_back("--" + key);
    } else if (value.IsScalar()) {
      words.insert(words.end(), {"--" + key, value.Text()});
    } else {
      words.push_back("--" + key);
      for (const YamlValue& item : value.Items()) words.push_back(item.Text());
    }
  }
  return words;
}

std::vector<std::string> CalibrateWords(const FleetTask& task, const fs::path& results,
                                        const std::vector<std::string>& more) {
  std::vector<std::string> words = {"calibrate", task.project.string(), "--recording"};
  for (const fs::path& recording : task.recordings) words.push_back(recording.string());
  words.insert(words.end(), {"-o", results.string(), "--threads", "1"});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Forms in which the days of sessions are given. Only one may occur, because differences count.
struct DayKinds {
  bool dates = false, numbers = false;
};

/// Reads a day: a number from any origin, or a date, which becomes days since 1970.
double ReadDay(const YamlValue& value, DayKinds& kinds) {
  const std::string text = value.Text();
  int year = 0, month = 0, day = 0, length = 0;
  if (std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &length) == 3 &&
      static_cast<std::size_t>(length) == text.size()) {
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    value.Expect(date.ok(), "a day of the calendar");
    kinds.dates = true;
    value.Expect(!kinds.numbers, "a number of days, as the sessions above have");
    return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
  }
  value.Expect(ParseNumber(text).has_value(), "a number of days, or a date like 2026-03-31");
  kinds.numbers = true;
  value.Expect(!kinds.dates, "a date, as the sessions above have");
  return value.Number();
}

FleetTask ReadSession(const YamlValue& item, const Common& common, DayKinds& days) {
  item.ExpectKeys({"name", "robot", "batch", "day", "project", "recording", "calibrate"});
  FleetTask task;
  task.name = item.Get("name").Text();
  task.project = common.project;
  ExpectName(item.Get("name"), task.name);
  task.robot = item.Find("robot") ? item.Get("robot").Text() : task.name;
  if (const auto batch = item.Find("batch")) task.batch = batch->Text();
  if (const auto day = item.Find("day")) task.day = ReadDay(*day, days);
  if (const auto project = item.Find("project")) task.project = PathOf(*project, common.folder);
  if (task.project.empty()) item.Fail("no key 'project', neither here nor for all");
  const YamlValue recording = item.Get("recording");
  if (recording.IsScalar()) {
    task.recordings = {PathOf(recording, common.folder)};
  } else {
    for (const YamlValue& one : recording.Items()) {
      task.recordings.push_back(PathOf(one, common.folder));
    }
  }
  recording.Expect(!task.recordings.empty(), "a file or folder, or a list of them");
  std::vector<std::string> words = common.calibrate;
  const std::vector<std::string> own = ReadWords(item.Find("calibrate"), common.folder);
  words.insert(words.end(), own.begin(), own.end());
  task.commands = {CalibrateWords(task, common.output / task.name, words)};
  return task;
}

/// Adds the tasks of a study: all its robots with each of its settings.
void ReadStudy(const YamlValue& item, const Common& common, std::vector<FleetTask>& tasks) {
  item.ExpectKeys({"name", "robots", "first", "batch", "project", "simulate", "calibrate",
                   "settings", "keep_recordings"});
  const std::string study = item.Get("name").Text();
  ExpectName(item.Get("name"), study);
  const auto robots = item.Get("robots").Integer(1, kMostTasks);
  const auto first = item.Find("first") ? item.Get("first").Integer(0, 1'000'000'000) : 1;
  const bool keep = item.Find("keep_recordings") && item.Get("keep_recordings").Boolean();
  const std::vector<std::string> simulate = ReadWords(item.Find("simulate"), common.folder);
  std::vector<std::string> calibrate = common.calibrate;
  const std::vector<std::string> own = ReadWords(item.Find("calibrate"), common.folder);
  calibrate.insert(calibrate.end(), own.begin(), own.end());
  struct Setting {
    std::string name;
    std::vector<std::string> simulate, calibrate;
  };
  std::vector<Setting> settings;
  if (const auto list = item.Find("settings")) {
    for (const YamlValue& one : list->Items()) {
      one.ExpectKeys({"name", "simulate", "calibrate"});
      ExpectName(one.Get("name"), one.Get("name").Text());
      settings.push_back({one.Get("name").Text(), ReadWords(one.Find("simulate"), common.folder),
                          ReadWords(one.Find("calibrate"), common.folder)});
    }
  }
  if (settings.empty()) settings.push_back({});
  for (auto seed = first; seed < first + robots; ++seed) {
    for (const Setting& setting : settings) {
      const std::string number = std::to_string(seed);
      FleetTask task;
      task.robot = study + "_" + number;
      task.project = common.project;
      task.name = task.robot + (setting.name.empty() ? "" : "_" + setting.name);
      if (const auto batch = item.Find("batch")) task.batch = batch->Text();
      if (const auto project = item.Find("project")) {
        task.project = PathOf(*project, common.folder);
      }
      if (task.project.empty()) item.Fail("no key 'project', neither here nor for all");
      const fs::path results = common.output / task.name;
      const fs::path recording = common.output / (task.name + "_recording");
      std::vector<std::string> words = {"simulate",     task.project.string(),
                                        "-o",           recording.string(),
                                        "--robot-seed", number,
                                        "--seed",       number,
                                        "--threads",    "1"};
      words.insert(words.end(), simulate.begin(), simulate.end());
      words.insert(words.end(), setting.simulate.begin(), setting.simulate.end());
      std::vector<std::string> more = calibrate;
      more.insert(more.end(), setting.calibrate.begin(), setting.calibrate.end());
      FleetTask played = task;
      played.recordings = {recording};
      task.commands = {words, CalibrateWords(played, results, more)};
      if (!keep) task.leftovers = {recording};
      tasks.push_back(std::move(task));
    }
  }
}

}  // namespace

std::vector<FleetTask> ReadManifest(const fs::path& file, const fs::path& output) {
  const YamlValue root = YamlValue::Parse(ReadFile(file), file.string());
  root.ExpectKeys({"project", "calibrate", "sessions", "studies"});
  Common common{.folder = file.parent_path(), .output = output, .project = {}, .calibrate = {}};
  if (const auto project = root.Find("project")) common.project = PathOf(*project, common.folder);
  common.calibrate = ReadWords(root.Find("calibrate"), common.folder);
  std::vector<FleetTask> tasks;
  if (const auto sessions = root.Find("sessions")) {
    DayKinds days;
    for (const YamlValue& item : sessions->Items()) {
      tasks.push_back(ReadSession(item, common, days));
    }
  }
  if (const auto studies = root.Find("studies")) {
    for (const YamlValue& item : studies->Items()) ReadStudy(item, common, tasks);
  }
  if (tasks.empty()) root.Fail("no task: 'sessions' or 'studies' were expected");
  std::set<std::string> names;
  for (const FleetTask& task : tasks) {
    if (!names.insert(task.name).second) root.Fail("two tasks are called '" + task.name + "'");
  }
  return tasks;
}

}  // namespace elastocal
