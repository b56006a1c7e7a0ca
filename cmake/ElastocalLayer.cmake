# SPDX-License-Identifier: Apache-2.0
# Warnings are errors in our code; headers of packages are SYSTEM and exempt. Not in Debug: with the
# sanitizers GCC 12 takes Eigen's temporaries for uninitialised. -Wnull-dereference and
# -Wrestrict are left out: GCC 12 finds both in the standard library's own vectors and strings.
# -Wsubobject-linkage takes a source for a header where sources are joined.
add_library(elastocal_warnings INTERFACE)
target_compile_options(elastocal_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual
  -Wunused $<$<NOT:$<CONFIG:Debug>>:-Werror> $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-subobject-linkage>)

# The compiler collects its garbage every few megabytes otherwise: a tenth of its time.
target_compile_options(elastocal_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)

# Several sources are compiled as one: Eigen's and GoogleTest's headers are what takes the time. So no
# name in an unnamed namespace may come twice in a layer. OFF (presets dev and tidy): each source by
# itself, which also shows a missing #include.
option(ELASTOCAL_UNITY "Compile several sources of a layer as one" ON)
set(ELASTOCAL_UNITY_BATCH 40)

# elastocal_unity(OUT NAME source...): the sources, or few of equal size that include them by relative names.
# (CMake's UNITY_BUILD has absolute ones, and ccache then finds nothing in another folder.)
function(elastocal_unity out name)
  if(NOT ELASTOCAL_UNITY)
    set(${out} ${ARGN} PARENT_SCOPE)
    return()
  endif()
  set(joined "")
  set(number 0)
  set(count 0)
  set(content "")
  list(LENGTH ARGN sources)
  math(EXPR units "(${sources} + ${ELASTOCAL_UNITY_BATCH} - 1) / ${ELASTOCAL_UNITY_BATCH}")
  math(EXPR batch "(${sources} + ${units} - 1) / ${units}")
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    string(REGEX REPLACE "^src/" "" source ${source})
    string(APPEND content "#include \"${source}\"\n")
    math(EXPR count "${count} + 1")
    if(count EQUAL batch)
      list(APPEND joined "${content}")
      set(content "")
      set(count 0)
    endif()
  endforeach()
  if(NOT content STREQUAL "")
    list(APPEND joined "${content}")
  endif()
  set(sources "")
  foreach(content IN LISTS joined)
    set(file ${PROJECT_BINARY_DIR}/unity/${name}_${number}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${content}" @ONLY)
    list(APPEND sources ${file})
    math(EXPR number "${number} + 1")
  endforeach()
  set(${out} ${sources} PARENT_SCOPE)
endfunction()

# The layers that turn bytes into values: fuzzing is led by what it reaches in them.
set(ELASTOCAL_FUZZED_LAYERS math tables files robot measurement readers description project io)

# elastocal_layer(NAME [LIGHT] [USES layer...] [LIBS public...] [PRIVATE_LIBS private...])
#
# LIGHT: what it computes takes less time than the optimiser.
# One library elastocal::NAME from src/elastocal/NAME/*.cpp, and one test program from the
# *_test.cpp beside them. What a layer may include is what it USES, transitively.
#
# No precompiled headers: they save little here, hide missing includes, and defeat ccache.
function(elastocal_layer name)
  cmake_parse_arguments(ARG "LIGHT" "" "USES;LIBS;PRIVATE_LIBS" ${ARGN})
  set(folder ${PROJECT_SOURCE_DIR}/src/elastocal/${name})
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  file(GLOB tests CONFIGURE_DEPENDS ${folder}/*_test.cpp)
  if(tests)
    list(REMOVE_ITEM sources ${tests})
  endif()
  set_property(GLOBAL APPEND PROPERTY ELASTOCAL_LAYERS ${name})
  set_property(GLOBAL PROPERTY ELASTOCAL_LAYER_USES_${name} ${ARG_USES})
  string(JOIN " " uses ${ARG_USES})
  set_property(GLOBAL APPEND_STRING PROPERTY ELASTOCAL_LAYER_RULES "${name}: ${uses}\n")

  elastocal_unity(joined ${name} ${sources})
  add_library(elastocal_${name} ${joined})
  add_library(elastocal::${name} ALIAS elastocal_${name})
  set_target_properties(elastocal_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} DEFINE_SYMBOL "")
  target_compile_features(elastocal_${name} PUBLIC cxx_std_20)
  target_include_directories(elastocal_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(ELASTOCAL_FUZZ AND name IN_LIST ELASTOCAL_FUZZED_LAYERS)
    target_compile_options(elastocal_${name} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  if(BUILD_SHARED_LIBS)
    # A layer's own functions may be inlined into it, and it calls its own instances of templates, not
    # those that a LIGHT layer or a program has optimised less.
    target_compile_options(elastocal_${name} PRIVATE -fno-semantic-interposition)
    target_link_options(elastocal_${name} PRIVATE LINKER:-Bsymbolic-functions)
  endif()
  if(ARG_LIGHT)
    target_compile_options(elastocal_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  list(TRANSFORM ARG_USES PREPEND elastocal_)
  target_link_libraries(elastocal_${name} PUBLIC ${ARG_USES} ${ARG_LIBS} PRIVATE ${ARG_PRIVATE_LIBS}
    $<BUILD_INTERFACE:elastocal_warnings>)

  if(ELASTOCAL_TESTS AND tests)
    elastocal_test(${name}_test SOURCES ${tests} LIBS elastocal_${name} ${ARG_PRIVATE_LIBS})
  endif()
endfunction()

# The kernels of math/dense.hpp: for any processor, and once more for x86-64-v3.
function(elastocal_dense_kernels)
  set(source ${PROJECT_SOURCE_DIR}/src/elastocal/math/kernels/dense_kernels.cpp)
  target_sources(elastocal_math PRIVATE ${source})
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    return()
  endif()
  add_library(elastocal_kernels_v3 OBJECT ${source})
  set_target_properties(elastocal_kernels_v3 PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_features(elastocal_kernels_v3 PRIVATE cxx_std_20)
  target_compile_options(elastocal_kernels_v3 PRIVATE -march=x86-64-v3)
  target_compile_definitions(elastocal_kernels_v3 PRIVATE ELASTOCAL_FOR_V3)
  target_include_directories(elastocal_kernels_v3 PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(elastocal_kernels_v3 PRIVATE Eigen3::Eigen elastocal_warnings)
  target_sources(elastocal_math PRIVATE $<TARGET_OBJECTS:elastocal_kernels_v3>)
  target_compile_definitions(elastocal_math PRIVATE ELASTOCAL_KERNELS_V3)
endfunction()

# Statistical and simulated tests, and those that run the program many times: minutes each.
option(ELASTOCAL_SLOW_TESTS "Build the slow tests; they add nothing under the sanitizers" ON)

# elastocal_test(NAME [SLOW] SOURCES file... [LIBS library...])
#
# A GoogleTest program. Each of its cases is a test of ctest, so that two cores share them; in Debug
# builds, where starting a program takes long, the whole program is one test. Suites whose names end in
# Study try many robots or samples for a figure; like SLOW programs they run in release only. A test
# can find the repository's files and the shared data by tests/test_files.hpp.
function(elastocal_test name)
  cmake_parse_arguments(ARG "SLOW" "" "SOURCES;LIBS" ${ARGN})
  if(ARG_SLOW AND NOT ELASTOCAL_SLOW_TESTS)
    return()
  endif()
  elastocal_unity(joined ${name} ${ARG_SOURCES})
  add_executable(${name} ${joined})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} elastocal_test_support elastocal_warnings
    GTest::gtest_main)
  # The libraries compute; more optimisation of a test's own code takes longer than it saves.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(CMAKE_BUILD_TYPE STREQUAL Debug)
    set(cases)
    if(NOT ELASTOCAL_SLOW_TESTS)
      set(cases --gtest_filter=-*Study.*)
    endif()
    add_test(NAME ${name} COMMAND ${name} --gtest_brief=1 ${cases})
    set_tests_properties(${name} PROPERTIES TIMEOUT 1200)
  else()
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 600)
  endif()
endfunction()

# The tests `layers` (no layer includes what it does not USE) and `licences` (each source names its licence).
# Call it after the last layer.
function(elastocal_layer_test)
  get_property(rules GLOBAL PROPERTY ELASTOCAL_LAYER_RULES)
  file(WRITE ${PROJECT_BINARY_DIR}/layers.txt "${rules}")
  add_test(NAME layers COMMAND ${CMAKE_COMMAND} -DRULES=${PROJECT_BINARY_DIR}/layers.txt
    -DSOURCES=${PROJECT_SOURCE_DIR}/src/elastocal -P ${PROJECT_SOURCE_DIR}/cmake/check_layers.cmake)
  # The check itself, on a folder with one wrong inclusion of each sort.
  add_test(NAME layers_finds_violations COMMAND ${CMAKE_COMMAND}
    -DRULES=${PROJECT_SOURCE_DIR}/tests/bad_layers/layers.txt
    -DSOURCES=${PROJECT_SOURCE_DIR}/tests/bad_layers
    -P ${PROJECT_SOURCE_DIR}/cmake/check_layers.cmake)
  file(READ ${PROJECT_SOURCE_DIR}/tests/bad_layers/expected.txt expected)
  string(STRIP "${expected}" expected)
  set_tests_properties(layers_finds_violations PROPERTIES PASS_REGULAR_EXPRESSION "${expected}")

  set(check ${PROJECT_SOURCE_DIR}/cmake/check_licences.cmake)
  add_test(NAME licences COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -P ${check})
  set(bad ${PROJECT_BINARY_DIR}/without_licence)
  file(WRITE ${bad}/nameless.cpp "int main() {}\n")
  add_test(NAME licences_finds_violations COMMAND ${CMAKE_COMMAND} -DSOURCE=${bad} -P ${check})
  set_tests_properties(licences_finds_violations PROPERTIES
    PASS_REGULAR_EXPRESSION "nameless.cpp: no line 'SPDX")
endfunction()
