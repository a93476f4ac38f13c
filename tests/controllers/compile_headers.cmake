# Compiles each source, and reports all that fail: the name of a source is that of its header.
# cmake -D COMPILER=command -D FLAGS=flags -D SOURCES=files -P compile_headers.cmake
set(failed 0)
foreach(source IN LISTS SOURCES)
  execute_process(COMMAND ${COMPILER} ${FLAGS} -c ${source} -o ${source}.o
    RESULT_VARIABLE status ERROR_VARIABLE messages)
  if(NOT status EQUAL 0)
    get_filename_component(name ${source} NAME_WE)
    message("${name} does not compile:\n${messages}")
    math(EXPR failed "${failed} + 1")
  endif()
endforeach()
list(LENGTH SOURCES number)
message(STATUS "${failed} of ${number} sources do not compile")
if(NOT number OR failed)
  message(FATAL_ERROR "each header has to compile as C++17, without a warning, with the includes of its own")
endif()
