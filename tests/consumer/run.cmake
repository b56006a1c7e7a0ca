# Installs the build folder BUILD into the empty folder WORK, builds tests/consumer against it there,
# and runs it, with the generator, compiler and flags of BUILD.
set(prefix ${WORK}/prefix)
file(REMOVE_RECURSE ${WORK})

macro(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endmacro()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(${prefix}/bin/elastocal --help)
# Only the installed package may be found: not the build folder, nor a copy of the system's.
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
  -Delastocal_DIR=${prefix}/${PACKAGE_DIR})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_CTEST_COMMAND} --test-dir ${WORK}/build --output-on-failure --no-tests=error)
