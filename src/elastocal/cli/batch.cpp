// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/mpi_ranks.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/progress.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/fleet/batch_lock.hpp"
#include "elastocal/fleet/fleet_report.hpp"
#include "elastocal/fleet/task_process.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/report/page.hpp"
#include "elastocal/robot/parameters.hpp"

namespace elastocal::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFindings = 10;

struct BatchCommand {
  CommonOptions common;
  std::string manifest, output;
  int workers = 0;  ///< 0: one for each core, or under mpirun one for each rank
  double level = 0.05;
};

volatile std::sig_atomic_t interrupted = 0;  // 0, or the number of the signal

/// State of a batch at Ctrl-C; finished tasks are kept.
struct BatchInterrupted {
  int done = 0, all = 0;
};

/// Makes Ctrl-C visible to RunTasks, unless it is ignored (nohup, a shell in the background). A
/// second Ctrl-C ends the program at once.
void WatchInterruption() {
  for (const int number : {SIGINT, SIGTERM}) {
    struct sigaction action {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action.sa_handler = [](int signal) { interrupted = signal; };
    action.sa_flags = SA_RESETHAND;
    sigaction(number, &action, nullptr);
  }
}

/// Prints the progress and ends as the signal would have ended the program. (mpirun, which then
/// ends its ranks, mostly drops their last output.)
[[noreturn]] void EndInterrupted(const BatchInterrupted& at) {
  spdlog::warn("interrupted: {} of {} tasks are done; the same command does the rest", at.done,
               at.all);
  std::signal(interrupted, SIG_DFL);
  std::raise(interrupted);
  std::abort();
}

/// Refuses a folder that is neither empty nor that of an earlier run of a batch.
void CheckFolder(const fs::path& output) {
  std::error_code error;
  if (!fs::exists(output, error) || fs::is_empty(output, error)) return;
  if (!fs::is_directory(output, error)) throw InputError(output.string() + ": is no folder");
  for (const auto& entry : fs::directory_iterator(output, error)) {
    if (entry.path().filename() == "fleet.json") return;
    if (entry.path().string().ends_with(".done.json")) return;
    if (entry.path().filename() == ".batch") return;
    if (entry.path().filename() == kBatchLockName) return;
  }
  throw InputError(
      output.string() +
      ": holds other things; an empty folder was expected, or that of an earlier batch");
}

/// Throws InputError for a word in the manifest that a command does not know. This happens before
/// the first task, because the last one may start days later.
void RefuseUnknownWords(const std::string& manifest, const std::vector<FleetTask>& tasks) {
  for (const FleetTask& task : tasks) {
    for (const std::vector<std::string>& words : task.commands) {
      const std::string error = UsageErrorOf(words);
      if (error.empty()) continue;
      throw InputError(manifest + ": task '" + task.name + "': " + words.front() + ": " + error);
    }
  }
}

std::vector<std::unique_ptr<TaskSlot>> LocalSlots(int count, const fs::path& output,
                                                  const std::vector<FleetTask>& tasks) {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  std::vector<std::unique_ptr<TaskSlot>> slots;
  for (int i = 0; i < count; ++i) {
    slots.push_back(std::make_unique<TaskProcess>(program, output, tasks));
  }
  return slots;
}

bool HasResult(const TaskEnd& end) { return end.exit_code == 0 || end.exit_code == 4; }

/// Does the tasks that are not done yet, and returns how each task ended.
std::vector<TaskEnd> DoTasks(const BatchCommand& command, const std::vector<FleetTask>& tasks,
                             MpiRanks* ranks) {
  const fs::path output = command.output;
  std::vector<TaskEnd> ends(tasks.size());
  std::vector<int> open;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    if (const auto before = EndedBefore(tasks[t], output)) {
      ends[t] = *before;
    } else {
      open.push_back(static_cast<int>(t));
    }
  }
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int local = command.workers > 0 ? command.workers : ranks != nullptr ? 1 : cores;
  std::vector<std::unique_ptr<TaskSlot>> slots = LocalSlots(local, output, tasks);
  if (ranks != nullptr) {
    for (auto& slot : ranks->OtherRanks()) slots.push_back(std::move(slot));
  }
  const auto progress = TerminalProgress("done", command.common.Silent());
  int done = static_cast<int>(tasks.size() - open.size());
  const auto all = static_cast<int>(tasks.size());
  if (progress) progress(done, all);
  WatchInterruption();
  int with_result = done;
  const auto ended = [&](int task, const TaskEnd& end) {
    ends[static_cast<std::size_t>(task)] = end;
    with_result += HasResult(end) ? 1 : 0;
    if (progress) progress(++done, all);
  };
  const auto stop = [&] {
    if (interrupted != 0) throw BatchInterrupted{with_result, all};
    return false;
  };
  RunTasks(open, slots, {.ended = ended, .stop = stop});
  return ends;
}

