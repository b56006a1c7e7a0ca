# SPDX-License-Identifier: Apache-2.0
# Runs PROGRAM, the example calibrate_recording, with the project of this folder and the measured
# left arm of a TALOS. Fails if it does not print the error of the arm after calibration. The
# recording is in the folder that ELASTOCAL_SHARED_DATA names, or in shared/data beside the
# repository (SOURCE).
cmake_minimum_required(VERSION 3.25)
set(data ${SOURCE}/../shared/data)
if(DEFINED ENV{ELASTOCAL_SHARED_DATA})
  set(data $ENV{ELASTOCAL_SHARED_DATA})
endif()
set(recording ${data}/talos_left_arm_mocap/talos_left_arm_02_10_contact.csv)
if(NOT EXISTS ${recording})
  message(NOTICE "Skipped: there is no ${recording}")
  return()
endif()
# Under the sanitizers, which take twenty times as long, only LINES of the recording are used.
set(printed "to 0\\.57 mm")
if(LINES)
  set(printed "to 0\\.[0-9]+ mm")
  file(STRINGS ${recording} lines LIMIT_COUNT ${LINES})
  list(JOIN lines "\n" lines)
  set(recording ${CMAKE_CURRENT_BINARY_DIR}/few_postures.csv)
  file(WRITE ${recording} "${lines}\n")
endif()
execute_process(COMMAND ${PROGRAM} ${CMAKE_CURRENT_LIST_DIR}/project.yaml ${recording}
  OUTPUT_VARIABLE output ECHO_OUTPUT_VARIABLE COMMAND_ERROR_IS_FATAL ANY)
if(NOT output MATCHES "${printed}")
  message(FATAL_ERROR "expected '${printed}' (docs/accuracy.md)")
endif()
