// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/checksums.hpp"

#include <map>
#include <sstream>

#include "elastocal/math/input_error.hpp"
#include "elastocal/report/encoding.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// Checksums by the name of the file.
using Checksums = std::map<std::string, std::string>;

bool IsThere(const fs::path& file) { return FileTypeOf(file) != fs::file_type::not_found; }

/// Reads the checksums of a folder; empty where it has none.
Checksums ReadChecksums(const fs::path& folder) {
  constexpr std::size_t kDigits = 64;
  const std::string between = "  ";
  const fs::path file = folder / kChecksums;
  Checksums sums;
  if (!IsThere(file)) return sums;
  std::istringstream lines(ReadFile(file));
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    ++count;
    const std::string sum = line.substr(0, kDigits);
    const bool fine = line.size() > kDigits + between.size() &&
                      line.compare(kDigits, between.size(), between) == 0 &&
                      sum.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!fine) {
      throw InputError(Place(file.string(), count) + "found " + Quote(line) +
                       "; expected 64 hexadecimal digits, two spaces and the name of a file");
    }
    sums[line.substr(kDigits + between.size())] = sum;
  }
  return sums;
}

}  // namespace

const char* const kChecksums = "SHA256SUMS";

void CheckChecksums(const fs::path& folder) {
  const Checksums sums = ReadChecksums(folder);
  if (sums.empty()) return;
  const std::string advice = ": this folder is of two runs, or the file was changed; run again ";
  for (const auto& [name, sum] : sums) {
    // Only names in the folder itself: the list may have been written by anybody.
    const fs::path file = folder / fs::path(name).filename();
    if (!IsThere(file) || Sha256(ReadFile(file)) == sum) continue;
    throw InputError(file.string() + ": is not the file that " + kChecksums + " lists" + advice +
                     "the command that writes it");
  }
  for (const char* name :
       {"calibration.yaml", "covariance.csv", "summary.json", "report_data.json"}) {
    if (sums.contains(name) || !IsThere(folder / name)) continue;
    throw InputError((folder / name).string() + ": " + kChecksums + " does not list it" + advice +
                     "calibrate");
  }
}

void CheckOwn(const fs::path& folder, const std::vector<std::string>& names) {
  const Checksums sums = ReadChecksums(folder);
  for (const std::string& name : names) {
    if (sums.contains(name) || !IsThere(folder / name)) continue;
    throw InputError((folder / name).string() + ": is there and no result of elastocal (" +
                     kChecksums + (sums.empty() ? " is not there" : " does not list it") +
                     "), so it is not replaced; choose another folder, or remove it");
  }
}

bool ListedIn(const fs::path& folder, const std::string& name) {
  return ReadChecksums(folder).contains(name);
}

std::string UpdateChecksums(const fs::path& folder, const OutputSet& outputs) {
  Checksums sums = ReadChecksums(folder);
  for (const fs::path& file : outputs.DeclaredIn(folder)) {
    const std::string name = file.filename().string();
    const std::string* contents = outputs.Contents(file);
    if (name == kChecksums) continue;
    sums.erase(name);
    // sha256sum has no line for a name with a line end.
    if (contents != nullptr && name.find('\n') == std::string::npos) sums[name] = Sha256(*contents);
  }
  std::string text;
  for (const auto& [name, sum] : sums) text += sum + "  " + name + "\n";
  return text;
}

}  // namespace elastocal
