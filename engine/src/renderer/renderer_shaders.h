// The shaders of the renderer, in GLSL 3.30. Everything happens in the camera's frame, where numbers are small.
#pragma once

namespace rehearse::gl {

inline constexpr char vertex_shader[] = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float shift;
layout(location = 3) in mat3 rotation;
layout(location = 6) in vec3 origin;
layout(location = 7) in vec4 scale;
layout(location = 8) in vec4 color;
uniform mat4 projection;
out vec3 surface_point;
out vec3 surface_normal;
flat out vec4 surface_color;

void hand_on(vec3 local);

void main() {
  vec3 local = position * scale.xyz + vec3(0.0, 0.0, shift * scale.w);
  surface_point = origin + rotation * local;
  surface_normal = rotation * normal;
  surface_color = color;
  gl_Position = projection * vec4(surface_point, 1.0);
  hand_on(local);
}
)";

// Defines hand_on() of the vertex shader, which passes more data to the fragment shader. One of these follows.
inline constexpr char hands_on_nothing[] = R"(
void hand_on(vec3 local) {}
)";

inline constexpr char hands_on_shape_point[] = R"(
out vec3 shape_point;   // in the shape's own frame
out vec3 shape_normal;

void hand_on(vec3 local) {
  shape_point = local;
  shape_normal = normal;
}
)";

inline constexpr char hands_on_texture_point[] = R"(
layout(location = 9) in vec2 texture_coordinates;
out vec2 texture_point;

void hand_on(vec3 local) {
  texture_point = vec2(texture_coordinates.x, 1.0 - texture_coordinates.y);  // the first row is the top one
}
)";

// Light adds up in the square of the colours (a gamma of 2, so that half lit doesn't look nearly dark). The sky's light
// is bluish from above and warm and dim from below; the sun is warm; the lamp on the camera keeps surfaces that face it
// from being dark. A surface that faces sun and sky shows about its own colour. The shader consists of three parts.
// With lamps, one line is inserted between the second and the third part; without lamps the pixels are exactly those of
// a shader without lamp code. The parts of skin and shadows follow.
inline constexpr char fragment_shader_head[] = R"(#version 330 core
in vec3 surface_point;
in vec3 surface_normal;
flat in vec4 surface_color;
uniform vec3 up;
uniform vec3 sun;
layout(location = 0) out vec4 color;
layout(location = 1) out float distance;

vec3 facing_normal();      // unit vector
vec4 base_color();
float height_of_shadow();  // how far above the surface its shadow is looked up [m]
float sun_share(vec3 normal);
)";

inline constexpr char fragment_shader_light[] = R"(
void main() {
  vec3 normal = facing_normal();
  vec3 light = mix(vec3(0.20, 0.18, 0.16), vec3(0.40, 0.43, 0.48), 0.5 + 0.5 * dot(normal, up));
  light += vec3(0.50, 0.48, 0.43) * max(dot(normal, sun), 0.0) * sun_share(normal);
  light += vec3(0.18) * max(-dot(normal, normalize(surface_point)), 0.0);
)";

inline constexpr char fragment_shader_color[] = R"(  vec4 base = base_color();
  color = vec4(base.rgb * sqrt(light), base.a);
  distance = 1.0 / gl_FragCoord.w;
}
)";

// The lamps that are on, four vectors each; struct Lamp (renderer_painter.h) describes them. The shader uses only
// arithmetic whose results are the same on every processor: no powers, no angles.
inline constexpr char lamp_function[] = R"(
uniform vec4 lamps[MOST_LAMPS * 4];
uniform int lamp_count;

float smooth_step(float x) {
  x = clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

vec3 lamp_light(vec3 normal) {
  vec3 light = vec3(0.0);
  for (int i = 0; i < lamp_count; ++i) {
    vec4 place = lamps[4 * i];
    vec4 strength = lamps[4 * i + 1];
    vec4 fading = lamps[4 * i + 2];
    vec4 axis = lamps[4 * i + 3];
    vec3 way = place.xyz - surface_point;
    float far = max(sqrt(dot(way, way)), 0.000001);
    way /= far;
    float share = max(dot(normal, way), 0.0) / max(fading.x + far * (fading.y + far * fading.z), 0.001);
    share *= 1.0 - smooth_step((far * place.w - 0.9) * 10.0);
    share *= smooth_step((-dot(way, axis.xyz) - strength.w) * fading.w);
    light += strength.rgb * share;
  }
  return light;
}
)";

