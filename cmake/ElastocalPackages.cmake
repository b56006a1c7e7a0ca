# SPDX-License-Identifier: Apache-2.0
# Debian packages by CPack (scripts/package), one for each component of the installation:
#
#   elastocal               program   the program, its manual page, completions, models
#   libelastocal0           libraries           runtime and calibration
#   libelastocal-planning0  planning_libraries  what needs MuJoCo, Ipopt and Assimp
#   libelastocal-dev        development         headers, and the package for CMake
#   python3-elastocal       python              the Python module
#   elastocal-mpi           mpi                 what `elastocal batch` needs under mpirun, where MPI is installed
#
# Dependencies follow from the libraries that the files load (dpkg-shlibdeps). Packages need each other in the same
# version: before 1.0 a minor version may break. The same commit gives the same bytes (finish_package.cmake).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME elastocal)
set(CPACK_PACKAGE_VENDOR elastocal)
set(CPACK_PACKAGE_CONTACT "The authors of elastocal <authors@elastocal.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_MONOLITHIC_INSTALL OFF)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program libraries planning_libraries development python)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/finish_package.cmake)
set(CPACK_ELASTOCAL_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_ELASTOCAL_NOTICES ${ELASTOCAL_WEB_BUILD}/dist/notices.txt)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(same "(= ${PROJECT_VERSION})")
set(libraries "libelastocal0 ${same}, libelastocal-planning0 ${same}")

# elastocal_package(COMPONENT PACKAGE SECTION DEPENDS SUMMARY LINES): LINES are the long description.
function(elastocal_package component package section depends summary lines)
  string(TOUPPER ${component} component)
  set(CPACK_DEBIAN_${component}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${component}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${component}_DESCRIPTION "${summary}\n${lines}" PARENT_SCOPE)
endfunction()

set(what "elastocal estimates the errors of joint offsets and link geometry, and the\nelasticity of joints and legs, from \
recordings of motion capture or of touches.")
elastocal_package(program elastocal science "${libraries}" "elasto-geometric calibration of humanoid robots"
  "${what}\nThis package has the program, and a humanoid to try it on.")
elastocal_package(libraries libelastocal0 libs "" "calibration of robots: shared libraries"
  "${what}\nThis package has the libraries for controllers and for calibrating.")
elastocal_package(planning_libraries libelastocal-planning0 libs "libelastocal0 ${same}"
  "calibration of robots: libraries for planning" "${what}\nThis package has the libraries that design postures, plan motions and simulate.")
elastocal_package(development libelastocal-dev libdevel "${libraries}, libeigen3-dev"
  "calibration of robots: headers" "${what}\nThis package has what compiling against the libraries takes.")
find_package(Python REQUIRED COMPONENTS Interpreter)
math(EXPR next "${Python_VERSION_MINOR} + 1")
set(python ${Python_VERSION_MAJOR}.)
elastocal_package(python python3-elastocal python
  "${libraries}, python3 (>= ${python}${Python_VERSION_MINOR}~), python3 (<< ${python}${next}~), python3-numpy"
  "calibration of robots: Python module" "${what}\nThis package has the Python module elastocal.")
if(TARGET elastocal_mpi)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
  elastocal_package(mpi elastocal-mpi science "elastocal ${same}, openmpi-bin" "calibration of robots: batches by MPI"
    "${what}\nThis package has what elastocal batch needs under mpirun.")
endif()
include(CPack)