std::string InUnits(const std::string& unit, double value) {
  if (unit == "rad") return fmt::format("{:.3f} deg", 180.0 / M_PI * value);
  if (unit == "m") return fmt::format("{:.3f} mm", 1e3 * value);
  if (unit == "rad/(N.m)") return fmt::format("{:.1f} urad/(N.m)", 1e6 * value);
  if (unit == "m/N") return fmt::format("{:.2f} um/N", 1e6 * value);
  return fmt::format("{:.3g} {}", value, unit);
}

std::string DescribeFamily(const FleetReport& report) {
  const FleetFamily& family = report.family;
  std::string text;
  const auto list = [&](const char* title, std::size_t count, const auto& line) {
    if (count == 0) return;
    text += fmt::format("{}\n", title);
    for (std::size_t i = 0; i < std::min(count, kMostFindings); ++i) text += "  " + line(i) + "\n";
    if (count > kMostFindings) text += fmt::format("  and {} more\n", count - kMostFindings);
  };
  list("Out of family", family.out_of_family.size(), [&](std::size_t i) {
    const OutOfFamily& one = family.out_of_family[i];
    return fmt::format("{}: {} is {}, the others {} +- {} (p {:.1g})", one.robot, one.parameter,
                       InUnits(one.unit, one.value), InUnits(one.unit, one.family),
                       InUnits(one.unit, one.sd), one.p_adjusted);
  });
  list("Batches unlike the others", family.batches.size(), [&](std::size_t i) {
    const BatchDifference& one = family.batches[i];
    return fmt::format("{}: {} differs by {} +- {} (p {:.1g})", one.batch, one.parameter,
                       InUnits(one.unit, one.difference), InUnits(one.unit, one.sd),
                       one.p_adjusted);
  });
  list("Drift", family.drifts.size(), [&](std::size_t i) {
    const ParameterDrift& one = family.drifts[i];
    return fmt::format("{}: {} by {} in 30 days, +- {} (p {:.1g})", one.robot, one.parameter,
                       InUnits(one.unit, 30.0 * one.per_day), InUnits(one.unit, 30.0 * one.sd),
                       one.p_adjusted);
  });
  if (!family.workshop.empty()) {
    text += fmt::format("Need a workshop: {}\n", FirstOf(family.workshop, kMostFindings));
  }
  return text;
}

/// The last error message in a log, or else its first line; empty where it has none.
std::string ErrorOf(const fs::path& log) {
  constexpr std::string_view kError = "error: ";
  std::ifstream lines(log);
  std::string first, error;
  for (std::string line; std::getline(lines, line);) {
    if (first.empty()) first = line;
    const std::size_t at = line.find(kError);
    if (at != std::string::npos) error = line.substr(at + kError.size());
  }
  return error.empty() ? first : error;
}

/// The reasons why tasks failed, for the first few with different reasons.
std::string DescribeFailures(const std::vector<std::string>& failed, const fs::path& output) {
  constexpr std::size_t kMostReasons = 5;
  std::string text = fmt::format("Failed (see {}/NAME.log): {}\n", output.string(),
                                 FirstOf(failed, kMostFindings));
  std::set<std::string> reasons;
  for (const std::string& name : failed) {
    const std::string reason = ErrorOf(output / (name + ".log"));
    if (reason.empty() || !reasons.insert(reason).second) continue;
    text += fmt::format("  {}: {}\n", name, reason);
    if (reasons.size() == kMostReasons) break;
  }
  return text;
}

