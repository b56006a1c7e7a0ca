# SPDX-License-Identifier: Apache-2.0
# Runs PROGRAM, the example calibrate_recording, with the project of this folder and the measured left
# arm of a TALOS; fails where it does not print the error that the arm has after calibration. The recording is
# in the folder that ELASTOCAL_SHARED_DATA names, or beside the repository (SOURCE) in shared/data.
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
execute_process(COMMAND ${PROGRAM} ${CMAKE_CURRENT_LIST_DIR}/project.yaml ${recording}
  OUTPUT_VARIABLE output ECHO_OUTPUT_VARIABLE COMMAND_ERROR_IS_FATAL ANY)
if(NOT output MATCHES "to 0\\.57 mm")
  message(FATAL_ERROR "expected 'to 0.57 mm' (docs/accuracy.md)")
endif()
