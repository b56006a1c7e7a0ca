# SPDX-License-Identifier: Apache-2.0
# Installs the build folder BUILD into the empty folder WORK and builds tests/consumer against it
# there, with the generator, compiler and flags of BUILD: once with all of elastocal, which writes a
# recording, and once with the component calibration, which calibrates from this recording.
cmake_minimum_required(VERSION 3.25)
set(prefix ${WORK}/prefix)
set(source ${CMAKE_CURRENT_LIST_DIR}/../..)
file(REMOVE_RECURSE ${WORK})

macro(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endmacro()

# Only the installed package may be found, neither the build folder nor a copy in the system.
macro(configure component)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/${component}
    -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_CXX_FLAGS=${FLAGS} -DCOMPONENT=${component} -DEXAMPLES=${source}/examples
    -Delastocal_DIR=${prefix}/${PACKAGE_DIR} ${ARGN})
endmacro()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(${prefix}/bin/elastocal --help)
foreach(component planning calibration runtime)
  configure(${component} COMMAND_ERROR_IS_FATAL ANY)
  run(${CMAKE_COMMAND} --build ${WORK}/${component})
endforeach()

set(project ${source}/tests/robots/arm6_project.yaml)
run(${WORK}/planning/record ${project} ${WORK}/recording.csv)
execute_process(COMMAND ${WORK}/calibration/calibrate ${project} ${WORK}/recording.csv
  OUTPUT_VARIABLE output ECHO_OUTPUT_VARIABLE COMMAND_ERROR_IS_FATAL ANY)
if(NOT output MATCHES "to 0\\.3[0-9] mm")  # 0.2 mm a coordinate is 0.35 mm in 3-D
  message(FATAL_ERROR "expected 'to 0.3. mm'")
endif()

# A controller refuses a missing model with a message.
execute_process(COMMAND ${WORK}/runtime/stand ${WORK}/absent.txt ERROR_VARIABLE error RESULT_VARIABLE status)
if(status EQUAL 0 OR NOT error MATCHES "absent.txt: cannot be read")
  message(FATAL_ERROR "expected a refusal: ${error}")
endif()

configure(calibrations ERROR_VARIABLE error RESULT_VARIABLE status)
if(status EQUAL 0 OR NOT error MATCHES "no component[ \n]+'calibrations'")
  message(FATAL_ERROR "a component that does not exist must be refused by name:\n${error}")
endif()
