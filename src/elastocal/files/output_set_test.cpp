// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/output_set.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "tests/count_in.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

class OutputSetTest : public testing::Test {
 protected:
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path() / "folder";
};

TEST_F(OutputSetTest, NothingIsVisibleBeforePublishing) {
  WriteFile(folder_ / "a", "old");
  OutputSet outputs;
  outputs.Declare(folder_ / "a");
  outputs.Declare(folder_ / "b");
  outputs.Prepare();
  outputs.Set(folder_ / "a", "new");
  std::ofstream(outputs.StagingPath(folder_ / "b")) << "piece by piece";
  EXPECT_EQ(ReadFile(folder_ / "a"), "old");
  EXPECT_FALSE(fs::exists(folder_ / "b"));
  outputs.Publish();
  EXPECT_EQ(ReadFile(folder_ / "a"), "new");
  EXPECT_EQ(ReadFile(folder_ / "b"), "piece by piece");
}

TEST_F(OutputSetTest, DroppedWithoutPublishingItLeavesNoTrace) {
  {
    OutputSet outputs;
    outputs.Declare(folder_ / "deeper" / "a");
    outputs.Prepare();
    outputs.Set(folder_ / "deeper" / "a", "text");
    EXPECT_TRUE(fs::exists(folder_ / "deeper"));
  }
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(OutputSetTest, LeavesNoFolderForAFileThatIsNotWritten) {
  {
    OutputSet outputs;
    for (const char* name : {"written", "not written"}) outputs.Declare(folder_ / name / "a");
    outputs.Prepare();
    outputs.Set(folder_ / "written" / "a", "text");
    outputs.Publish();
  }
  EXPECT_TRUE(fs::exists(folder_ / "written" / "a"));
  EXPECT_FALSE(fs::exists(folder_ / "not written"));
}

TEST_F(OutputSetTest, RemovesWhatWasDeclaredAndNotSetAndKeepsTheRest) {
  WriteFiles({{folder_ / "mine", "old"}, {folder_ / "gone", "old"}, {folder_ / "other", "kept"}});
  OutputSet outputs;
  for (const char* name : {"mine", "gone"}) outputs.Declare(folder_ / name);
  outputs.Prepare();
  outputs.Set(folder_ / "mine", "new");
  outputs.Publish();
  EXPECT_EQ(ReadFile(folder_ / "mine"), "new");
  EXPECT_FALSE(fs::exists(folder_ / "gone"));
  EXPECT_EQ(ReadFile(folder_ / "other"), "kept");
}

TEST_F(OutputSetTest, NeverReplacesAnInput) {
  WriteFile(folder_ / "input", "text");
  fs::create_symlink("input", folder_ / "link");
  OutputSet declared_first;
  declared_first.Declare(folder_ / "link");
  ExpectInputError([&] { declared_first.Protect({folder_ / "input"}); }, {"link", "an input"});
  OutputSet protected_first;
  protected_first.Protect({folder_ / "input", ""});
  ExpectInputError([&] { protected_first.Declare(folder_ / ".." / "folder" / "input"); },
                   {"an input; choose another output"});
}

TEST_F(OutputSetTest, ReplacesOnlyWhatIsKnownAsItsOwn) {
  WriteFiles(
      {{folder_ / "own", "by x: old"}, {folder_ / "other", "text"}, {folder_ / "empty", ""}});
  const auto is_own = [](const std::string& text) { return text.starts_with("by x"); };
  OutputSet outputs;
  for (const char* name : {"own", "empty", "new"}) outputs.Declare(folder_ / name, is_own);
  outputs.Declare("/dev/null", is_own);
  ExpectInputError([&] { outputs.Declare(folder_ / "other", is_own); },
                   {"other: is there and was not written by this command"});
}

TEST_F(OutputSetTest, RefusesTwoOutputsUnderOneName) {
  OutputSet outputs;
  outputs.Declare(folder_ / "a");
  ExpectInputError([&] { outputs.Declare(folder_ / "." / "a"); }, {"this run writes", "already"});
}

TEST_F(OutputSetTest, SaysAtOnceWhatCannotBeWritten) {
  fs::create_directories(folder_ / "is_folder");
  OutputSet outputs;
  outputs.Declare(folder_ / "fine");
  outputs.Declare(folder_ / "is_folder");
  ExpectInputError([&] { outputs.Prepare(); }, {"is_folder: is a folder"});
}

TEST_F(OutputSetTest, KeepsTheModeOfWhatItReplaces) {
  WriteFile(folder_ / "secret", "old");
  fs::permissions(folder_ / "secret", fs::perms::owner_read | fs::perms::owner_write);
  WriteFile(folder_ / "secret", "new");
  EXPECT_EQ(fs::status(folder_ / "secret").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputSetTest, SetNeedsADeclaration) {
  OutputSet outputs;
  EXPECT_THROW(outputs.Set(folder_ / "a", ""), std::invalid_argument);
  EXPECT_THROW(outputs.StagingPath(folder_ / "a"), std::invalid_argument);
}

TEST_F(OutputSetTest, SeveralThreadsWriteIntoOneFolder) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int k = 0; k < 50; ++k) WriteFile(folder_ / std::to_string(i), std::to_string(k));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < 4; ++i) EXPECT_EQ(ReadFile(folder_ / std::to_string(i)), "49");
  EXPECT_EQ(CountIn(folder_), 4);
}

