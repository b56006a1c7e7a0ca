// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/files/output_set.hpp"

namespace elastocal {

/// Name of the file SHA256SUMS in a folder of results. It holds the checksum of every file that
/// commands wrote there, in the form that `sha256sum --check` reads. By it readers recognise a
/// mixture of results of different runs, and writers files that are not their own.
extern const char* const kChecksums;

/// Throws InputError where a listed file has changed, or where a calibration or its summary is
/// there but not listed: the folder then holds files of two runs. Listed files may be missing. Does
/// nothing in a folder without SHA256SUMS.
void CheckChecksums(const std::filesystem::path& folder);

/// Throws InputError where a file with one of these names exists but is not listed: it was not
/// written by this program.
void CheckOwn(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// Whether the folder's SHA256SUMS lists a file.
bool ListedIn(const std::filesystem::path& folder, const std::string& name);

/// New contents of SHA256SUMS after the publication of `outputs`, whose contents in this folder are
/// set.
std::string UpdateChecksums(const std::filesystem::path& folder, const OutputSet& outputs);

}  // namespace elastocal
