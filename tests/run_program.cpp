// SPDX-License-Identifier: Apache-2.0
#include "tests/run_program.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <sys/wait.h>

#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

std::string Contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

std::string ProgramFile() { return ELASTOCAL_PROGRAM; }

std::filesystem::path GeneratedFile(const std::string& name) {
  return std::filesystem::path(ELASTOCAL_GENERATED) / name;
}

ProgramResult RunProgram(const std::string& arguments) {
  const ScratchFolder scratch;
  const auto out = scratch.path() / "out";
  const auto err = scratch.path() / "err";
  const std::string command =
      ProgramFile() + " " + arguments + " >" + out.string() + " 2>" + err.string() + " </dev/null";
  const int status = std::system(command.c_str());
  ProgramResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.out = Contents(out);
  result.err = Contents(err);
  return result;
}

}  // namespace elastocal
