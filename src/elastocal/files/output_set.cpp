// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/output_set.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/staging.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// Throws InputError if an existing file does not begin with `beginning` and is not empty.
void CheckBeginning(const fs::path& file, const std::string& beginning) {
  std::error_code error;
  if (beginning.empty() || !fs::is_regular_file(file, error)) return;
  std::ifstream stream(file, std::ios::binary);
  std::string found(beginning.size(), '\0');
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  found.resize(static_cast<std::size_t>(stream.gcount()));
  if (found.empty() || found == beginning) return;
  throw InputError(file.string() + ": is there and does not begin with " + Quote(beginning) +
                   ", as this output does, so it is not replaced; choose another name, or remove "
                   "it");
}

/// Throws InputError if this program did not write an existing file and it is not empty.
void CheckOwnFile(const fs::path& file, const OutputSet::IsOwn& is_own) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return;
  std::string found;
  try {
    found = ReadFile(file);
  } catch (const InputError&) {  // larger than what this program reads, or not readable
    found.assign(1, '\0');
  }
  if (found.empty() || is_own(found)) return;
  throw InputError(file.string() +
                   ": is there and was not written by this command, so it is not replaced; choose "
                   "another name, or remove it");
}

bool IsStandardOutput(const fs::path& file) { return file == "-" || file == "/dev/stdout"; }

/// The path to which symbolic links lead from `file`, also if nothing is there yet.
fs::path FollowLinks(const fs::path& file) {
  constexpr int kMostLinks = 40;
  fs::path target = file;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    target = target.parent_path() / fs::read_symlink(target, error);
    if (error) FailToWrite(file, error.message());
  }
  FailToWrite(file, "too many symbolic links");
}

/// Whether two paths name one file, existing or not.
bool SamePlace(const fs::path& a, const fs::path& b) {
  if (SameFile(a, b)) return true;
  std::error_code error;
  const fs::path whole_a = fs::weakly_canonical(a, error);
  return !error && whole_a == fs::weakly_canonical(b, error) && !error;
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Writes to a device or pipe, which cannot be staged.
void WriteStream(const fs::path& file, const std::string& contents) {
  errno = 0;
  const auto size = static_cast<std::streamsize>(contents.size());
  if (IsStandardOutput(file)) {
    std::cout.write(contents.data(), size).flush();
    if (!std::cout) throw InputError("cannot write to standard output: " + SystemError());
    return;
  }
  std::ofstream stream(file, std::ios::binary);
  stream.write(contents.data(), size);
  stream.close();
  if (!stream) FailToWrite(file, SystemError());
}

}  // namespace

struct OutputSet::State {
  struct Output {
    fs::path given;
    fs::path target;                           // path behind links; empty for streams
    std::optional<std::string> contents = {};  // of Set
    bool staged = false;                       // written by the caller at its StagingPath
  };

  // The order matters on destruction: staging folders go before the folders made for them.
  NewFolders folders;
  std::map<fs::path, Staging> staging;  // by folder
  std::vector<fs::path> inputs;
  std::vector<Output> outputs;

  Output* Find(const fs::path& file) {
    const fs::path normal = file.lexically_normal();
    for (Output& output : outputs) {
      if (output.given.lexically_normal() == normal) return &output;
    }
    return nullptr;
  }

  Output& Declared(const fs::path& file) {
    if (Output* output = Find(file)) return *output;
    throw std::invalid_argument("OutputSet: " + file.string() + " was not declared");
  }

  /// Adds an output; an empty path is passed over.
  void Add(const fs::path& file) {
    if (file.empty()) return;
    for (const fs::path& input : inputs) {
      if (SamePlace(file, input)) {
        throw InputError(file.string() + ": this is an input; choose another output");
      }
    }
    for (const Output& output : outputs) {
      if (SamePlace(file, output.given)) {
        throw InputError(file.string() + ": this run writes something else to this file already (" +
                         output.given.string() + "); choose another output");
      }
    }
    outputs.push_back({file, {}});
  }

  fs::path StagingPathOf(const Output& output) {
    return staging.at(FolderOf(output.target)).path() / output.target.filename();
  }

  void PrepareOutput(Output& output) {
    const fs::path& file = output.given;
    if (IsStandardOutput(file)) return;
    if (file.filename().empty()) FailToWrite(file, "the name of a file was expected");
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (fs::is_directory(status)) FailToWrite(file, "is a folder");
    if (fs::exists(status) && access(file.c_str(), W_OK) != 0) FailToWrite(file, SystemError());
    if (fs::exists(status) && !fs::is_regular_file(status)) return;
    output.target = FollowLinks(file);
    const fs::path folder = FolderOf(output.target);
    if (staging.contains(folder)) return;
    folders.Create(folder);
    RecoverOutputs(folder);
    staging.try_emplace(folder, folder, file);
  }

