#include "renderer_painter.h"

#include "renderer_gl.h"
#include "renderer_shaders.h"

#include <rehearse/renderer.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace rehearse::gl {
namespace {

using Parts = std::vector<const char*>;  // of a shader's text

constexpr int picture_unit = 1;  // unit 0 contains the shadow map

const void* as_offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

unsigned compile(GLenum stage, const Parts& parts) {
  const unsigned shader = glCreateShader(stage);
  glShaderSource(shader, static_cast<GLsizei>(parts.size()), parts.data(), nullptr);
  glCompileShader(shader);
  int compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  REHEARSE_ASSERT(compiled, "our shader doesn't compile");
  return shader;
}

unsigned link_program(const Parts& vertex, const Parts& fragment) {
  const unsigned program = glCreateProgram();
  for (const unsigned shader : {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);  // it is deleted together with the program
  }
  glLinkProgram(program);
  int linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  REHEARSE_ASSERT(linked, "our shaders don't link");
  return program;
}

/// The part of the vertex shader that passes data for a kind of skin to the fragment shader.
const char* handed_on(Skin::Kind kind) {
  switch (kind) {
    case Skin::Kind::even:
    case Skin::Kind::mesh: return hands_on_nothing;
    case Skin::Kind::checkered: return hands_on_shape_point;
    case Skin::Kind::textured:
    case Skin::Kind::cut_out: return hands_on_texture_point;
  }
  REHEARSE_ASSERT(false, "a kind of skin that doesn't exist");
}

/// The parts of the fragment shader that belong to a kind of skin.
Parts skin_parts(Skin::Kind kind) {
  switch (kind) {
    case Skin::Kind::even: return {one_sided, one_color};
    case Skin::Kind::checkered: return {one_sided, two_colors};
    case Skin::Kind::mesh: return {two_sided, one_color};
    case Skin::Kind::textured: return {two_sided, picture_colors, whole_picture};
    case Skin::Kind::cut_out: return {two_sided, picture_colors, cut_picture};
  }
  REHEARSE_ASSERT(false, "a kind of skin that doesn't exist");
}

unsigned make_program(Pass pass, bool lamps, Skin::Kind kind) {
  if (pass == Pass::shadow) return link_program({vertex_shader, hands_on_nothing}, {shadow_fragment_shader});
  static const std::string most = fmt::format("const int MOST_LAMPS = {};\n", Renderer::max_lights);
  Parts fragment{fragment_shader_head};
  if (lamps) fragment.insert(fragment.end(), {most.c_str(), lamp_function});
  fragment.push_back(fragment_shader_light);
  if (lamps) fragment.push_back(with_lamps);
  fragment.push_back(fragment_shader_color);
  const Parts own = skin_parts(kind);
  fragment.insert(fragment.end(), own.begin(), own.end());
  fragment.push_back(pass == Pass::shaded ? with_shadows : without_shadows);
  return link_program({vertex_shader, handed_on(kind)}, fragment);
}

void set_attribute(unsigned location, int size, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride), as_offset(offset));
}

/// Sets attributes 3 to 8 from `Instance`s, one per instance drawn.
void set_instance_attributes() {
  constexpr std::size_t stride = sizeof(Instance);
  for (std::size_t column = 0; column < 3; ++column) {
    set_attribute(static_cast<unsigned>(3 + column), 3, stride,
                  offsetof(Instance, rotation) + column * 3 * sizeof(float));
  }
  set_attribute(6, 3, stride, offsetof(Instance, origin));
  set_attribute(7, 4, stride, offsetof(Instance, scale));
  set_attribute(8, 4, stride, offsetof(Instance, color));
  for (unsigned location = 3; location <= 8; ++location) glVertexAttribDivisor(location, 1);
}

/// Copies data into a new buffer, which stays bound.
template <class Element>
void fill_buffer(GLenum target, std::span<const Element> elements) {
  unsigned name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(elements.size_bytes()), elements.data(), GL_STATIC_DRAW);
}

}  // namespace

Painter::Painter() {
  glGenBuffers(1, &instances_);
  for (const UnitMesh& mesh : {box_mesh(), sphere_mesh(), cylinder_mesh(), capsule_mesh()})
    meshes_.push_back(upload(mesh.vertices, mesh.indices));
  // The z buffer stores near / distance as a float: the relative resolution is the same at every distance.
  glDepthFunc(GL_GREATER);
  glClearDepth(0.0);
  glEnable(GL_DEPTH_TEST);
  glFrontFace(GL_CW);  // pictures are drawn upside down, so that the first row read back is the top one
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  check_errors();
}

Painter::Buffers Painter::upload(std::span<const Vertex> vertices, std::span<const std::uint32_t> indices) const {
  Buffers buffers;
  buffers.count = static_cast<int>(indices.size());
  glGenVertexArrays(1, &buffers.array);
  glBindVertexArray(buffers.array);
  fill_buffer(GL_ARRAY_BUFFER, vertices);
  set_attribute(0, 3, sizeof(Vertex), offsetof(Vertex, position));
  set_attribute(1, 3, sizeof(Vertex), offsetof(Vertex, normal));
  set_attribute(2, 1, sizeof(Vertex), offsetof(Vertex, shift));
  fill_buffer(GL_ELEMENT_ARRAY_BUFFER, indices);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  set_instance_attributes();
  return buffers;
}

