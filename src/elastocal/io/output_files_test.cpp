#include "elastocal/io/output_files.hpp"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

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
  const fs::directory_iterator files(folder_ / "deeper");
  EXPECT_EQ(std::distance(files, fs::directory_iterator()), 1);
}

TEST_F(OutputFiles, FailedWriteLeavesNothingBehind) {
  fs::create_directories(folder_ / "file" / "occupied");
  ExpectInputError([&] { WriteFile(folder_ / "file", "text"); }, {"cannot write", "file"});
  const fs::directory_iterator files(folder_);
  EXPECT_EQ(std::distance(files, fs::directory_iterator()), 1);
}

TEST_F(OutputFiles, NamesAFolderThatCannotBe) {
  WriteFile(folder_ / "file", "text");
  ExpectInputError([&] { WriteFile(folder_ / "file" / "below", "text"); },
                   {"cannot create the folder", "file"});
}

TEST_F(OutputFiles, NamesWhatCannotBeRead) {
  ExpectInputError([&] { ReadFile(folder_ / "missing.urdf"); },
                   {"missing.urdf", "there is no such file"});
  fs::create_directories(folder_);
  ExpectInputError([&] { ReadFile(folder_); }, {folder_.string(), "not a regular file"});
}

TEST_F(OutputFiles, RefusesAHugeFileUnread) {
  WriteFile(folder_ / "huge", "");
  fs::resize_file(folder_ / "huge", (256u << 20) + 1);  // a hole: takes no space on the disk
  ExpectInputError([&] { ReadFile(folder_ / "huge"); }, {"huge", "at most 256 MiB"});
}

}  // namespace
}  // namespace elastocal
