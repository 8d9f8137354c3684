# Fuzz targets, with clang's libFuzzer and sanitizers over all of our code:
#   cmake -S . -B build-fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang -DTUBEBIN_FUZZ=ON -DTUBEBIN_TESTS=OFF
#   ninja -C build-fuzz fuzzers && build-fuzz/bin/fuzz_cloud -rss_limit_mb=2048 -timeout=10 NEW_INPUTS_DIR tests/fuzz/corpus/cloud
if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  message(FATAL_ERROR "TUBEBIN_FUZZ needs clang: -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang")
endif()

target_compile_options(tubebin_flags INTERFACE -g -fsanitize=fuzzer-no-link,address,undefined
                       -fno-sanitize-recover=undefined)

add_custom_target(fuzzers)
foreach(target cloud tubes_txt scene_json yaml result_index run times failures)
  add_executable(fuzz_${target} EXCLUDE_FROM_ALL tests/fuzz/fuzzer.cpp)
  target_include_directories(fuzz_${target} PRIVATE tests src)
  target_compile_definitions(fuzz_${target} PRIVATE TUBEBIN_FUZZ_TARGET=${target})
  target_link_libraries(fuzz_${target} PRIVATE tubebin_flags tubebin::results nlohmann_json::nlohmann_json)
  target_link_options(fuzz_${target} PRIVATE -fsanitize=fuzzer,address,undefined)
  add_dependencies(fuzzers fuzz_${target})
endforeach()
