// The C library picks its sine by the processor: with fused multiply-adds or without, and the last bit differs. The same
// seed shall give the same bytes on every machine, so every call from this project's code, and from Eigen's within it,
// comes here (cmake/PortableMath.cmake): SLEEF's functions without fused operations, whose results are the same to the
// bit on every processor (N. Shibata and F. Petrogalli, "SLEEF: A Portable Vectorized Library of C Standard Mathematical
// Functions", IEEE TPDS 31(6), 2020). They are off by at most one unit in the last place.
#include <sleef.h>

// The linker's names for what takes a function's place.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {

double __wrap_sin(double x);
double __wrap_cos(double x);
void __wrap_sincos(double x, double* sine, double* cosine);
double __wrap_tan(double x);
double __wrap_asin(double x);
double __wrap_acos(double x);
double __wrap_atan(double x);
double __wrap_atan2(double y, double x);
double __wrap_exp(double x);
double __wrap_log(double x);
double __wrap_log10(double x);
double __wrap_log1p(double x);
double __wrap_pow(double base, double exponent);
double __wrap_cbrt(double x);
float __wrap_cbrtf(float x);
double __wrap_hypot(double x, double y);

double __wrap_sin(double x) { return Sleef_cinz_sind1_u10purec(x); }
double __wrap_cos(double x) { return Sleef_cinz_cosd1_u10purec(x); }

void __wrap_sincos(double x, double* sine, double* cosine) {
  const Sleef_double_2 both = Sleef_cinz_sincosd1_u10purec(x);
  *sine = both.x;
  *cosine = both.y;
}

double __wrap_tan(double x) { return Sleef_cinz_tand1_u10purec(x); }
double __wrap_asin(double x) { return Sleef_cinz_asind1_u10purec(x); }
double __wrap_acos(double x) { return Sleef_cinz_acosd1_u10purec(x); }
double __wrap_atan(double x) { return Sleef_cinz_atand1_u10purec(x); }
double __wrap_atan2(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double __wrap_exp(double x) { return Sleef_cinz_expd1_u10purec(x); }
double __wrap_log(double x) { return Sleef_cinz_logd1_u10purec(x); }
double __wrap_log10(double x) { return Sleef_cinz_log10d1_u10purec(x); }
double __wrap_log1p(double x) { return Sleef_cinz_log1pd1_u10purec(x); }
double __wrap_pow(double base, double exponent) { return Sleef_cinz_powd1_u10purec(base, exponent); }
double __wrap_cbrt(double x) { return Sleef_cinz_cbrtd1_u10purec(x); }
float __wrap_cbrtf(float x) { return Sleef_cinz_cbrtf1_u10purec(x); }
double __wrap_hypot(double x, double y) { return Sleef_cinz_hypotd1_u05purec(x, y); }

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
