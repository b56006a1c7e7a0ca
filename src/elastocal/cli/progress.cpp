// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/progress.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "elastocal/math/utf8.hpp"

namespace elastocal::cli {
namespace {

constexpr const char* kEmptyLine = "\r\033[K";

/// Guards the terminal's line and the state of the existing line.
std::mutex& Guard() {
  static std::mutex guard;
  return guard;
}

bool& IsDrawn() {
  static bool is_drawn = false;
  return is_drawn;
}

bool IsShown(bool quiet) { return !quiet && isatty(STDERR_FILENO) == 1; }

std::size_t TerminalWidth() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col : 80;
}

/// Both functions are called with the guard held.
void Draw(const std::string& text) {
  // Buffered output of stdout belongs above the line.
  std::fflush(stdout);
  fmt::print(stderr, "{}{}", kEmptyLine, Printable(text.substr(0, TerminalWidth() - 1)));
  std::fflush(stderr);
  IsDrawn() = true;
}

void Erase() {
  if (!IsDrawn()) return;
  fmt::print(stderr, "{}", kEmptyLine);
  std::fflush(stderr);
  IsDrawn() = false;
}

std::string Text(const std::string& what, int done, int total, double seconds) {
  std::string text = what;
  if (total > 0) text += fmt::format(" {}/{}", done, total);
  if (seconds >= 1.0) text += fmt::format(", {:.0f} s", std::floor(seconds));
  return text;
}

}  // namespace

ProgressLine::ProgressLine(std::string what, bool quiet)
    : what_(std::move(what)), begin_(std::chrono::steady_clock::now()) {
  if (!IsShown(quiet)) return;
  ticker_ = std::thread([this] { Tick(); });
}

ProgressLine::~ProgressLine() {
  if (!ticker_.joinable()) return;
  {
    const std::lock_guard lock(Guard());
    stop_ = true;
  }
  stopped_.notify_all();
  ticker_.join();
  EraseProgressLine();
}

void ProgressLine::Set(int done, int total) { Set(what_, done, total); }

void ProgressLine::Set(const std::string& what, int done, int total) {
  if (!ticker_.joinable()) return;
  const std::lock_guard lock(Guard());
  what_ = what;
  done_ = done;
  total_ = total;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  if (done < total || total == 0) {
    Draw(Text(what_, done, total, elapsed.count()));
  } else {
    Erase();
  }
}

void ProgressLine::Tick() {
  std::unique_lock lock(Guard());
  while (!stopped_.wait_for(lock, std::chrono::seconds(1), [this] { return stop_; })) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    const bool is_done = total_ > 0 && done_ >= total_;
    if (!is_done) Draw(Text(what_, done_, total_, elapsed.count()));
  }
}

Progress TerminalProgress(const std::string& what, bool quiet) {
  if (!IsShown(quiet)) return {};
  const auto line = std::make_shared<ProgressLine>(what, quiet);
  return [line](int done, int total) { line->Set(done, total); };
}

Progress LoggedProgress(const std::string& what, bool quiet, double least_s) {
  if (quiet || IsShown(quiet)) return TerminalProgress(what, quiet);
  std::fflush(stdout);
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  const auto begin = Clock::now();
  const auto last = std::make_shared<Clock::time_point>(begin);
  return [=](int done, int total) {
    const std::lock_guard lock(Guard());
    if (done <= 0 || seconds(*last) < least_s) return;
    *last = Clock::now();
    fmt::print(stderr, "{}\n", Text(what, done, total, seconds(begin)));
    std::fflush(stderr);
  };
}

std::function<void(const std::string&, int, int)> TerminalSteps(const std::string& first,
                                                                bool quiet) {
  if (!IsShown(quiet)) return {};
  const auto line = std::make_shared<ProgressLine>(first, quiet);
  return [line](const std::string& what, int done, int total) { line->Set(what, done, total); };
}

void EraseProgressLine() {
  const std::lock_guard lock(Guard());
  Erase();
}

}  // namespace elastocal::cli
