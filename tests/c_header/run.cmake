# SPDX-License-Identifier: Apache-2.0
# Every installed C compiler accepts the header of `elastocal export --format c99` without a
# warning, and the compiled program gives the same bits as the library. Bad input is found also
# where the compiler is told that all numbers are finite.
#   cmake -DWRITER=... -DSOURCE=... -DWORK=... -P run.cmake
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
execute_process(COMMAND ${WRITER} ${WORK} COMMAND_ERROR_IS_FATAL ANY)
set(fast_flags "-O2 -ffast-math" "-O2 -ffp-contract=fast")
cmake_host_system_information(RESULT platform QUERY OS_PLATFORM)
if(platform STREQUAL x86_64)
  set(fast_flags "-O2 -ffast-math" "-O2 -ffp-contract=fast -march=native") # fuses where it can
endif()
foreach(compiler gcc clang clang-14 g++)
  find_program(${compiler}_found ${compiler})
  if(NOT ${compiler}_found)
    continue()
  endif()
  set(language -std=c99)
  if(compiler STREQUAL g++)
    set(language -x c++ -std=c++20 -Wold-style-cast -Wzero-as-null-pointer-constant)
  endif()
  execute_process(COMMAND ${${compiler}_found} ${language} -O2 -Wall -Wextra -Wpedantic -Wshadow
    -Wconversion -Werror -I${WORK} ${SOURCE}/main.c -o ${WORK}/${compiler} -lm COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${WORK}/${compiler} INPUT_FILE ${WORK}/postures.txt
    OUTPUT_FILE ${WORK}/${compiler}.txt COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${WORK}/expected.txt ${WORK}/${compiler}.txt
    RESULT_VARIABLE differs)
  if(differs)
    message(FATAL_ERROR "${compiler}: other bits than the library's, see ${WORK}/${compiler}.txt")
  endif()
  message(STATUS "${compiler}: the same bits")
  if(compiler MATCHES "clang-14|[+]")
    continue()
  endif()
  foreach(fast IN LISTS fast_flags)
    separate_arguments(flags UNIX_COMMAND "${fast}")
    execute_process(COMMAND ${${compiler}_found} ${language} ${flags} -I${WORK} ${SOURCE}/fast_math.c
      -o ${WORK}/${compiler}_fast -lm COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${WORK}/${compiler}_fast INPUT_FILE ${WORK}/postures.txt
      OUTPUT_VARIABLE said RESULT_VARIABLE failed)
    if(failed)
      message(FATAL_ERROR "${compiler} ${fast}: see fast_math.c\n${said}")
    endif()
    message(STATUS "${compiler} ${fast}: bad input is found, and a robot rests")
  endforeach()
endforeach()
