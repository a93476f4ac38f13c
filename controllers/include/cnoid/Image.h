// Image: pixels of a camera's picture. Row 0 is the top row; no padding between rows.
#pragma once

#include "Config.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT Image {
 public:
  Image();
  Image(const Image& other);
  Image& operator=(const Image& other);
  virtual ~Image();

  bool empty() const { return pixels_.empty(); }
  int width() const { return width_; }    // [pixels]
  int height() const { return height_; }  // [pixels]
  /// Bytes per pixel: 1 gray, 2 gray and opacity, 3 red-green-blue, 4 with opacity. A camera delivers 3.
  int numComponents() const { return components_; }
  bool hasAlphaComponent() const { return components_ % 2 == 0; }

  /// width * height * numComponents bytes; null if the image is empty.
  unsigned char* pixels() { return pixels_.data(); }
  const unsigned char* pixels() const { return pixels_.data(); }

  /// Throws std::invalid_argument for a negative size or a number of components outside 1 to 4.
  void setSize(int width, int height, int numComponents);
  /// Changes the size and keeps the number of components.
  void setSize(int width, int height);
  /// Removes the pixels and sets the size to 0; the number of components stays.
  void reset();
  /// Sets all bytes to zero; the size stays.
  void clear();
  void applyVerticalFlip();

  /// Writes a PNG file. False if the name does not end in .png, the image is empty or the file can't be written; the
  /// second form reports the reason. Pixels are stored without compression, so that this library needs no other
  /// library.
  bool save(const std::string& filename) const;
  bool save(const std::string& filename, std::ostream& os) const;

 private:
  std::vector<unsigned char> pixels_;
  int width_ = 0;
  int height_ = 0;
  int components_ = 3;
};

}  // namespace cnoid
