// SPDX-License-Identifier: Apache-2.0
// The progress line on a terminal. A pseudo-terminal replaces standard error.

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "elastocal/cli/progress.hpp"

namespace elastocal::cli {
namespace {

/// Redirects standard error of this process to a terminal of 40 columns while it lives.
class Terminal {
 public:
  Terminal() : screen_(posix_openpt(O_RDWR | O_NOCTTY)), before_(dup(STDERR_FILENO)) {
    grantpt(screen_);
    unlockpt(screen_);
    const int line = open(ptsname(screen_), O_RDWR | O_NOCTTY);
    winsize size{};
    size.ws_col = 40;
    ioctl(line, TIOCSWINSZ, &size);
    dup2(line, STDERR_FILENO);
    close(line);
  }
  ~Terminal() {
    dup2(before_, STDERR_FILENO);
    close(before_);
    close(screen_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// The text that was written since the last call.
  std::string Read() const {
    std::string text(4096, '\0');
    fcntl(screen_, F_SETFL, O_NONBLOCK);
    const ssize_t count = read(screen_, text.data(), text.size());
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return text;
  }

 private:
  int screen_, before_;
};

const std::string kErase = "\r\033[K";

TEST(ProgressLine, IsErasedBeforeAnythingElseIsPrinted) {
  Terminal terminal;
  const Progress progress = TerminalProgress("trial", false);
  ASSERT_TRUE(progress);
  progress(1, 3);
  EXPECT_EQ(terminal.Read(), kErase + "trial 1/3");
  EraseProgressLine();
  EXPECT_EQ(terminal.Read(), kErase);
  EraseProgressLine();  // there is no line to erase
  EXPECT_EQ(terminal.Read(), "");
  progress(2, 3);
  EXPECT_EQ(terminal.Read(), kErase + "trial 2/3");
  progress(3, 3);  // done
  EXPECT_EQ(terminal.Read(), kErase);
}

TEST(ProgressLine, IsErasedWhereTheWorkEndsEarly) {
  Terminal terminal;
  {
    const auto progress = TerminalSteps("reading", false);
    progress("fit", 0, 0);
    EXPECT_EQ(terminal.Read(), kErase + "fit");
    progress("a step with a name that is longer than the line", 1, 2);
    EXPECT_EQ(terminal.Read(), kErase + "a step with a name that is longer than ");  // 39 of 40
  }
  EXPECT_EQ(terminal.Read(), kErase);
}

TEST(ProgressLine, TellsTheTimeOfWorkWithoutSteps) {
  Terminal terminal;
  const ProgressLine line("fit of all models", false);
  EXPECT_EQ(terminal.Read(), "");  // work of less than a second shows no line
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_EQ(terminal.Read(), kErase + "fit of all models, 1 s");
}

TEST(LoggedProgress, WritesLinesWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  const Progress each = LoggedProgress("robot", false, 0.0);
  ASSERT_TRUE(each);
  each(0, 3);  // nothing is done yet
  each(1, 3);
  each(3, 3);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "robot 1/3\nrobot 3/3\n");
  testing::internal::CaptureStderr();
  LoggedProgress("robot", false, 60.0)(1, 3);  // fast work needs no lines
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(LoggedProgress("robot", true, 0.0));
  Terminal terminal;
  const Progress drawn = LoggedProgress("robot", false, 0.0);
  drawn(1, 3);
  EXPECT_EQ(terminal.Read(), kErase + "robot 1/3");
}

TEST(ProgressLine, IsNotDrawnWhereNobodyLooks) {
  {
    const int before = dup(STDERR_FILENO);
    const int file = open("/dev/null", O_WRONLY);
    dup2(file, STDERR_FILENO);
    EXPECT_FALSE(TerminalProgress("trial", false));
    dup2(before, STDERR_FILENO);
    close(file);
    close(before);
  }
  Terminal terminal;
  EXPECT_FALSE(TerminalProgress("trial", true));
  EXPECT_FALSE(TerminalSteps("reading", true));
}

}  // namespace
}  // namespace elastocal::cli
