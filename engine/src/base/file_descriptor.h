// An owned file descriptor.
#pragma once

#include <unistd.h>

#include <utility>

namespace rehearse {

/// Closes its descriptor when it is destroyed, and converts to its number. -1: none.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor() {
    if (number_ >= 0) ::close(number_);
  }
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);  // the other one closes the previous descriptor
    return *this;
  }

  operator int() const { return number_; }

 private:
  int number_;
};

}  // namespace rehearse
