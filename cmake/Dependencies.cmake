# Libraries behind the modules. The installed package reads this file, too: who links a module needs them all.
include_guard(DIRECTORY)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
find_package(fmt REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(LibArchive REQUIRED)
find_package(PkgConfig REQUIRED)

pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode)
add_library(tubebin::ode ALIAS PkgConfig::ODE)

# sine and the like that give the same bits on every processor
pkg_check_modules(SLEEF REQUIRED IMPORTED_TARGET sleef)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
# LZF, PCD's compression
pkg_check_modules(LZF REQUIRED IMPORTED_TARGET liblzf)

# Embree 4 (Ubuntu 24.04) or 3 (Debian 12); src/scan/embree.hpp is the one place that tells them apart.
find_package(embree 4 QUIET)
if(embree_FOUND)
  set(TUBEBIN_EMBREE_MAJOR 4)
else()
  find_package(embree 3 REQUIRED)
  set(TUBEBIN_EMBREE_MAJOR 3)
endif()
add_library(tubebin::embree INTERFACE IMPORTED)
target_link_libraries(tubebin::embree INTERFACE embree)
target_compile_definitions(tubebin::embree INTERFACE TUBEBIN_EMBREE_MAJOR=${TUBEBIN_EMBREE_MAJOR})
