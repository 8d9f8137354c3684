// The functions of OpenGL and OSMesa. OSMesa and the compiler in it take 20 ms to load, so they are loaded for the first
// picture and not at a program's start.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/osmesa.h>

namespace tubebin::render {

// Pointers, which hide the functions of the same names in this namespace.
#define F(name) extern decltype(&::name) name;  // NOLINT(bugprone-macro-parentheses): declares
#include "render/opengl/functions.def"
#undef F

/// Sets them all, once a process; before it none may be called. False where OSMesa can't be loaded.
bool load_opengl();

}  // namespace tubebin::render
