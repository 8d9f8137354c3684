# The same seed gives the same bytes on every machine, so no program of ours takes from the C library what that chooses
# by the processor: calls of these functions go to src/core/portable_math.cpp. Others are exact (sqrt, fmod, rounding).
foreach(function IN ITEMS sin cos sincos tan asin acos atan atan2 exp log log10 log1p pow cbrt cbrtf hypot)
  target_link_options(tubebin_core INTERFACE LINKER:--wrap=${function})
endforeach()
