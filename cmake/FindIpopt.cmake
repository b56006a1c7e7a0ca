# SPDX-License-Identifier: Apache-2.0
# Ipopt's Debian package has neither a CMake package nor a pkg-config file. Defines Ipopt::Ipopt.
find_path(Ipopt_INCLUDE_DIR IpIpoptApplication.hpp PATH_SUFFIXES coin coin-or)
find_library(Ipopt_LIBRARY ipopt)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Ipopt REQUIRED_VARS Ipopt_LIBRARY Ipopt_INCLUDE_DIR)
mark_as_advanced(Ipopt_INCLUDE_DIR Ipopt_LIBRARY)
if(Ipopt_FOUND AND NOT TARGET Ipopt::Ipopt)
  add_library(Ipopt::Ipopt UNKNOWN IMPORTED)
  # HAVE_CSTDDEF: without it Ipopt 3.11's headers do not find the standard ones.
  set_target_properties(Ipopt::Ipopt PROPERTIES IMPORTED_LOCATION ${Ipopt_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${Ipopt_INCLUDE_DIR}
    INTERFACE_COMPILE_DEFINITIONS HAVE_CSTDDEF)
endif()