std::string DescribeReport(const FleetReport& report, const fs::path& output) {
  int fine = 0;
  std::vector<std::string> refused, failed;
  double seconds = 0.0;
  for (const SessionOutcome& session : report.sessions) {
    seconds += session.end.seconds;
    const int exit_code = session.end.exit_code;
    fine += exit_code == 0 ? 1 : 0;
    if (exit_code == 4) refused.push_back(session.task->name);
    if (exit_code != 0 && exit_code != 4) failed.push_back(session.task->name);
  }
  std::string text =
      fmt::format("{} tasks: {} to be deployed, {} not, {} failed; {:.0f} s of work\n",
                  report.sessions.size(), fine, refused.size(), failed.size(), seconds);
  if (!refused.empty()) {
    text += fmt::format("Not to be deployed (see {}/NAME.log): {}\n", output.string(),
                        FirstOf(refused, kMostFindings));
  }
  if (!failed.empty()) text += DescribeFailures(failed, output);
  if (report.robots > 0) {
    text += fmt::format("{} robots", report.robots);
    if (std::isfinite(report.family.median_error)) {
      text += fmt::format("; half of their URDFs err by less than {} mm",
                          Millimetres(report.family.median_error, 3));
    }
    text += "\n";
  }
  text += DescribeFamily(report);
  if (!PageTemplate().empty())
    text += fmt::format("Report: {}\n", (output / "fleet.html").string());
  if (!report.prior.parameters.empty()) {
    text += fmt::format("Prior for the next robot: calibrate --prior {} --days 0\n",
                        (output / "prior").string());
  }
  return text;
}

int Batch(const BatchCommand& command) {
  const fs::path output = command.output;
  const std::unique_ptr<MpiRanks> ranks = MpiRanks::Join();
  const std::vector<FleetTask> tasks =
      ReadManifest(command.manifest, fs::absolute(output).lexically_normal());
  if (ranks && ranks->rank() > 0) {
    const auto slots = LocalSlots(1, output, tasks);
    ranks->Serve(*slots.front());
    return kFine;
  }
  std::optional<FleetReport> report;
  try {
    OutputSet outputs;
    outputs.Protect({command.manifest});
    RefuseUnknownWords(command.manifest, tasks);
    CheckFolder(output);
    for (const fs::path& name : FleetFileNames()) outputs.Declare(output / name);
    outputs.Declare(output / ".batch");
    DeclareJson(command.common.json_file, outputs);
    outputs.Prepare();
    const BatchLock lock(output);
    const std::vector<TaskEnd> ends = DoTasks(command, tasks, ranks.get());
    report = MakeFleetReport(tasks, ends, output, command.level);
    const std::vector<std::string> files = MakeFleetFiles(*report);
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (!files[i].empty()) outputs.Set(output / FleetFileNames()[i], files[i]);
    }
    outputs.Set(output / ".batch", fs::absolute(command.manifest).filename().string() + "\n");
    outputs.Set(command.common.json_file, files.front());
    outputs.Publish();
  } catch (const BatchInterrupted& at) {
    EndInterrupted(at);
  } catch (...) {
    if (ranks) ranks->Dismiss();
    throw;
  }
  if (ranks) ranks->Dismiss();
  Print(command.common.Silent(), DescribeReport(*report, output));
  PrintWarnings(report->notes, command.common.verbose);
  const bool all = std::all_of(report->sessions.begin(), report->sessions.end(),
                               [](const SessionOutcome& one) { return HasResult(one.end); });
  if (!all) spdlog::error("not all tasks have a result; run the same command again for the rest");
  return all ? kFine : kNotConverged;
}

}  // namespace

void AddBatch(CLI::App& app, Action& action) {
  auto options = std::make_shared<BatchCommand>();
  CLI::App* command = app.add_subcommand(
      "batch", "Calibrate a fleet's recordings, or virtual robots of a study; say what they share");
  command->add_option("manifest", options->manifest, "Manifest (YAML): sessions, studies")
      ->required();
  command->add_option("-o,--output", options->output, "Folder for all results")
      ->required()
      ->check(IsNamed)
      ->type_name("DIR");
  command
      ->add_option("--workers", options->workers,
                   "Tasks at a time on this machine; 0: one a core (under mpirun: one a rank)")
      ->check(FromTo(0, 1024))
      ->capture_default_str();
  command
      ->add_option("--level", options->level,
                   "Chance that any robot of a fleet alike is called out of family")
      ->check(InBounds("compare --level"))
      ->capture_default_str();
  AddOutputOptions(*command, options->common);
  command->footer(
      "What is done is not done again: after an interruption give the same command.\n"
      "Example: elastocal batch fleet.yaml -o fleet\n"
      "Example: mpirun -n 8 elastocal batch fleet.yaml -o fleet");
  command->callback([&action, options] { action = [options] { return Batch(*options); }; });
}

}  // namespace elastocal::cli
