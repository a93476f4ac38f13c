// Large data that devices share instead of copying it: images, points, ranges.
#pragma once

#include <memory>

namespace cnoid {

/// Prepares data for writing: makes a copy first if the data have other owners.
template <class Data>
Data& ownData(std::shared_ptr<Data>& data) {
  if (data.use_count() > 1) data = std::make_shared<Data>(*data);
  return *data;
}

/// Takes the caller's data; copies them if they have other owners, which could still change them.
template <class Data>
std::shared_ptr<Data> takeData(std::shared_ptr<Data>& given) {
  std::shared_ptr<Data> taken = std::move(given);
  given.reset();
  ownData(taken);
  return taken;
}

}  // namespace cnoid