/// Leaves the folder in the state of a run that was killed right after its commit.
void LeaveCommitted(const fs::path& folder) {
  const fs::path staging = folder / ".elastocal-killed";
  fs::create_directories(staging);
  std::ofstream(staging / "a") << "new";
  std::ofstream(staging / ".commit") << "+a" << '\0' << "+b" << '\0' << "-c" << '\0';
}

TEST_F(OutputSetTest, FinishesWhatAKilledRunHadCommitted) {
  WriteFiles({{folder_ / "a", "old"}, {folder_ / "b", "new"}, {folder_ / "c", "old"}});
  LeaveCommitted(folder_);  // b already has its final name
  RecoverOutputs(folder_);
  EXPECT_EQ(ReadFile(folder_ / "a"), "new");
  EXPECT_EQ(ReadFile(folder_ / "b"), "new");
  EXPECT_EQ(CountIn(folder_), 2);
}

TEST_F(OutputSetTest, RecoveryTouchesNothingOutsideTheFolder) {
  WriteFile(scratch_.path() / "outside", "text");
  fs::create_directories(folder_ / ".elastocal-bad");
  std::ofstream(folder_ / ".elastocal-bad" / ".commit") << "-../outside" << '\0';
  RecoverOutputs(folder_);
  EXPECT_EQ(ReadFile(scratch_.path() / "outside"), "text");
}

TEST_F(OutputSetTest, LeavesARunAloneThatIsStillAtWork) {
  OutputSet outputs;
  outputs.Declare(folder_ / "a");
  outputs.Prepare();
  RecoverOutputs(folder_);
  outputs.Set(folder_ / "a", "text");
  outputs.Publish();
  EXPECT_EQ(ReadFile(folder_ / "a"), "text");
}

/// The common text of all files; files of different runs have different texts.
std::string OneText(const fs::path& folder) {
  const std::string text = ReadFile(folder / "0");
  for (int i = 1; i < 8; ++i) {
    if (ReadFile(folder / std::to_string(i)) != text) return "of two runs";
  }
  return text;
}

void WriteEight(const fs::path& folder, const std::string& text) {
  std::vector<std::pair<fs::path, std::string>> files;
  for (int i = 0; i < 8; ++i) files.emplace_back(folder / std::to_string(i), text);
  WriteFiles(files);
}

/// The delay is shortened after a run that finished and lengthened after one that did not. So it
/// stays close to the moment at which the files get their names, on a machine of any speed.
TEST_F(OutputSetTest, AKilledRunLeavesOneRunsFiles) {
  WriteEight(folder_, "before");
  int finished = 0;
  double delay = 1000.0;  // microseconds
  for (int kill_number = 0; kill_number < 100; ++kill_number) {
    const std::string written = std::to_string(kill_number);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (;;) WriteEight(folder_, written);
    }
    usleep(static_cast<useconds_t>(delay));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    RecoverOutputs(folder_);
    const std::string text = OneText(folder_);
    ASSERT_NE(text, "of two runs");
    ASSERT_EQ(CountIn(folder_), 8);
    finished += text == written ? 1 : 0;
    delay *= text == written ? 0.83 : 1.25;
  }
  EXPECT_GT(finished, 10);  // otherwise nothing was tried
  EXPECT_LT(finished, 90);
}

}  // namespace
}  // namespace elastocal
