# Two components: `tubebin`, the programs with their man pages, completions, configurations and docs; and `libtubebin-dev`,
# libraries, headers and the CMake package that find_package(tubebin) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY TUBEBIN_MODULES)
get_property(apps GLOBAL PROPERTY TUBEBIN_APPS)

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME libtubebin-dev)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tubebin)
install(TARGETS ${modules} EXPORT tubebin-targets ARCHIVE INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/tubebin DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT tubebin-targets NAMESPACE tubebin:: DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tubebin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/tubebin-config.cmake ${PROJECT_SOURCE_DIR}/cmake/Dependencies.cmake
              ${PROJECT_BINARY_DIR}/tubebin-config-version.cmake
        DESTINATION ${package_dir})

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME tubebin)
install(TARGETS ${apps} RUNTIME)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config DESTINATION ${CMAKE_INSTALL_DATADIR}/tubebin)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(FILES ${PROJECT_SOURCE_DIR}/third_party/regl/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright.regl)

# From each program's --help: NAME.1 (where help2man is) and the completion of bash.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
  message(STATUS "help2man is missing: no man pages")
endif()
set(help_dir ${PROJECT_BINARY_DIR}/help)
file(MAKE_DIRECTORY ${help_dir})
foreach(app ${apps})
  add_custom_command(OUTPUT ${help_dir}/${app} DEPENDS ${app} ${PROJECT_SOURCE_DIR}/scripts/bash_completion.sh VERBATIM
                     COMMAND ${PROJECT_SOURCE_DIR}/scripts/bash_completion.sh $<TARGET_FILE:${app}> > ${help_dir}/${app})
  list(APPEND completions ${help_dir}/${app})
  if(HELP2MAN)
    add_custom_command(OUTPUT ${help_dir}/${app}.1 DEPENDS ${app} ${PROJECT_SOURCE_DIR}/scripts/man_page.sh VERBATIM
                       COMMAND ${PROJECT_SOURCE_DIR}/scripts/man_page.sh $<TARGET_FILE:${app}> ${PROJECT_VERSION}
                               > ${help_dir}/${app}.1)
    list(APPEND man_pages ${help_dir}/${app}.1)
  endif()
endforeach()
add_custom_target(help_files ALL DEPENDS ${completions} ${man_pages})
install(FILES ${completions} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${man_pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
