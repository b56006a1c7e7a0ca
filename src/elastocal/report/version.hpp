// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace elastocal {

/// Version and commit of the program, for --version, runs.json and the report's page:
/// "0.1.0 (cac6294)". A commit with changes that are not in it ends with "+"; a source that is not
/// in a repository has "unknown". cmake/write_version.cmake writes the definition at each build.
const char* ProgramVersion();

}  // namespace elastocal
