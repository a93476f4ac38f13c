// A window that moves over bytes as they come. Internal.
#pragma once

#include <rehearse/mcap_stream.h>

#include "codec.h"

namespace rehearse::mcap {

class ByteWindow {
 public:
  explicit ByteWindow(ReadBytes source) : source_(std::move(source)) {}

  /// Reads until `count` bytes are in the window; false if fewer come. The memory grows with what came, never with
  /// `count` alone.
  bool hold(std::uint64_t count);
  /// What is in the window and read already; valid until the next hold() or skip().
  Bytes held() const { return {buffer_.data() + begin_, end_ - begin_}; }
  /// Moves the window's beginning behind these bytes, which are in it.
  void take(std::size_t count);
  /// Offset of the window's beginning in all that came.
  std::uint64_t offset() const { return offset_; }
  /// Why no more came, if that was an error.
  const Diagnostics& failure() const { return failure_; }

 private:
  void make_room();

  ReadBytes source_;
  RawBuffer buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
  bool ended_ = false;
  Diagnostics failure_;
};

}  // namespace rehearse::mcap
