#pragma once

#include <filesystem>
#include <string>

namespace elastocal {

/// What a run of the program printed, and its exit code.
struct ProgramResult {
  int exit_code = -1;
  std::string out, err;
};

/// Runs the built `elastocal` with these arguments, as a shell would.
ProgramResult RunProgram(const std::string& arguments);

/// An empty folder for one test, removed with everything in it at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file into it and returns its path.
  std::string Write(const std::string& name, const std::string& contents) const;

 private:
  std::filesystem::path path_;
};

}  // namespace elastocal
