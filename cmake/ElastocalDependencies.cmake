# SPDX-License-Identifier: Apache-2.0
# The packages that each component needs, in one place for this build and for the installed
# elastocalConfig.cmake: an entry is a name and, where it matters, the least version. A component
# needs those of the ones before it as well.
set(ELASTOCAL_COMPONENTS runtime calibration planning)
set(ELASTOCAL_runtime_DEPENDENCIES
  "Eigen3 3.4")
set(ELASTOCAL_calibration_DEPENDENCIES
  "Eigen3 3.4"
  "Boost"
  "pugixml"
  "OpenSSL"
  "yaml-cpp"
  "nlohmann_json"
  "fmt"
  "BZip2"
  "LibZip"
  "Lz4Zstd"
  "SQLite3"
  "ZLIB"
  "Threads")
set(ELASTOCAL_planning_DEPENDENCIES
  "assimp"
  "Ipopt"
  "mujoco 2.2.2")
