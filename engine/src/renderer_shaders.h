// The two shaders of the renderer, in GLSL 3.30.
#pragma once

namespace rehearse::gl {

// Everything happens in the camera's frame, where numbers are small. `distance` is along the optical axis.
inline constexpr char vertex_shader[] = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float shift;
layout(location = 3) in mat3 rotation;
layout(location = 6) in vec3 origin;
layout(location = 7) in vec4 scale;
layout(location = 8) in vec4 color;
uniform vec4 lens;
out vec3 surface_point;
out vec3 surface_normal;
flat out vec4 surface_color;

void main() {
  vec3 local = position * scale.xyz + vec3(0.0, 0.0, shift * scale.w);
  surface_point = origin + rotation * local;
  surface_normal = rotation * normal;
  surface_color = color;
  float near_clip = lens.z;
  float far_clip = lens.w;
  float distance = -surface_point.z;
  gl_Position = vec4(lens.x * surface_point.x, -lens.y * surface_point.y,
                     near_clip * (far_clip - distance) / (far_clip - near_clip), distance);
}
)";

// Light adds up in the square of the colours (a gamma of 2, so that half lit doesn't look nearly dark). The sky's light
// is bluish from above and warm and dim from below; the sun is warm; the lamp on the camera keeps what faces it from
// being dark. A surface that faces sun and sky has about its own colour.
inline constexpr char fragment_shader[] = R"(#version 330 core
in vec3 surface_point;
in vec3 surface_normal;
flat in vec4 surface_color;
uniform vec3 up;
uniform vec3 sun;
layout(location = 0) out vec4 color;
layout(location = 1) out float distance;

void main() {
  vec3 normal = normalize(surface_normal);
  vec3 light = mix(vec3(0.20, 0.18, 0.16), vec3(0.40, 0.43, 0.48), 0.5 + 0.5 * dot(normal, up));
  light += vec3(0.50, 0.48, 0.43) * max(dot(normal, sun), 0.0);
  light += vec3(0.18) * max(-dot(normal, normalize(surface_point)), 0.0);
  color = vec4(surface_color.rgb * sqrt(light), surface_color.a);
  distance = 1.0 / gl_FragCoord.w;
}
)";

}  // namespace rehearse::gl
