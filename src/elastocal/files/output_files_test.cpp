// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/output_files.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/count_in.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public testing::Test {
 protected:
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path() / "folder";
};

TEST_F(OutputFiles, WritesWhatItReadsAndNothingElse) {
  const std::string contents("a\r\n\0b", 5);
  WriteFile(folder_ / "deeper" / "file", "old and longer");
  WriteFile(folder_ / "deeper" / "file", contents);
  EXPECT_EQ(ReadFile(folder_ / "deeper" / "file"), contents);
  EXPECT_EQ(CountIn(folder_ / "deeper"), 1);
}

TEST_F(OutputFiles, FailedWriteLeavesNothingBehind) {
  fs::create_directories(folder_ / "file" / "occupied");
  const std::string name = (folder_ / "file").string();
  ExpectInputError([&] { WriteFile(name, "text"); }, {"cannot write " + name + ": is a folder"});
  EXPECT_EQ(CountIn(folder_), 1);
}

TEST_F(OutputFiles, NamesAFolderThatCannotBe) {
  WriteFile(folder_ / "file", "text");
  ExpectInputError([&] { WriteFile(folder_ / "file" / "below", "text"); },
                   {"cannot create the folder", "file"});
}

TEST_F(OutputFiles, NamesTheFileThatWasGivenInAFolderThatCannotBeWritten) {
  fs::create_directories(folder_);
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  const bool writable = std::ofstream(folder_ / "probe").is_open();
  const std::string name = (folder_ / "file").string();
  if (!writable) {
    ExpectInputError([&] { WriteFile(name, "text"); },
                     {"cannot write " + name + ": Permission denied"});
  }
  fs::permissions(folder_, fs::perms::owner_all);
  if (writable) GTEST_SKIP() << "this user may write everywhere";
}

TEST_F(OutputFiles, NeedsTheNameOfAFile) {
  ExpectInputError([&] { WriteFile(folder_ / "", "text"); }, {"name of a file"});
  ExpectInputError([] { WriteFile("", "text"); }, {"name of a file"});
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(OutputFiles, WritesWhereSymbolicLinksLead) {
  WriteFile(folder_ / "deeper" / "file", "old");
  fs::create_symlink("deeper/file", folder_ / "link");
  fs::create_symlink("link", folder_ / "second");
  fs::create_symlink("deeper/new", folder_ / "dangling");
  fs::create_symlink("loop", folder_ / "loop");
  WriteFile(folder_ / "second", "text");
  WriteFile(folder_ / "dangling", "more");
  for (const char* link : {"link", "second", "dangling"}) {
    EXPECT_TRUE(fs::is_symlink(folder_ / link)) << link;
  }
  EXPECT_EQ(ReadFile(folder_ / "deeper" / "file"), "text");
  EXPECT_EQ(ReadFile(folder_ / "deeper" / "new"), "more");
  ExpectInputError([&] { WriteFile(folder_ / "loop", "text"); }, {"cannot write", "loop"});
}

TEST_F(OutputFiles, WritesToDevicesAndPipesWithoutReplacingThem) {
  WriteFile("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  fs::create_directories(folder_);
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::fstream reader(pipe);  // open for reading and writing, so that neither side waits
  WriteFile(pipe, "text\n");
  std::string line;
  EXPECT_TRUE(std::getline(reader, line));
  EXPECT_EQ(line, "text");
  EXPECT_TRUE(fs::is_fifo(pipe));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no device that is always full";
  ExpectInputError(
      [&] {
        WriteFiles({{folder_ / "new" / "file", "text"}, {"/dev/full", "text"}});
      },
      {"cannot write /dev/full: No space left"});
  EXPECT_FALSE(fs::exists(folder_ / "new"));
}

TEST_F(OutputFiles, DashIsStandardOutput) {
  testing::internal::CaptureStdout();
  WriteFile("-", "text");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "text");
  EXPECT_FALSE(fs::exists("-"));
}

TEST_F(OutputFiles, WritesSeveralFilesAllOrNone) {
  WriteFiles({{folder_ / "a", "1"}, {folder_ / "new" / "b", "2"}});
  EXPECT_EQ(ReadFile(folder_ / "a"), "1");
  EXPECT_EQ(ReadFile(folder_ / "new" / "b"), "2");
  ExpectInputError(
      [&] {
        WriteFiles({{folder_ / "a", "3"},
                    {folder_ / "x" / "y" / "c", "4"},
                    {folder_ / "a" / "below", "5"}});
      },
      {"cannot create the folder " + (folder_ / "a").string()});
  EXPECT_EQ(ReadFile(folder_ / "a"), "1");
  EXPECT_FALSE(fs::exists(folder_ / "x"));
  ExpectInputError(
      [&] {
        WriteFiles({{folder_ / "a", "3"}, {folder_ / "new", "4"}});
      },
      {"new: is a folder"});
  EXPECT_EQ(ReadFile(folder_ / "a"), "1");
  EXPECT_EQ(CountIn(folder_), 2);
}

TEST_F(OutputFiles, RecognizesAFileByEveryName) {
  WriteFile(folder_ / "a", "1");
  WriteFile(folder_ / "b", "1");
  fs::create_symlink("a", folder_ / "link");
  EXPECT_TRUE(SameFile(folder_ / "a", folder_ / ".." / "folder" / "link"));
  EXPECT_FALSE(SameFile(folder_ / "a", folder_ / "b"));
  EXPECT_FALSE(SameFile(folder_ / "a", folder_ / "none"));
  EXPECT_FALSE(SameFile(folder_ / "none", folder_ / "none"));
}

TEST_F(OutputFiles, NamesWhatCannotBeRead) {
  ExpectInputError([&] { ReadFile(folder_ / "missing.urdf"); },
                   {"missing.urdf", "there is no such file"});
  fs::create_directories(folder_);
  ExpectInputError([&] { ReadFile(folder_); }, {folder_.string(), "is a folder"});
  ExpectInputError([] { ReadFile("/dev/null"); }, {"/dev/null: is not a regular file"});
}

TEST_F(OutputFiles, GivesTheReasonWhyAFileCannotBeRead) {
  WriteFile(folder_ / "file", "text");
  fs::permissions(folder_ / "file", fs::perms::none);
  if (std::ifstream(folder_ / "file")) GTEST_SKIP() << "this user may read everything";
  ExpectInputError([&] { ReadFile(folder_ / "file"); },
                   {"file: cannot be read: Permission denied"});
}

TEST_F(OutputFiles, RefusesAHugeFileUnread) {
  WriteFile(folder_ / "huge", "");
  fs::resize_file(folder_ / "huge", (256u << 20) + 1);  // a sparse file: needs no disk space
  ExpectInputError([&] { ReadFile(folder_ / "huge"); }, {"huge", "at most 256 MiB"});
}

}  // namespace
}  // namespace elastocal