  /// Writes the files to the disk, in their staging folders, with the modes of those that they
  /// replace.
  void WriteStaged() {
    for (const Output& output : outputs) {
      if (output.target.empty() || (!output.contents && !output.staged)) continue;
      const fs::path path = StagingPathOf(output);
      if (output.contents) WriteNew(path, *output.contents, output.given);
      if (output.staged) SyncFile(path, output.given);
      struct stat before {};
      if (stat(output.target.c_str(), &before) == 0) chmod(path.c_str(), before.st_mode & 07777);
    }
  }

  void WriteStreams() const {
    for (const Output& output : outputs) {
      if (output.target.empty() && output.contents) WriteStream(output.given, *output.contents);
    }
  }

  /// Commits the files of a folder: from here on they are published, even if the run is killed.
  void Commit(const fs::path& folder, const Staging& place) {
    std::string commit;
    for (const Output& output : outputs) {
      if (output.target.empty() || FolderOf(output.target) != folder) continue;
      const bool there = output.contents || output.staged;
      commit += (there ? '+' : '-') + output.target.filename().string() + '\0';
    }
    const fs::path written = place.path() / (std::string(kCommit) + ".new");
    WriteNew(written, commit, folder);
    std::error_code error;
    fs::rename(written, place.path() / kCommit, error);
    if (error) FailToWrite(folder, error.message());
    SyncFolder(place.path());
  }

  /// Commits all folders, or none if one of them fails.
  void CommitAll() {
    try {
      for (const auto& [folder, place] : staging) Commit(folder, place);
    } catch (...) {
      std::error_code ignored;
      for (const auto& [folder, place] : staging) fs::remove(place.path() / kCommit, ignored);
      throw;
    }
  }
};

OutputSet::OutputSet() : state_(std::make_unique<State>()) {}
OutputSet::~OutputSet() = default;
OutputSet::OutputSet(OutputSet&&) noexcept = default;
OutputSet& OutputSet::operator=(OutputSet&&) noexcept = default;

void OutputSet::Protect(const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    for (const State::Output& output : state_->outputs) {
      if (SamePlace(output.given, input)) {
        throw InputError(output.given.string() + ": this is an input; choose another output");
      }
    }
    state_->inputs.push_back(input);
  }
}

void OutputSet::Declare(const fs::path& file, const std::string& beginning) {
  state_->Add(file);
  CheckBeginning(file, beginning);
}

void OutputSet::Declare(const fs::path& file, const IsOwn& is_own) {
  state_->Add(file);
  CheckOwnFile(file, is_own);
}

void OutputSet::Prepare() {
  for (State::Output& output : state_->outputs) state_->PrepareOutput(output);
}

void OutputSet::Set(const fs::path& file, std::string contents) {
  if (!file.empty()) state_->Declared(file).contents = std::move(contents);
}

bool OutputSet::IsDeclared(const fs::path& file) const { return state_->Find(file) != nullptr; }

std::vector<fs::path> OutputSet::DeclaredIn(const fs::path& folder) const {
  std::vector<fs::path> files;
  for (const State::Output& output : state_->outputs) {
    if (SamePlace(FolderOf(output.given), folder)) files.push_back(output.given);
  }
  return files;
}

const std::string* OutputSet::Contents(const fs::path& file) const {
  const State::Output* output = state_->Find(file);
  return output != nullptr && output->contents ? &*output->contents : nullptr;
}

fs::path OutputSet::StagingPath(const fs::path& file) {
  State::Output& output = state_->Declared(file);
  if (output.target.empty()) {
    throw std::invalid_argument("OutputSet: " + file.string() +
                                " is no regular file, or Prepare was not called");
  }
  output.staged = true;
  return state_->StagingPathOf(output);
}

void OutputSet::Publish() {
  state_->WriteStaged();
  state_->WriteStreams();
  state_->CommitAll();
  for (const auto& [folder, place] : state_->staging) {
    const FolderLock lock(folder);  // readers wait until the folder is of one run
    ApplyCommit(place);
  }
}

void RecoverOutputs(const fs::path& folder) {
  const FolderLock lock(folder.empty() ? "." : folder);
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end; entry.increment(error)) {
    if (entry->path().filename().string().starts_with(kStagingPrefix)) left.push_back(*entry);
  }
  for (const fs::path& path : left) {
    const Staging staging(path);
    if (staging.owned() && fs::exists(path / kCommit, error)) ApplyCommit(staging);
  }
}

}  // namespace elastocal
