# SPDX-License-Identifier: Apache-2.0
# LZ4 has no CMake package in Debian 12. Defines Lz4Zstd::Lz4Zstd, both compressors of ROS bags.
find_path(Lz4Zstd_LZ4_INCLUDE_DIR lz4frame.h)
find_library(Lz4Zstd_LZ4_LIBRARY lz4)
find_path(Lz4Zstd_ZSTD_INCLUDE_DIR zstd.h)
find_library(Lz4Zstd_ZSTD_LIBRARY zstd)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Lz4Zstd REQUIRED_VARS Lz4Zstd_LZ4_LIBRARY
  Lz4Zstd_LZ4_INCLUDE_DIR Lz4Zstd_ZSTD_LIBRARY Lz4Zstd_ZSTD_INCLUDE_DIR)
mark_as_advanced(Lz4Zstd_LZ4_INCLUDE_DIR Lz4Zstd_LZ4_LIBRARY Lz4Zstd_ZSTD_INCLUDE_DIR
  Lz4Zstd_ZSTD_LIBRARY)
if(Lz4Zstd_FOUND AND NOT TARGET Lz4Zstd::Lz4Zstd)
  add_library(Lz4Zstd::Lz4Zstd INTERFACE IMPORTED)
  set_target_properties(Lz4Zstd::Lz4Zstd PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${Lz4Zstd_LZ4_INCLUDE_DIR};${Lz4Zstd_ZSTD_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${Lz4Zstd_LZ4_LIBRARY};${Lz4Zstd_ZSTD_LIBRARY}")
endif()
