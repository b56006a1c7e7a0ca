# SPDX-License-Identifier: Apache-2.0
# Installs the program, the libraries with their headers, the embedded models, and the CMake package
# that find_package(elastocal COMPONENTS ...) reads.
#
#   runtime      the robot at run time, for controllers: only Eigen is needed
#   calibration  the layer `exports` and all that it uses: neither Assimp, MuJoCo nor Ipopt is needed
#   planning     all other layers
#
# CMake's components of the installation are the Debian packages (ElastocalPackages.cmake): program,
# libraries (runtime and calibration), planning_libraries, development, python.
#
# elastocal::elastocal stands for all layers, or for those of the components asked for.
include(CMakePackageConfigHelpers)

# All that a layer uses, transitively, and itself.
function(elastocal_used_layers layer out)
  set(used ${layer})
  get_property(uses GLOBAL PROPERTY ELASTOCAL_LAYER_USES_${layer})
  foreach(use IN LISTS uses)
    elastocal_used_layers(${use} more)
    list(APPEND used ${more})
  endforeach()
  list(REMOVE_DUPLICATES used)
  set(${out} ${used} PARENT_SCOPE)
endfunction()

get_property(layers GLOBAL PROPERTY ELASTOCAL_LAYERS)
elastocal_used_layers(runtime runtime_layers)
elastocal_used_layers(exports calibration_layers)
list(REMOVE_ITEM calibration_layers ${runtime_layers})
set(planning_layers ${layers})
list(REMOVE_ITEM planning_layers ${runtime_layers} ${calibration_layers})

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/elastocal)
add_library(elastocal_all INTERFACE)
add_library(elastocal::elastocal ALIAS elastocal_all)
foreach(component IN LISTS ELASTOCAL_COMPONENTS)
  set(targets ${${component}_layers})
  list(TRANSFORM targets PREPEND elastocal:: OUTPUT_VARIABLE ${component}_targets)
  list(TRANSFORM targets PREPEND elastocal_)
  target_link_libraries(elastocal_all INTERFACE ${targets})
  set(libraries libraries)
  if(component STREQUAL planning)
    set(libraries planning_libraries)
  endif()
  install(TARGETS ${targets} EXPORT elastocal_${component} ARCHIVE COMPONENT development
    LIBRARY COMPONENT ${libraries} NAMELINK_COMPONENT development)
  install(EXPORT elastocal_${component} FILE elastocal_${component}.cmake NAMESPACE elastocal::
    DESTINATION ${package_dir} COMPONENT development)
endforeach()
if(ELASTOCAL_PROGRAM)
  install(TARGETS elastocal RUNTIME COMPONENT program)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/elastocal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h" PATTERN "cli" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/models DESTINATION ${CMAKE_INSTALL_DATADIR}/elastocal
  COMPONENT program)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/elastocalConfig.cmake.in
  ${PROJECT_BINARY_DIR}/elastocalConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/elastocalConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/elastocalConfig.cmake
  ${PROJECT_BINARY_DIR}/elastocalConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/ElastocalDependencies.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindIpopt.cmake ${PROJECT_SOURCE_DIR}/cmake/FindLibZip.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindLz4Zstd.cmake
  DESTINATION ${package_dir} COMPONENT development)
