// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <string>
#include <thread>

#include "elastocal/math/progress.hpp"

namespace elastocal::cli {

/// A line on standard error that says what the program is at, for how long, and, where steps can be
/// counted, how far: "cross-validation 3/10, 12 s". It is drawn only on a terminal and only without
/// --quiet, is drawn again every second, and disappears at the end of its life.
///
/// Whatever else is printed meanwhile has to call EraseProgressLine() before; Print and all
/// messages of spdlog do. One line lives at a time.
class ProgressLine {
 public:
  ProgressLine(std::string what, bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Steps that are finished, and all steps; 0 and 0 where they cannot be counted.
  void Set(int done, int total);
  /// The same of the next part of the work.
  void Set(const std::string& what, int done, int total);

 private:
  void Tick();  ///< draws the line every second

  std::string what_;
  int done_ = 0, total_ = 0;
  bool stop_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::condition_variable stopped_;
  std::thread ticker_;
};

/// A progress line for a function that counts its steps; it lives as long as the result does. Empty
/// where nothing would be drawn.
Progress TerminalProgress(const std::string& what, bool quiet);
/// The same for a function that also names what it is at; `first` until it does.
std::function<void(const std::string& what, int done, int total)> TerminalSteps(
    const std::string& first, bool quiet);

/// Empties the terminal's line if a progress line stands there.
void EraseProgressLine();

}  // namespace elastocal::cli
