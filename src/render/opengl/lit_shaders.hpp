// GLSL 1.20 sources of the lit picture.
#pragma once

namespace tubebin::render {

constexpr const char* kLitVertexShader = R"(#version 120
uniform mat4 sun_map_from_world;
uniform float shadow_margin;
varying vec3 position;
varying vec3 normal;
varying vec3 place_in_sun_map;
varying float dome;
void main() {
  position = gl_Vertex.xyz;
  normal = gl_Normal;
  dome = gl_MultiTexCoord0.s;
  place_in_sun_map = (sun_map_from_world * vec4(position + shadow_margin * normal, 1.0)).xyz;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

/// Diffuse light of the sun with its shadow and of the dome, a little light from everywhere, a soft
/// highlight; colours are summed linearly and encoded at the end (gamma 2). A surface fades out from
/// `fade_begin` to `fade_end`.
constexpr const char* kLitFragmentShader = R"(#version 120
uniform vec3 albedo;
uniform float alpha;
uniform float highlight;
uniform vec3 eye;
uniform vec3 to_sun;
uniform sampler2DShadow sun_map;
uniform float fade_begin;
uniform float fade_end;
varying vec3 position;
varying vec3 normal;
varying vec3 place_in_sun_map;
varying float dome;
void main() {
  vec3 n = normalize(normal);
  float sun = max(0.0, dot(n, to_sun)) * shadow2D(sun_map, min(place_in_sun_map, vec3(1.0))).r;
  vec3 light = sun * vec3(0.72, 0.69, 0.64) + dome * vec3(0.60, 0.63, 0.68) + vec3(0.12);
  vec3 halfway = normalize(to_sun + normalize(eye - position));
  float gloss = max(0.0, dot(n, halfway));
  gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss;
  vec3 color = sqrt(albedo * light + vec3(highlight * gloss * min(1.0, 2.0 * sun)));
  gl_FragColor = vec4(color, alpha * (1.0 - smoothstep(fade_begin, fade_end, length(position.xy))));
}
)";

}  // namespace tubebin::render
