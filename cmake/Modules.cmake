# Flags every target of ours is built with.
add_library(tubebin_flags INTERFACE)
target_compile_options(tubebin_flags INTERFACE -Wall -Wextra -Wconversion $<$<BOOL:${TUBEBIN_WERROR}>:-Werror>)
# The same seed gives the same bytes on machines that fuse multiply-adds and on those that don't.
target_compile_options(tubebin_flags INTERFACE -ffp-contract=off)
# A shared library's functions are inlined as a program's are; nobody puts others in their place.
target_compile_options(tubebin_flags INTERFACE $<$<BOOL:${TUBEBIN_PYTHON}>:-fno-semantic-interposition>)

# tubebin_module(NAME PUBLIC ... PRIVATE ...): the library tubebin::NAME from all sources below src/NAME/.
function(tubebin_module name)
  cmake_parse_arguments(MODULE "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
  if(NOT OSMESA_FOUND)
    list(FILTER sources EXCLUDE REGEX "/opengl/")
  endif()
  add_library(tubebin_${name} STATIC ${sources})
  target_compile_features(tubebin_${name} PUBLIC cxx_std_20)
  target_include_directories(tubebin_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(tubebin_${name} PUBLIC ${MODULE_PUBLIC} PRIVATE $<BUILD_INTERFACE:tubebin_flags> ${MODULE_PRIVATE})
  target_compile_definitions(tubebin_${name} PRIVATE TUBEBIN_VERSION="${PROJECT_VERSION}")
  add_library(tubebin::${name} ALIAS tubebin_${name})
  set_target_properties(tubebin_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY TUBEBIN_MODULES tubebin_${name})
endfunction()

# tubebin_app(NAME LIBRARIES...): the program NAME in <build>/bin/ from apps/NAME.cpp. Of the shared libraries behind the
# modules it loads those alone that its code calls.
function(tubebin_app name)
  add_executable(${name} ${PROJECT_SOURCE_DIR}/apps/${name}.cpp)
  target_link_libraries(${name} PRIVATE tubebin_flags ${ARGN} CLI11::CLI11)
  target_link_options(${name} PRIVATE LINKER:--as-needed)
  target_compile_definitions(${name} PRIVATE TUBEBIN_VERSION="${PROJECT_VERSION}")
  set_property(GLOBAL APPEND PROPERTY TUBEBIN_APPS ${name})
endfunction()

# tubebin_embed(MODULE FILE NAME): the file's text as `extern const char* const NAME` in the module.
function(tubebin_embed module file name)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
  file(READ ${PROJECT_SOURCE_DIR}/${file} text)
  set(source ${CMAKE_BINARY_DIR}/embedded/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT
       "extern const char* const @name@;\nconst char* const @name@ = R\"embedded(@text@)embedded\";\n")
  target_sources(tubebin_${module} PRIVATE ${source})
endfunction()
