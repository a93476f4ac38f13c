// A nameless file for data that can't be mapped where it is: input of pipes, and logs in other containers. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <string>

#include "base/file_descriptor.h"

namespace rehearse::mcap {

/// A file without a name, which is removed when its descriptor is closed.
class TemporaryFile {
 public:
  /// Created in the folder for temporary files. If that fails, descriptor() is -1 and errno states the reason.
  TemporaryFile();

  /// False: errno states the reason.
  bool append(Bytes bytes);
  int descriptor() const { return descriptor_; }
  /// The present size [bytes].
  std::uint64_t size() const;
  const std::string& folder() const { return folder_; }
  /// A name that opens this file again.
  std::string path() const;

 private:
  FileDescriptor descriptor_;
  std::string folder_;
};

}  // namespace rehearse::mcap
