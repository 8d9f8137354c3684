# PCL, which tests and benchmarks compare with; the modules and the programs do without it. Its own CMake package pulls in
# VTK, Qt and MPI through its visualization parts; the parts used here need none of them, so they are found by
# pkg-config-free names and headers alone.
find_path(PCL_INCLUDE_DIR pcl/pcl_config.h PATH_SUFFIXES pcl-1.13 pcl-1.14 pcl-1.15 pcl-1.12 REQUIRED)
add_library(tubebin::pcl INTERFACE IMPORTED)
target_include_directories(tubebin::pcl SYSTEM INTERFACE ${PCL_INCLUDE_DIR})
target_link_libraries(tubebin::pcl INTERFACE Eigen3::Eigen)
foreach(part IN ITEMS common octree kdtree search features filters sample_consensus segmentation)
  find_library(PCL_${part}_LIBRARY pcl_${part} REQUIRED)
  target_link_libraries(tubebin::pcl INTERFACE ${PCL_${part}_LIBRARY})
endforeach()
