// Large data that devices share instead of copying it: images, points, ranges.
#pragma once

#include <memory>

namespace cnoid {

/// For writing: a copy of one's own first, if anybody else holds the data.
template <class Data>
Data& ownData(std::shared_ptr<Data>& data) {
  if (data.use_count() > 1) data = std::make_shared<Data>(*data);
  return *data;
}

/// Takes over what the caller gives away; copies it if others hold it too, since they could still change it.
template <class Data>
std::shared_ptr<Data> takeData(std::shared_ptr<Data>& given) {
  std::shared_ptr<Data> taken = std::move(given);
  given.reset();
  ownData(taken);
  return taken;
}

}  // namespace cnoid
