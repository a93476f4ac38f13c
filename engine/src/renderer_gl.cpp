#include "renderer_gl.h"

#include "renderer_shaders.h"

#include <rehearse/renderer.h>

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <fmt/format.h>

#include <cstddef>
#include <limits>

namespace rehearse::gl {
namespace {

const void* as_offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

std::string text_of(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

/// A mistake in a call is ours; what remains is memory.
void check_errors() { REHEARSE_ASSERT(glGetError() == GL_NO_ERROR, "OpenGL refused a call, or ran out of memory"); }

unsigned compile(GLenum stage, const char* source) {
  const unsigned shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  int compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  REHEARSE_ASSERT(compiled, "our shader doesn't compile");
  return shader;
}

unsigned link_program() {
  const unsigned program = glCreateProgram();
  for (const unsigned shader :
       {compile(GL_VERTEX_SHADER, vertex_shader), compile(GL_FRAGMENT_SHADER, fragment_shader)}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);  // once the program goes
  }
  glLinkProgram(program);
  int linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  REHEARSE_ASSERT(linked, "our shaders don't link");
  return program;
}

void set_attribute(unsigned location, int size, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride), as_offset(offset));
}

/// Attributes 3 to 8 come from `Instance`s, one per instance drawn.
void set_instance_attributes() {
  constexpr std::size_t stride = sizeof(Instance);
  for (unsigned column = 0; column < 3; ++column) {
    set_attribute(3 + column, 3, stride, offsetof(Instance, rotation) + column * 3 * sizeof(float));
  }
  set_attribute(6, 3, stride, offsetof(Instance, origin));
  set_attribute(7, 4, stride, offsetof(Instance, scale));
  set_attribute(8, 4, stride, offsetof(Instance, color));
  for (unsigned location = 3; location <= 8; ++location) glVertexAttribDivisor(location, 1);
}

}  // namespace

Result<std::unique_ptr<Context>> Context::create() {
  std::unique_ptr<Context> context(new Context);
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  context->handle_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!context->handle_) return error("OSMesa can't make an OpenGL 3.3 core context", "Mesa 17 or later is needed");
  if (!OSMesaMakeCurrent(context->handle_, context->window_.data(), GL_UNSIGNED_BYTE, 1, 1)) {
    return error("OSMesa can't make its own context current");
  }
  if (const Result<void> able = context->check_abilities(); !able) return able.errors();
  return context;
}

Context::~Context() {
  if (handle_) OSMesaDestroyContext(handle_);
}

Result<void> Context::check_abilities() {
  const std::string version = text_of(GL_VERSION);  // "4.5 (Core Profile) Mesa 22.3.6"
  const std::size_t mesa = version.find("Mesa ");
  description_ =
      fmt::format("OSMesa, {}, {}", mesa == std::string::npos ? version : version.substr(mesa), text_of(GL_RENDERER));
  int largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (largest < Renderer::max_size) {
    return error(fmt::format("{} draws pictures of at most {} pixels", description_, largest),
                 fmt::format("{} are needed", Renderer::max_size));
  }
  // of OpenGL 4.5, so libOSMesa exports no such symbol
  const auto clip_control = reinterpret_cast<PFNGLCLIPCONTROLPROC>(OSMesaGetProcAddress("glClipControl"));
  if (!clip_control) return error(fmt::format("{} has no glClipControl", description_), "Mesa 17 or later is needed");
  clip_control(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  return {};
}

void Context::make_current() {
  if (OSMesaGetCurrentContext() == handle_) return;
  const bool made = OSMesaMakeCurrent(handle_, window_.data(), GL_UNSIGNED_BYTE, 1, 1);
  REHEARSE_ASSERT(made, "OSMesa can't make its own context current");
}

Painter::Painter() : program_(link_program()) {
  glGenBuffers(1, &instances_);
  meshes_ = {upload(box_mesh()), upload(sphere_mesh()), upload(cylinder_mesh()), upload(capsule_mesh())};
  uniforms_ = {glGetUniformLocation(program_, "lens"), glGetUniformLocation(program_, "up"),
               glGetUniformLocation(program_, "sun")};
  // Distances are kept as near / distance in a float: the resolution is the same share of the distance everywhere.
  glDepthFunc(GL_GREATER);
  glClearDepth(0.0);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);  // pictures are drawn upside down, so that the first row read back is the top one
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  check_errors();
}

