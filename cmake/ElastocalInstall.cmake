# Installs the program, the libraries with their headers, the embedded models, and the CMake package
# that find_package(elastocal) reads. elastocal::elastocal stands for all layers together.
include(CMakePackageConfigHelpers)

get_property(layers GLOBAL PROPERTY ELASTOCAL_LAYERS)
list(TRANSFORM layers PREPEND elastocal_)
add_library(elastocal_all INTERFACE)
add_library(elastocal::elastocal ALIAS elastocal_all)
set_target_properties(elastocal_all PROPERTIES EXPORT_NAME elastocal)
target_link_libraries(elastocal_all INTERFACE ${layers})

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/elastocal)
install(TARGETS elastocal RUNTIME)
install(TARGETS elastocal_all ${layers} EXPORT elastocalTargets ARCHIVE)
install(EXPORT elastocalTargets NAMESPACE elastocal:: DESTINATION ${package_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/elastocal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.hpp" PATTERN "cli" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/models DESTINATION ${CMAKE_INSTALL_DATADIR}/elastocal)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/elastocalConfig.cmake.in
  ${PROJECT_BINARY_DIR}/elastocalConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/elastocalConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/elastocalConfig.cmake
  ${PROJECT_BINARY_DIR}/elastocalConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/ElastocalDependencies.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindIpopt.cmake DESTINATION ${package_dir})
