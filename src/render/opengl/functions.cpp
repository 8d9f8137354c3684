#include "render/opengl/functions.hpp"

#include <dlfcn.h>

namespace tubebin::render {
namespace {

constexpr const char* kLibrary = "libOSMesa.so.8";  // of all versions of Mesa since 2012

bool load_functions() {
  void* library = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return false;
  bool complete = true;
  const auto load = [&](const char* name) {
    void* function = dlsym(library, name);
    complete &= function != nullptr;
    return function;
  };
#define F(name) name = reinterpret_cast<decltype(name)>(load(#name));
#include "render/opengl/functions.def"
#undef F
  return complete;
}

}  // namespace

#define F(name) decltype(name) name = nullptr;  // NOLINT(bugprone-macro-parentheses): defines
#include "render/opengl/functions.def"
#undef F

bool load_opengl() {
  static const bool loaded = load_functions();
  return loaded;
}

}  // namespace tubebin::render
