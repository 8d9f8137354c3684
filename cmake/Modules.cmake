# Flags every target of ours is built with.
add_library(tubebin_flags INTERFACE)
target_compile_options(tubebin_flags INTERFACE -Wall -Wextra -Wconversion $<$<BOOL:${TUBEBIN_WERROR}>:-Werror>)
# The same seed gives the same bytes on machines that fuse multiply-adds and on those that don't.
target_compile_options(tubebin_flags INTERFACE -ffp-contract=off)

# tubebin_module(NAME PUBLIC ... PRIVATE ...): the library tubebin::NAME from src/NAME/*.cpp;
# a module without sources yet is its headers.
function(tubebin_module name)
  cmake_parse_arguments(MODULE "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${name}/*.cpp)
  if(sources)
    add_library(tubebin_${name} STATIC ${sources})
    target_include_directories(tubebin_${name} PUBLIC ${CMAKE_SOURCE_DIR}/include PRIVATE ${CMAKE_SOURCE_DIR}/src)
    target_link_libraries(tubebin_${name} PUBLIC ${MODULE_PUBLIC} PRIVATE tubebin_flags ${MODULE_PRIVATE})
    target_compile_definitions(tubebin_${name} PRIVATE TUBEBIN_VERSION="${PROJECT_VERSION}")
  else()
    add_library(tubebin_${name} INTERFACE)
    target_include_directories(tubebin_${name} INTERFACE ${CMAKE_SOURCE_DIR}/include)
    target_link_libraries(tubebin_${name} INTERFACE ${MODULE_PUBLIC})
  endif()
  add_library(tubebin::${name} ALIAS tubebin_${name})
endfunction()

# Every apps/NAME.cpp is a program NAME in <build>/bin/.
function(tubebin_apps)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/apps/*.cpp)
  foreach(source ${sources})
    get_filename_component(name ${source} NAME_WE)
    add_executable(${name} ${source})
    target_link_libraries(${name} PRIVATE tubebin_flags tubebin::dataset CLI11::CLI11)
    target_compile_definitions(${name} PRIVATE TUBEBIN_VERSION="${PROJECT_VERSION}")
  endforeach()
endfunction()

# tubebin_embed(MODULE FILE NAME): the file's text as `extern const char* const NAME` in the module.
function(tubebin_embed module file name)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${file})
  file(READ ${CMAKE_SOURCE_DIR}/${file} text)
  set(source ${CMAKE_BINARY_DIR}/embedded/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT
       "extern const char* const @name@;\nconst char* const @name@ = R\"embedded(@text@)embedded\";\n")
  target_sources(tubebin_${module} PRIVATE ${source})
endfunction()
