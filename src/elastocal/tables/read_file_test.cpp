// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/read_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

TEST(ReadFile, GivesAllBytes) {
  const ScratchFolder scratch;
  const std::string text("a\0b\r\n\xff", 6);
  EXPECT_EQ(ReadFile(scratch.Write("a", text)), text);
  EXPECT_EQ(ReadFile(scratch.Write("empty", "")), "");
}

// A pipe to which nobody writes would block the program, and a device would never end.
TEST(ReadFile, TakesRegularFilesOnly) {
  const ScratchFolder scratch;
  const std::filesystem::path pipe = scratch.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ExpectInputError([&] { ReadFile(pipe); }, {"pipe", "not a regular file"});
  ExpectInputError([] { ReadFile("/dev/zero"); }, {"/dev/zero", "not a regular file"});
  ExpectInputError([&] { ReadFile(scratch.path()); }, {"is a folder"});
  ExpectInputError([&] { ReadFile(scratch.path() / "none"); }, {"none", "no such file"});
  ExpectInputError([] { ReadFile(""); }, {"name", "is empty"});
}

TEST(FileTypeOf, KnowsWhereNoneIsAndWhereNobodyCanTell) {
  const ScratchFolder scratch;
  EXPECT_EQ(FileTypeOf(scratch.path() / "none"), std::filesystem::file_type::not_found);
  EXPECT_EQ(FileTypeOf(scratch.path()), std::filesystem::file_type::directory);
  const std::filesystem::path loop = scratch.path() / "loop";
  std::filesystem::create_symlink(loop, loop);
  ExpectInputError([&] { FileTypeOf(loop); }, {"loop", "cannot be read"});
  ExpectInputError([&] { FileTypeOf(scratch.path() / std::string(5000, 'a')); },
                   {"cannot be read"});
}

}  // namespace
}  // namespace elastocal