inline constexpr char with_lamps[] = R"(  light += lamp_light(normal);
)";

// For a solid, whose inside is never drawn.
inline constexpr char one_sided[] = R"(
vec3 facing_normal() { return normalize(surface_normal); }
float height_of_shadow() { return 0.0; }
)";

// For a mesh, which may be open or have reversed normals: the visible side counts as the outside. The triangle
// determines the visible side; a vertex's normal is a mean and may point away from the camera although the triangle is
// visible.
inline constexpr char two_sided[] = R"(
uniform float shadow_lift;

vec3 facing_normal() {
  vec3 normal = normalize(surface_normal);
  vec3 face = cross(dFdx(surface_point), dFdy(surface_point));
  return dot(face, surface_point) * dot(face, normal) > 0.0 ? -normal : normal;
}
float height_of_shadow() { return shadow_lift; }
)";

inline constexpr char one_color[] = R"(
vec4 base_color() { return surface_color; }
)";

// Along each axis a wave of 1 and -1, averaged over the pixel: exactly 1 or -1 away from the edges, a mean of both
// where an edge crosses the pixel, 0 where squares are smaller than half a pixel. The product of three waves is the
// pattern. It is evaluated a little inside the shape, so that a face that lies on an edge has only one of both colours.
inline constexpr char two_colors[] = R"(
in vec3 shape_point;
in vec3 shape_normal;
uniform vec3 second_color;
uniform float squares_per_meter;

float wave(float place, float width) {
  float side = 1.0 - 2.0 * mod(floor(place), 2.0);
  float to_edge = 0.5 - abs(fract(place) - 0.5);
  return side * min(2.0 * to_edge / max(width, 0.000001), 1.0) * clamp(2.0 - width, 0.0, 1.0);
}

vec4 base_color() {
  vec3 place = shape_point * squares_per_meter - 0.001 * shape_normal;
  vec3 width = fwidth(place);
  float share = 0.5 - 0.5 * wave(place.x, width.x) * wave(place.y, width.y) * wave(place.z, width.z);
  return vec4(mix(surface_color.rgb, second_color, share), surface_color.a);
}
)";

inline constexpr char picture_colors[] = R"(
in vec2 texture_point;
uniform sampler2D picture;

vec4 cut(vec4 color);
vec4 base_color() { return cut(surface_color * texture(picture, texture_point)); }
)";

inline constexpr char whole_picture[] = R"(
vec4 cut(vec4 color) { return color; }
)";

inline constexpr char cut_picture[] = R"(
vec4 cut(vec4 color) {
  if (color.a < 0.5 / 255.0) discard;
  return color;
}
)";

inline constexpr char without_shadows[] = R"(
float sun_share(vec3 normal) { return 1.0; }
)";

// The mean of a square of samples, because the sun isn't a point. Outside the shadow map there are no shadows.
inline constexpr char with_shadows[] = R"(
uniform sampler2DShadow shadow_map;
uniform mat4 shadow_from_view;  // to the map's coordinates: 0 to 1 across, and 1 down to 0 away from the sun
uniform float blur;             // between two samples, in the map's coordinates

float sun_share(vec3 normal) {
  vec3 place = (shadow_from_view * vec4(surface_point + height_of_shadow() * normal, 1.0)).xyz;
  place.z = max(place.z, 0.0);
  float lit = 0.0;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) lit += texture(shadow_map, vec3(place.xy + blur * vec2(x, y), place.z));
  }
  return lit / 25.0;
}
)";

inline constexpr char shadow_fragment_shader[] = R"(#version 330 core
void main() {}
)";

}  // namespace rehearse::gl
