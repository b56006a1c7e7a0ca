// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/files/output_set.hpp"

namespace elastocal {

/// A folder of results holds SHA256SUMS, the checksum of every file that commands wrote there, in
/// the form that `sha256sum --check` reads. By it readers tell results of one state from a mixture,
/// and writers their own files from those of somebody else.
extern const char* const kChecksums;

/// Throws InputError where a listed file has changed, or where there is a calibration or its
/// summary that is not listed: then the folder is of two runs. Listed files may be missing. Does
/// nothing in a folder without SHA256SUMS.
void CheckChecksums(const std::filesystem::path& folder);

/// Throws InputError where a file of one of these names is there and not listed: it is somebody
/// else's.
void CheckOwn(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// Whether the folder's SHA256SUMS lists a file.
bool ListedIn(const std::filesystem::path& folder, const std::string& name);

/// SHA256SUMS as it is after the publication of `outputs`, whose contents in this folder are set.
std::string UpdateChecksums(const std::filesystem::path& folder, const OutputSet& outputs);

}  // namespace elastocal
