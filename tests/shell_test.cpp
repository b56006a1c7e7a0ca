// SPDX-License-Identifier: Apache-2.0
// Products of the command line's definitions: version, manual page, and completion of shells.

#include <array>
#include <cstdio>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

const std::vector<std::string> kCommands = {"inspect",  "calibrate", "validate", "compare", "demo",
                                            "simulate", "design",    "assess",   "report",  "plan"};

std::string Generated(const std::string& file) { return ReadFile(GeneratedFile(file)); }

/// All long options in the help of a command.
std::vector<std::string> HelpOptions(const std::string& command) {
  const std::string help = RunProgram(command + " --help").out;
  const std::regex option("^  (?:-[a-z],)?(--[a-z0-9-]+)");
  std::vector<std::string> options;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, option)) options.push_back(match[1]);
  }
  return options;
}

/// Output of a shell command on both streams, and whether it succeeded.
std::pair<std::string, bool> Shell(const std::string& command) {
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string text;
  std::array<char, 4096> part;
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), pipe)) > 0;) {
    text.append(part.data(), count);
  }
  return {text, pclose(pipe) == 0};
}

bool IsInstalled(const std::string& program) { return Shell("command -v " + program).second; }

/// The completions that bash offers for the last of these words, in the folder `here`.
std::string Completed(const std::string& words, const std::string& here = ".") {
  const ScratchFolder scratch;
  const std::string script =
      scratch.Write("complete.sh", ". '" + GeneratedFile("elastocal").string() + "'\ncd '" + here +
                                       "'\nCOMP_WORDS=(" + words +
                                       ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_elastocal\n"
                                       "echo \"${COMPREPLY[*]}\"\n");
  return Shell("bash --norc " + script).first;
}

TEST(Shell, VersionTellsTheCommit) {
  const ProgramResult version = RunProgram("--version");
  EXPECT_EQ(version.exit_code, 0);
  const std::regex form(R"(elastocal \d+\.\d+\.\d+ \((unknown|[\w.-]+\+?)\)\n)");
  EXPECT_TRUE(std::regex_match(version.out, form)) << version.out;
  // For git, a clone that belongs to another user is no repository, and neither is a released
  // source.
  if (!Shell("git -C '" + SourceFile(".").string() + "' rev-parse HEAD").second) {
    GTEST_SKIP() << "not in a repository";
  }
  EXPECT_EQ(version.out.find("unknown"), std::string::npos);
}

TEST(Shell, EveryOptionIsInManualAndCompletions) {
  const std::string manual = Generated("elastocal.1");
  const std::string zsh = Generated("_elastocal");
  for (const std::string& command : kCommands) {
    EXPECT_NE(manual.find(".SS " + command + "\n"), std::string::npos) << command;
    EXPECT_NE(zsh.find("'" + command + ":"), std::string::npos) << command;
    const std::vector<std::string> options = HelpOptions(command);
    EXPECT_GE(options.size(), 4u) << command;
    const std::string offered = " " + Completed("elastocal " + command + " --") + " ";
    for (const std::string& option : options) {
      const std::string escaped = std::regex_replace(option, std::regex("-"), "\\-");
      EXPECT_NE(manual.find("\\fB" + escaped + "\\fR"), std::string::npos) << option;
      EXPECT_NE(zsh.find(option + "["), std::string::npos) << option;
      EXPECT_NE(offered.find(option), std::string::npos) << option << " not in " << offered;
    }
  }
  EXPECT_NE(manual.find(".SH \"EXIT STATUS\""), std::string::npos);
}

TEST(Shell, ManualPageHasNoFaults) {
  const std::string page = GeneratedFile("elastocal.1");
  if (!IsInstalled("groff")) GTEST_SKIP() << "no groff";
  const auto [faults, fine] = Shell("groff -man -ww -z -Tascii " + page);
  EXPECT_TRUE(fine);
  EXPECT_EQ(faults, "");
}

TEST(Shell, BashCompletes) {
  if (!IsInstalled("bash")) GTEST_SKIP() << "no bash";
  EXPECT_EQ(Completed("elastocal cali"), "calibrate\n");
  EXPECT_EQ(Completed("elastocal --ver"), "--version\n");
  EXPECT_EQ(Completed("elastocal calibrate --zero-off"), "--zero-offsets\n");
  EXPECT_EQ(Completed("elastocal calibrate p.yaml --zero-offsets ''"), "origin encoder\n");
  EXPECT_EQ(Completed("elastocal calibrate --zero-offsets = en"), "encoder\n");
  EXPECT_EQ(Completed("elastocal design p.yaml --algorithm co"), "cocp\n");
  EXPECT_EQ(Completed("elastocal calibrate --kfold ''"), "\n");  // a number has no completions
}

TEST(Shell, BashCompletesFiles) {
  if (!IsInstalled("bash")) GTEST_SKIP() << "no bash";
  const ScratchFolder folder;
  folder.Write("project one.yaml", "");
  folder.Write("recording.csv", "");
  const std::string here = folder.path().string();
  EXPECT_EQ(Completed("elastocal inspect proj", here), "project one.yaml\n");
  EXPECT_EQ(Completed("elastocal calibrate p.yaml --recording rec", here), "recording.csv\n");
  EXPECT_EQ(Completed("elastocal calibrate --json = rec", here), "recording.csv\n");
}

TEST(Shell, ZshReadsItsCompletion) {
  if (!IsInstalled("zsh")) GTEST_SKIP() << "no zsh";
  const auto [faults, fine] = Shell("zsh -n " + GeneratedFile("_elastocal").string());
  EXPECT_TRUE(fine);
  EXPECT_EQ(faults, "");
}

}  // namespace
}  // namespace elastocal
