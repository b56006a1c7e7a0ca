// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace elastocal {

/// Version and commit of the program, for --version, runs.json and the report's page: "0.1.0
/// (cac6294)". It ends with "+" if the source has changes that are not committed; outside a
/// repository the commit is "unknown". cmake/write_version.cmake writes the definition at each
/// build.
const char* ProgramVersion();

}  // namespace elastocal
