# rehearse_public_names(FILE FOLDER): writes into FOLDER the headers that FILE lists, each of which includes another one.
# Lines of FILE: "HEADER: NAME...".
function(rehearse_public_names file folder)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(STRINGS ${file} rows REGEX "^[^#]")
  foreach(row ${rows})
    string(REGEX REPLACE ":.*" "" header "${row}")
    string(REGEX REPLACE "^[^:]*: *" "" names "${row}")
    separate_arguments(names)
    foreach(name ${names})
      file(CONFIGURE OUTPUT ${folder}/${name} CONTENT "#pragma once\n#include \"${header}\"\n" @ONLY)
    endforeach()
  endforeach()
endfunction()
