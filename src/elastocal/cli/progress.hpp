// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <string>
#include <thread>

#include "elastocal/math/progress.hpp"

namespace elastocal::cli {

/// A line on standard error with the current work, its duration and, where steps can be counted,
/// its progress: "cross-validation 3/10, 12 s". It is drawn only on a terminal and without --quiet,
/// is redrawn every second, and disappears when the object is destroyed.
///
/// Other output must call EraseProgressLine() first; Print and all messages of spdlog do. Only one
/// line exists at a time.
class ProgressLine {
 public:
  ProgressLine(std::string what, bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Sets the number of finished steps and of all steps; 0 and 0 where they cannot be counted.
  void Set(int done, int total);
  /// Sets the same for the next part of the work.
  void Set(const std::string& what, int done, int total);

 private:
  void Tick();  ///< redraws the line every second

  std::string what_;
  int done_ = 0, total_ = 0;
  bool stop_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::condition_variable stopped_;
  std::thread ticker_;
};

/// A progress line for a function that counts its steps; it exists as long as the returned
/// function. Empty where nothing would be drawn.
Progress TerminalProgress(const std::string& what, bool quiet);
/// As TerminalProgress, for a function that also names its current work; `first` is shown until it
/// does.
std::function<void(const std::string& what, int done, int total)> TerminalSteps(
    const std::string& first, bool quiet);

/// As TerminalProgress on a terminal. Elsewhere (a log file) each finished step is a line on
/// standard error, "robot 1/3, 65 s", with at least `least_s` seconds between two lines; standard
/// output is flushed first, so that a log shows what was printed before long work. Empty if
/// `quiet`.
Progress LoggedProgress(const std::string& what, bool quiet, double least_s = 10.0);

/// Erases the terminal's line if a progress line is shown there.
void EraseProgressLine();

}  // namespace elastocal::cli
