#include "renderer_gl.h"

#include <rehearse/renderer.h>

#include <fmt/format.h>
#include <pthread.h>

#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

#include "gl_functions.h"

namespace rehearse::gl {
namespace {

std::string text_of(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

void copy_without_alpha(const std::vector<std::uint8_t>& rgba, std::vector<std::uint8_t>& rgb) {
  const std::uint8_t* from = rgba.data();
  for (std::uint8_t* to = rgb.data(); to != rgb.data() + rgb.size(); to += 3, from += 4) {
    to[0] = from[0];
    to[1] = from[1];
    to[2] = from[2];
  }
}

/// Averages squares of `factor` x `factor` pixels and drops the opacity. `row`: bytes of one row of `rgba`.
void shrink_without_alpha(const std::vector<std::uint8_t>& rgba, std::size_t row, int factor, Image& image) {
  const auto step = static_cast<std::size_t>(factor);
  const unsigned count = static_cast<unsigned>(factor * factor);
  std::size_t at = 0;
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        unsigned sum = count / 2;
        for (std::size_t i = 0; i < count; ++i) {
          sum += rgba[(y * step + i / step) * row + (x * step + i % step) * 4 + channel];
        }
        image.pixels[at++] = static_cast<std::uint8_t>(sum / count);
      }
    }
  }
}

constexpr const char* threads_of_mesa = "LP_NUM_THREADS";

bool forgoes_threads = false;  // false in forks of a process that does

/// Mesa makes its threads with the first context of a process, as many as the environment states then.
class WithoutThreads {
 public:
  WithoutThreads() {
    if (!forgoes_threads) return;
    if (const char* stated = std::getenv(threads_of_mesa)) before_ = stated;
    setenv(threads_of_mesa, "0", 1);
  }
  ~WithoutThreads() {
    if (!forgoes_threads) return;
    before_ ? setenv(threads_of_mesa, before_->c_str(), 1) : unsetenv(threads_of_mesa);
  }
  WithoutThreads(const WithoutThreads&) = delete;
  WithoutThreads& operator=(const WithoutThreads&) = delete;

 private:
  std::optional<std::string> before_;
};

}  // namespace

void Context::forgo_threads() {
  static const int noted = pthread_atfork(nullptr, nullptr, [] { forgoes_threads = false; });
  forgoes_threads = noted == 0;
}

Result<std::unique_ptr<Context>> Context::create() {
  REHEARSE_TRY(load_functions());
  const WithoutThreads without;
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
  REHEARSE_TRY(context->check_abilities());
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
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  return {};
}

void Context::make_current() {
  if (OSMesaGetCurrentContext() == handle_) return;
  const bool made = OSMesaMakeCurrent(handle_, window_.data(), GL_UNSIGNED_BYTE, 1, 1);
  REHEARSE_ASSERT(made, "OSMesa can't make its own context current");
}

void Target::begin(int width, int height, bool depth, const Color& background) {
  if (width != width_ || height != height_ || depth != depth_) {
    width_ = width;
    height_ = height;
    depth_ = depth;
    allocate();
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
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

Image Target::read_color(int factor) {
  const std::size_t row = static_cast<std::size_t>(width_) * 4;
  pixels_.resize(row * static_cast<std::size_t>(height_));
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  check_errors();
  Image image{width_ / factor, height_ / factor, {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  if (factor == 1) {
    copy_without_alpha(pixels_, image.pixels);
  } else {
    shrink_without_alpha(pixels_, row, factor, image);
  }
  return image;
}

DepthImage Target::read_depth(int factor) const {
  if (!depth_) return {};
  const auto row = static_cast<std::size_t>(width_);
  std::vector<float> meters(row * static_cast<std::size_t>(height_));
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_, height_, GL_RED, GL_FLOAT, meters.data());
  check_errors();
  if (factor == 1) return {width_, height_, std::move(meters)};
  DepthImage image{width_ / factor, height_ / factor, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.meters.push_back(meters[static_cast<std::size_t>(y * factor + factor / 2) * row +
                                    static_cast<std::size_t>(x * factor + factor / 2)]);
    }
  }
  return image;
}

void ShadowMap::begin() {
  if (framebuffer_ == 0) {
    glGenTextures(1, &texture_);
    glActiveTexture(GL_TEXTURE0);  // it stays bound; Painter binds its textures to a different unit
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);  // the border is 0: no surface
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    REHEARSE_ASSERT(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE,
                    "OpenGL can't draw a shadow map");
    check_errors();
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size, size);
  glClear(GL_DEPTH_BUFFER_BIT);
}

void finish() { glFinish(); }

void check_errors() { REHEARSE_ASSERT(glGetError() == GL_NO_ERROR, "OpenGL refused a call, or ran out of memory"); }

}  // namespace rehearse::gl
