#include "joint_arrays.h"

#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cstring>

namespace rehearse {
namespace {

constexpr std::size_t after_stamp = 12;  // offset after four bytes of encapsulation, seconds and nanoseconds

}  // namespace

bool JointArrays::read(std::span<const std::byte> payload) {
  // Equal sizes and equal bytes between the stamp and the numbers mean equal names and counts.
  bool same = !frame_.empty() && payload.size() == frame_.size() && std::memcmp(payload.data(), frame_.data(), 4) == 0;
  std::size_t from = after_stamp;
  for (std::size_t i = 0; same && i < arrays_.size(); ++i) {
    same = std::memcmp(payload.data() + from, frame_.data() + from, offsets_[i] - from) == 0;
    from = offsets_[i] + arrays_[i].size() * sizeof(double);
  }
  if (!same) return read_everything(payload);
  layout_changed_ = false;
  for (std::size_t i = 0; i < arrays_.size(); ++i)
    if (!arrays_[i].empty())
      std::memcpy(arrays_[i].data(), payload.data() + offsets_[i], arrays_[i].size() * sizeof(double));
  return true;
}

bool JointArrays::read_everything(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::Header header;
  std::vector<std::string> names;
  frame_.clear();  // its offsets end here, also if the message turns out to be invalid
  msg::decode(reader, header);
  msg::detail::decode_value(reader, names);
  layout_changed_ = names != names_;
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    const std::size_t count = arrays_[i].size();
    reader.get_sequence(arrays_[i]);
    layout_changed_ = layout_changed_ || arrays_[i].size() != count;
    offsets_[i] = reader.position() - arrays_[i].size() * sizeof(double);
    if (!reader.ok()) return false;
  }
  names_ = std::move(names);
  if (!reader.swapped()) frame_.assign(payload.begin(), payload.end());
  return true;
}

void JointArrays::take(const msg::JointState& message) {
  const std::vector<double>* const values[] = {&message.position, &message.velocity, &message.effort};
  frame_.clear();
  layout_changed_ = names_ != message.name;
  names_ = message.name;
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    layout_changed_ = layout_changed_ || arrays_[i].size() != values[i]->size();
    arrays_[i] = *values[i];
  }
}

bool JointArrays::fit_the_names() const {
  return std::ranges::all_of(
      arrays_, [&](const std::vector<double>& array) { return array.empty() || array.size() == names_.size(); });
}

}  // namespace rehearse
