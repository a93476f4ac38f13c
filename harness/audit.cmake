# Watching controllers: what they call, what their libraries hold. A library of its own, so that a replay links neither a
# disassembler nor a reader of debug information.
find_package(PkgConfig REQUIRED)
pkg_check_modules(AUDIT REQUIRED IMPORTED_TARGET libdw libelf capstone tinyxml2)

add_subdirectory(interposer)

rehearse_add_library(audit
  src/audit/aspects.cpp
  src/audit/audit.cpp
  src/audit/audit_json.cpp
  src/audit/audited_replay.cpp
  src/audit/call_log.cpp
  src/audit/elf_library.cpp
  src/audit/experiments.cpp
  src/audit/judgement.cpp
  src/audit/library_scan.cpp
  src/audit/memory_check.cpp
  src/audit/outputs_file.cpp
  src/audit/reasons.cpp
  src/audit/replay_process.cpp
  src/audit/sources.cpp
  src/audit/symbols.cpp
  src/audit/valgrind_report.cpp)
# A locale with a decimal comma, for audits to vary; without the sources of locales none is varied.
find_program(LOCALEDEF localedef)
set(comma_locale ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/rehearse/locale/de_DE.utf8)
if(LOCALEDEF AND EXISTS /usr/share/i18n/locales/de_DE)
  add_custom_command(OUTPUT ${comma_locale}/LC_NUMERIC
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/rehearse/locale
    COMMAND ${LOCALEDEF} --no-archive --inputfile=de_DE --charmap=UTF-8 ${comma_locale}
    COMMENT "Building a locale with a decimal comma" VERBATIM)
  add_custom_target(rehearse_locale DEPENDS ${comma_locale}/LC_NUMERIC)
  add_dependencies(rehearse_audit rehearse_locale)
  install(DIRECTORY ${comma_locale} DESTINATION ${CMAKE_INSTALL_LIBDIR}/rehearse/locale)
endif()
# Recordings and replays with simulated time need it, too.
target_sources(rehearse_harness PRIVATE src/host/interposer.cpp src/host/virtualised.cpp)
target_include_directories(rehearse_audit PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(rehearse_audit
  PUBLIC Rehearse::harness
  PRIVATE PkgConfig::AUDIT nlohmann_json::nlohmann_json fmt::fmt ${CMAKE_DL_LIBS})
add_dependencies(rehearse_audit rehearse_interposer)
