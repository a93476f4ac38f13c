#include "byte_window.h"

#include <algorithm>
#include <cstring>

namespace rehearse::mcap {

namespace {
constexpr std::size_t smallest = std::size_t{1} << 17;  // of the buffer [bytes]; twice what a pipe holds
}

bool ByteWindow::hold(std::uint64_t count) {
  while (end_ - begin_ < count && !ended_) {
    if (end_ == buffer_.capacity()) make_room();
    auto came = source_({buffer_.data() + end_, buffer_.capacity() - end_});
    if (!came) failure_ = came.errors();
    ended_ = !came || *came == 0;
    if (!ended_) end_ += *came;
  }
  return end_ - begin_ >= count;
}

void ByteWindow::take(std::size_t count) {
  REHEARSE_ASSERT(count <= end_ - begin_, "only what is held can be taken");
  begin_ += count;
  offset_ += count;
  if (begin_ == end_) begin_ = end_ = 0;
}

/// Moves what is held to the front if that frees half of the buffer, else doubles it.
void ByteWindow::make_room() {
  const std::size_t held = end_ - begin_;
  if (buffer_.capacity() > 0 && held <= buffer_.capacity() / 2) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, held);
  } else {
    RawBuffer larger;
    larger.reserve(std::max(smallest, 2 * buffer_.capacity()));
    if (held > 0) std::memcpy(larger.data(), buffer_.data() + begin_, held);
    std::swap(buffer_, larger);
  }
  begin_ = 0;
  end_ = held;
}

}  // namespace rehearse::mcap
