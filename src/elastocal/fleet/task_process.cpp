// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/task_process.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool IsResult(int exit_code) { return exit_code == 0 || exit_code == 4; }

/// Time of the latest change of a file, or of any file in a folder.
std::optional<fs::file_time_type> LatestChange(const fs::path& path) {
  std::error_code error;
  auto latest = fs::last_write_time(path, error);
  if (error) return std::nullopt;
  if (!fs::is_directory(path, error)) return latest;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    const auto time = entry.last_write_time(error);
    if (!error && time > latest) latest = time;
  }
  return latest;
}

int Spawn(const fs::path& program, const std::vector<std::string>& words, const fs::path& log) {
  std::vector<std::string> all = {program.string()};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t process = -1;
  const int failed =
      posix_spawn(&process, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    throw InputError(program.string() +
                     ": cannot be started: " + std::generic_category().message(failed));
  }
  return process;
}

}  // namespace

TaskProcess::TaskProcess(fs::path program, fs::path output, const std::vector<FleetTask>& tasks)
    : program_(std::move(program)), output_(std::move(output)), tasks_(tasks) {}

TaskProcess::~TaskProcess() {
  if (process_ < 0) return;
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
}

void TaskProcess::Start(int task) {
  task_ = task;
  command_ = 0;
  begin_ = Now();
  std::error_code error;
  fs::remove(MarkOf(tasks_[task], output_), error);
  fs::remove(output_ / (tasks_[task].name + ".log"), error);
  for (const fs::path& leftover : tasks_[task].leftovers) fs::remove_all(leftover, error);
  StartCommand();
}

void TaskProcess::StartCommand() {
  const FleetTask& task = tasks_[task_];
  std::vector<std::string> words = task.commands[command_];
  words.emplace_back("--quiet");
  process_ = Spawn(program_, words, output_ / (task.name + ".log"));
}

std::optional<TaskEnd> TaskProcess::Poll() {
  int status = 0;
  const pid_t ended = waitpid(process_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
  process_ = -1;
  const int exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (exit_code == 0 && command_ + 1 < tasks_[task_].commands.size()) {
    ++command_;
    StartCommand();
    return std::nullopt;
  }
  return Finish(exit_code);
}

TaskEnd TaskProcess::Finish(int exit_code) {
  const FleetTask& task = tasks_[task_];
  std::error_code error;
  for (const fs::path& leftover : task.leftovers) fs::remove_all(leftover, error);
  const TaskEnd end{exit_code, Now() - begin_};
  if (IsResult(exit_code)) {
    const nlohmann::ordered_json mark = {
        {"commands", task.commands}, {"exit_code", exit_code}, {"seconds", end.seconds}};
    const fs::path place = MarkOf(task, output_);
    fs::path made = place;
    made += ".new";
    {
      std::ofstream file(made);
      file << JsonText(mark);
    }
    fs::rename(made, place, error);
  }
  task_ = -1;
  return end;
}

fs::path MarkOf(const FleetTask& task, const fs::path& output) {
  return output / (task.name + ".done.json");
}

std::optional<TaskEnd> EndedBefore(const FleetTask& task, const fs::path& output) {
  const fs::path mark = MarkOf(task, output);
  const auto made = LatestChange(mark);
  if (!made) return std::nullopt;
  std::vector<fs::path> inputs = task.recordings;
  inputs.push_back(task.project);
  for (const fs::path& input : inputs) {
    const auto changed = LatestChange(input);
    if (!changed || *changed > *made) return std::nullopt;
  }
  std::ifstream file(mark);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || json.value("commands", nlohmann::json()) != task.commands) {
    return std::nullopt;
  }
  const auto number = [&](const char* key) {
    const auto value = json.find(key);
    return value != json.end() && value->is_number() ? value->get<double>() : -1.0;
  };
  const TaskEnd end{static_cast<int>(number("exit_code")), number("seconds")};
  if (!IsResult(end.exit_code)) return std::nullopt;
  return end;
}

}  // namespace elastocal
