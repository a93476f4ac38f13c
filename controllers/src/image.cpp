#include <cnoid/Image>

#include <algorithm>
#include <fstream>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "png_encoder.h"

namespace cnoid {

Image::Image() = default;
Image::Image(const Image& other) = default;
Image& Image::operator=(const Image& other) = default;
Image::~Image() = default;

void Image::setSize(int width, int height, int numComponents) {
  if (width < 0 || height < 0 || numComponents < 1 || numComponents > 4) {
    throw std::invalid_argument("an image can't be " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels of " + std::to_string(numComponents) + " components");
  }
  width_ = width;
  height_ = height;
  components_ = numComponents;
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                 static_cast<std::size_t>(numComponents));
}

void Image::setSize(int width, int height) { setSize(width, height, components_); }

void Image::reset() { setSize(0, 0); }

void Image::clear() { std::fill(pixels_.begin(), pixels_.end(), static_cast<unsigned char>(0)); }

void Image::applyVerticalFlip() {
  const auto rowSize = static_cast<std::ptrdiff_t>(width_) * components_;
  for (int row = 0; row < height_ / 2; ++row) {
    const auto upper = pixels_.begin() + row * rowSize;
    std::swap_ranges(upper, upper + rowSize, pixels_.begin() + (height_ - 1 - row) * rowSize);
  }
}

bool Image::save(const std::string& filename) const {
  std::ostringstream ignored;
  return save(filename, ignored);
}

bool Image::save(const std::string& filename, std::ostream& os) const {
  const std::string suffix = ".png";
  if (filename.size() < suffix.size() ||
      filename.compare(filename.size() - suffix.size(), suffix.size(), suffix) != 0) {
    os << filename << ": an image can only be saved as .png\n";
    return false;
  }
  if (empty()) {
    os << filename << ": the image is empty\n";
    return false;
  }
  std::ofstream file(filename, std::ios::binary);
  file << encodePng(width_, height_, components_, pixels_);
  file.close();
  if (!file) os << filename << ": can't be written\n";
  return !file.fail();
}

}  // namespace cnoid
