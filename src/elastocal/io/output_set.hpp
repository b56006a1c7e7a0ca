#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace elastocal {

/// The files that one run of a command writes: declared before any work, published together after it.
///
///   OutputSet outputs;
///   outputs.Protect({project, recording});           // what is read is never replaced
///   outputs.Declare(folder / "summary.json");
///   outputs.Declare(folder / "robot_calibrated.urdf");
///   outputs.Prepare();                                // all places writable, or InputError at once
///   ...                                               // the work
///   outputs.Set(folder / "summary.json", text);
///   outputs.Publish();                                // all files of this run, or none
///
/// A declared file that the run does not set is removed on publication: what an earlier run of the
/// same command left there would contradict this run's other files. Files that are not declared stay
/// as they are.
///
/// Until Publish, nothing is visible but a hidden folder `.elastocal-...` in each folder written to.
/// Publish writes and fsyncs every file there, then commits: from then on, the run is published even
/// if the program is killed, because the next OutputSet or RecoverOutputs on that folder finishes
/// what was committed. Before the commit a killed run leaves the earlier files untouched.
///
/// Symbolic links are followed. A replaced file keeps its mode. Devices and pipes are written to, not
/// replaced; "-" and /dev/stdout are standard output. Not copyable; not for several threads, except
/// StagingPath files, which the caller may write as it likes.
class OutputSet {
 public:
  OutputSet();
  ~OutputSet();  ///< removes what was not published, and folders made for it
  OutputSet(OutputSet&&) noexcept;
  OutputSet& operator=(OutputSet&&) noexcept;

  /// Files that the run reads; paths that are empty or lead to nothing are passed over. Throws
  /// InputError where one of them is declared already.
  void Protect(const std::vector<std::filesystem::path>& inputs);

  /// A file that the run may write. An empty path is passed over, and a second declaration of the
  /// same file as well. Throws InputError where the file is protected ("this is an input; choose
  /// another output").
  void Declare(const std::filesystem::path& file);

  /// Makes the folders and tries whether each declared file can be written. Throws InputError naming
  /// the file as it was given: a folder, no permission, no such parent, read-only. Finishes first
  /// what an earlier run committed and could not finish.
  void Prepare();

  /// Contents of a declared file, kept until Publish; an empty path is passed over. Throws
  /// std::invalid_argument for a file that was not declared.
  void Set(const std::filesystem::path& file, std::string contents);

  /// Where to write a declared regular file piece by piece instead of Set; only after Prepare.
  std::filesystem::path StagingPath(const std::filesystem::path& file);

  /// Makes all files visible: those set or staged get their names, the other declared ones are
  /// removed. Throws InputError where the file system fails; then nothing has changed. Called once.
  void Publish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Finishes in `folder` what a killed run had committed, and removes what one had only begun (its
/// process is gone). For commands that read a result folder.
void RecoverOutputs(const std::filesystem::path& folder);

}  // namespace elastocal
