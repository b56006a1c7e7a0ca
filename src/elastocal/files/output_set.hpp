// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace elastocal {

/// The files that one run of a command writes: declared before any work, published together after
/// it.
///
///   OutputSet outputs;
///   outputs.Protect({project, recording});       // what is read is never replaced
///   outputs.Declare(folder / "summary.json");
///   outputs.Declare(folder / "robot_calibrated.urdf");
///   outputs.Prepare();                           // every place can be written, or InputError at
///   once
///   ...                                          // the work
///   outputs.Set(folder / "summary.json", text);
///   outputs.Publish();                           // all files of this run, or none
///
/// A declared file that the run does not set is removed on publication: what an earlier run of the
/// same command left there would contradict this run's files. Files that nobody declared stay.
///
/// Until Publish nothing is visible but a hidden folder `.elastocal-...` in each folder that gets a
/// file. Publish writes and syncs every file there, then commits. A run that is killed before the
/// commit leaves the earlier files untouched; a run that is killed after it is finished by the next
/// OutputSet or RecoverOutputs on that folder. With files in several folders, each folder has a
/// commit of its own.
///
/// Symbolic links are followed. A file that is replaced keeps its mode. Devices and pipes are
/// written to, not replaced; "-" and /dev/stdout are standard output. One thread at a time, except
/// that files at a StagingPath may be written by several.
class OutputSet {
 public:
  OutputSet();
  ~OutputSet();  ///< removes what was not published, and the folders made for it
  OutputSet(OutputSet&&) noexcept;
  OutputSet& operator=(OutputSet&&) noexcept;

  /// Names files that the run reads. Empty paths are passed over. Throws InputError if one of them
  /// is declared as an output.
  void Protect(const std::vector<std::filesystem::path>& inputs);

  /// Declares a file that the run may write. An empty path is passed over. `beginning` is how all
  /// files of this kind begin. Throws InputError if the file is an input, if it is declared already
  /// (two outputs under one name), or if an existing file begins otherwise, because it is then
  /// somebody else's.
  void Declare(const std::filesystem::path& file, const std::string& beginning = "");

  /// Says whether this program wrote the contents of a file, for files that do not begin alike.
  using IsOwn = std::function<bool(const std::string& contents)>;
  void Declare(const std::filesystem::path& file, const IsOwn& is_own);

  /// Finishes what an earlier run committed, makes the folders, and checks that each declared file
  /// can be written. Throws InputError naming the file as it was given: it is a folder, it or its
  /// folder is read-only, its folder cannot be made.
  void Prepare();

  /// Sets the contents of a declared file, which are kept until Publish. An empty path is passed
  /// over. Throws std::invalid_argument for a file that was not declared.
  void Set(const std::filesystem::path& file, std::string contents);

  /// Whether the file is declared; and its contents if Set gave them, else null.
  bool IsDeclared(const std::filesystem::path& file) const;
  const std::string* Contents(const std::filesystem::path& file) const;

  /// The declared files in a folder.
  std::vector<std::filesystem::path> DeclaredIn(const std::filesystem::path& folder) const;

  /// Path at which the caller may write a declared file piece by piece, instead of Set. Call it
  /// after Prepare. Throws std::invalid_argument if the file is not declared, or is a device, a
  /// pipe or "-".
  std::filesystem::path StagingPath(const std::filesystem::path& file);

  /// Publishes all files of the run. Throws InputError naming the file if the file system fails; a
  /// failure before the commit leaves the earlier files as they were. Call it once.
  void Publish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Finishes in `folder` what a killed run had committed, and removes what it had only begun.
/// Commands that read a folder of results call it first. Does nothing if there is no such folder or
/// no permission.
void RecoverOutputs(const std::filesystem::path& folder);

}  // namespace elastocal