std::size_t Painter::add(const MeshPart& part) {
  REHEARSE_ASSERT(part.normals.size() == part.vertices.size(), "each vertex of a mesh has a normal");
  std::vector<Vertex> vertices;
  vertices.reserve(part.vertices.size());
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    const Eigen::Vector3f &p = part.vertices[i], &n = part.normals[i];
    vertices.push_back({{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, 0.0f});
  }
  static_assert(sizeof(part.triangles[0]) == 3 * sizeof(std::uint32_t), "triangles are indices one after the other");
  const std::uint32_t* indices = part.triangles.empty() ? nullptr : part.triangles[0].data();
  meshes_.push_back(upload(vertices, {indices, 3 * part.triangles.size()}));
  if (!part.texture_coordinates.empty()) {
    REHEARSE_ASSERT(part.texture_coordinates.size() == part.vertices.size(), "a place in the texture for each vertex");
    fill_buffer(GL_ARRAY_BUFFER, std::span<const Eigen::Vector2f>(part.texture_coordinates));
    set_attribute(9, 2, sizeof(Eigen::Vector2f), 0);
  }
  check_errors();
  return meshes_.size() - 1;
}

unsigned Painter::add(const Texture& texture) {
  const auto pixels = static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  REHEARSE_ASSERT(pixels > 0 && texture.rgba.size() == 4 * pixels, "a texture has four bytes a pixel");
  constexpr int largest = 16384;  // OpenGL 4.5 requires this of implementations
  REHEARSE_ASSERT(std::max(texture.width, texture.height) <= largest, "a texture is larger than 16384 pixels");
  unsigned name = 0;
  glGenTextures(1, &name);
  glActiveTexture(GL_TEXTURE0 + picture_unit);
  glBindTexture(GL_TEXTURE_2D, name);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, texture.width, texture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               texture.rgba.data());
  glGenerateMipmap(GL_TEXTURE_2D);  // without mipmaps, a texture far away flickers
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  check_errors();
  return name;
}

void Painter::begin(Pass pass, const View& view) {
  pass_ = pass;
  view_ = view;
  for (auto& of_pass : programs_)
    for (auto& of_lamps : of_pass)
      for (Program& program : of_lamps) program.is_ready = false;
}

Painter::Program& Painter::program_of(Skin::Kind kind) {
  const bool lamps = !view_.lamps.empty() && pass_ != Pass::shadow;
  Program& program = programs_[static_cast<std::size_t>(pass_)][lamps ? 1 : 0][static_cast<std::size_t>(kind)];
  if (program.name == 0) program.name = make_program(pass_, lamps, kind);
  return program;
}

void Painter::use(const Skin& skin) {
  Program& program = program_of(pass_ == Pass::shadow ? Skin::Kind::even : skin.kind);
  // OpenGL ignores uniforms that a program doesn't have
  const auto uniform = [&](const char* name) { return glGetUniformLocation(program.name, name); };
  glUseProgram(program.name);
  if (!program.is_ready) {
    glUniformMatrix4fv(uniform("projection"), 1, GL_FALSE, view_.projection.data());
    glUniform3fv(uniform("up"), 1, view_.up.data());
    glUniform3fv(uniform("sun"), 1, view_.sun.data());
    glUniformMatrix4fv(uniform("shadow_from_view"), 1, GL_FALSE, view_.shadow_from_view.data());
    glUniform1f(uniform("blur"), view_.blur);
    glUniform1f(uniform("shadow_lift"), view_.lift);
    glUniform1i(uniform("picture"), picture_unit);
    if (!view_.lamps.empty()) {
      static_assert(sizeof(Lamp) == 16 * sizeof(float), "a lamp is four vectors");
      glUniform1i(uniform("lamp_count"), static_cast<int>(view_.lamps.size()));
      glUniform4fv(uniform("lamps"), static_cast<int>(4 * view_.lamps.size()), view_.lamps[0].place.data());
    }
    program.is_ready = true;
  }
  if (skin.kind == Skin::Kind::checkered) {
    glUniform3fv(uniform("second_color"), 1, skin.second_color.data());
    glUniform1f(uniform("squares_per_meter"), skin.squares_per_meter);
  }
  if (skin.texture != 0) {
    glActiveTexture(GL_TEXTURE0 + picture_unit);
    glBindTexture(GL_TEXTURE_2D, skin.texture);
  }
}

void Painter::paint(std::size_t mesh, const Skin& skin, std::span<const Instance> instances, bool translucent) {
  if (translucent) {
    glEnablei(GL_BLEND, 0);  // only the colour, never the distance
  } else {
    glDisablei(GL_BLEND, 0);
  }
  use(skin);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size_bytes()), instances.data(), GL_STREAM_DRAW);
  if (!skin.both_sides) {
    glEnable(GL_CULL_FACE);
    // far sides of solid shapes cast the shadows: near sides would cause speckles on themselves
    glCullFace(pass_ == Pass::shadow ? GL_FRONT : GL_BACK);
    draw(meshes_[mesh], instances.size());
  } else if (!translucent) {
    glDisable(GL_CULL_FACE);
    draw(meshes_[mesh], instances.size());
  } else {
    glEnable(GL_CULL_FACE);
    for (const GLenum left_out : {GL_FRONT, GL_BACK}) {  // the far sides are drawn first
      glCullFace(left_out);
      draw(meshes_[mesh], instances.size());
    }
  }
}

void Painter::draw(const Buffers& mesh, std::size_t instances) const {
  glBindVertexArray(mesh.array);
  glDrawElementsInstanced(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(instances));
}

}  // namespace rehearse::gl
