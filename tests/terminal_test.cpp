// SPDX-License-Identifier: Apache-2.0
// The program on a terminal, where standard output, messages and progress share one screen.

#include <algorithm>
#include <array>
#include <sstream>

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

constexpr const char* kErase = "\r\033[K";

/// All that the program writes to a terminal of 100 columns, on both of its streams.
std::string RunOnTerminal(const std::string& arguments) {
  winsize size{};
  size.ws_col = 100;
  size.ws_row = 50;
  int screen = -1;
  const pid_t child = forkpty(&screen, nullptr, nullptr, &size);
  if (child == 0) {
    const std::string command = ProgramFile() + " " + arguments;
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::string text;
  std::array<char, 4096> part;
  for (ssize_t count = 0; (count = read(screen, part.data(), part.size())) > 0;) {
    text.append(part.data(), static_cast<std::size_t>(count));
  }
  close(screen);
  waitpid(child, nullptr, 0);
  return text;
}

/// The final screen: erased lines are removed, and each line ends with a line feed.
std::vector<std::string> Screen(std::string text) {
  for (std::size_t at = 0; (at = text.find(kErase)) != std::string::npos;) {
    const std::size_t begin = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t line = begin == std::string::npos ? 0 : begin + 1;
    text.erase(line, at + std::string(kErase).size() - line);
  }
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    line.erase(line.find_last_not_of('\r') + 1);
    lines.push_back(line);
  }
  return lines;
}

TEST_F(Program, ShowsProgressAndTakesItAway) {
  const std::string text = RunOnTerminal("calibrate " + project_ + " --recording " + recording_ +
                                         " --kfold 5 -o " + out_);
  // There are three models in five folds.
  EXPECT_NE(text.find(kErase + std::string("cross-validation 1/5")), std::string::npos) << text;
  for (const std::string& line : Screen(text)) {
    EXPECT_EQ(line.find("cross-validation 1"), std::string::npos) << line;
  }
}

// One screen begins with the verdict and has at most 45 lines of 100 columns. --verbose shows the
// rest.
TEST_F(Program, CalibratePrintsOneScreen) {
  const std::string run =
      "calibrate " + project_ + " --recording " + recording_ + " --kfold 5 -o " + out_;
  const std::vector<std::string> lines = Screen(RunOnTerminal(run));
  ASSERT_FALSE(lines.empty());
  EXPECT_TRUE(lines[0].starts_with("Verdict: ")) << lines[0];
  EXPECT_LE(lines.size(), 45u);
  for (const std::string& line : lines) {
    const bool message = line.starts_with("elastocal: ");
    EXPECT_TRUE(message || line.size() <= 110) << line;
  }
  const std::string all = RunProgram(run + " --verbose").out;
  EXPECT_GT(std::count(all.begin(), all.end(), '\n'), 60);
  EXPECT_NE(all.find("Strong correlations"), std::string::npos);
  EXPECT_EQ(RunProgram(run).out.find("Strong correlations"), std::string::npos);
}

// Messages begin on new lines, below the earlier output.
TEST_F(Program, MessagesFollowWhatWasPrinted) {
  std::string table = ReadFile(recording_);
  table.replace(table.find("elbow_joint"), 11, "elbow_jXint");
  table.replace(table.find("turret_joint"), 12, "elbow_joint");
  table.replace(table.find("elbow_jXint"), 11, "turret_joint");
  const std::string both = (scratch_.path() / "both.txt").string();
  const std::string swapped = scratch_.Write("swapped.csv", table);
  const std::vector<std::string> lines =
      Screen(RunOnTerminal("calibrate " + project_ + " --recording " + swapped + " --kfold 3 -o " +
                           out_ + " >" + both + " 2>&1; cat " + both));
  std::size_t first = lines.size();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t at = lines[i].find("elastocal: ");
    if (at == std::string::npos) continue;
    EXPECT_EQ(at, 0u) << lines[i];
    first = std::min(first, i);
  }
  ASSERT_LT(first, lines.size());
  EXPECT_GT(first, 10u);  // below the tables
  EXPECT_TRUE(lines[0].starts_with("Verdict: do not deploy.")) << lines[0];
}

}  // namespace
}  // namespace elastocal
