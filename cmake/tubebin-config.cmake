# find_package(tubebin): the modules as tubebin::scan, tubebin::modeling and so on.
include(${CMAKE_CURRENT_LIST_DIR}/Dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/tubebin-targets.cmake)