Painter::Buffers Painter::upload(const Mesh& mesh) const {
  Buffers buffers;
  buffers.count = static_cast<int>(mesh.indices.size());
  glGenVertexArrays(1, &buffers.array);
  glBindVertexArray(buffers.array);
  unsigned names[2] = {};
  glGenBuffers(2, names);
  glBindBuffer(GL_ARRAY_BUFFER, names[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(Vertex)), mesh.vertices.data(),
               GL_STATIC_DRAW);
  set_attribute(0, 3, sizeof(Vertex), offsetof(Vertex, position));
  set_attribute(1, 3, sizeof(Vertex), offsetof(Vertex, normal));
  set_attribute(2, 1, sizeof(Vertex), offsetof(Vertex, shift));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, names[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * sizeof(std::uint16_t)),
               mesh.indices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  set_instance_attributes();
  return buffers;
}

void Painter::begin(const View& view) {
  glUseProgram(program_);
  glUniform4fv(uniforms_.lens, 1, view.lens.data());
  glUniform3fv(uniforms_.up, 1, view.up.data());
  glUniform3fv(uniforms_.sun, 1, view.sun.data());
}

void Painter::paint(std::size_t mesh, std::span<const Instance> instances, bool translucent) {
  if (translucent) {
    glEnablei(GL_BLEND, 0);  // the colour only, never the distance
  } else {
    glDisablei(GL_BLEND, 0);
  }
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size_bytes()), instances.data(), GL_STREAM_DRAW);
  glBindVertexArray(meshes_[mesh].array);
  glDrawElementsInstanced(GL_TRIANGLES, meshes_[mesh].count, GL_UNSIGNED_SHORT, nullptr,
                          static_cast<GLsizei>(instances.size()));
}

void Target::begin(int width, int height, bool depth, const Color& background) {
  if (width != width_ || height != height_ || depth != depth_) {
    width_ = width;
    height_ = height;
    depth_ = depth;
    allocate();
  }
  glViewport(0, 0, width_, height_);
  glClearBufferfv(GL_COLOR, 0, background.data());
  if (depth_) {
    const float nowhere[4] = {std::numeric_limits<float>::infinity(), 0.0f, 0.0f, 0.0f};
    glClearBufferfv(GL_COLOR, 1, nowhere);
  }
  glClear(GL_DEPTH_BUFFER_BIT);
}

void Target::allocate() {
  if (framebuffer_ != 0) {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
  }
  glGenFramebuffers(1, &framebuffer_);
  glGenRenderbuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const auto attach = [&](std::size_t buffer, GLenum format, GLenum attachment) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers_[buffer]);
    glRenderbufferStorage(GL_RENDERBUFFER, format, width_, height_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffers_[buffer]);
  };
  attach(0, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(1, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
  if (depth_) attach(2, GL_R32F, GL_COLOR_ATTACHMENT1);
  const GLenum outputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(depth_ ? 2 : 1, outputs);
  REHEARSE_ASSERT(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE,
                  "OpenGL can't draw into a picture of this size");
  check_errors();
}

Image Target::read_color() {
  const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  pixels_.resize(count * 4);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  check_errors();
  Image image{width_, height_, std::vector<std::uint8_t>(count * 3)};
  const std::uint8_t* from = pixels_.data();
  for (std::uint8_t* to = image.pixels.data(); to != image.pixels.data() + count * 3; to += 3, from += 4) {
    to[0] = from[0];
    to[1] = from[1];
    to[2] = from[2];
  }
  return image;
}

DepthImage Target::read_depth() const {
  if (!depth_) return {};
  const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  DepthImage image{width_, height_, std::vector<float>(count)};
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_, height_, GL_RED, GL_FLOAT, image.meters.data());
  check_errors();
  return image;
}

void finish() { glFinish(); }

}  // namespace rehearse::gl
