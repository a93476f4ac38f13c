// The protocol of a tap's ring under the memory model of C: each load of the reader returns each value that the model
// permits, and the reader never takes a copy that mixes records.
//
// The writer doesn't depend on the reader, so its stores are made once, with their views: a view has the earliest store
// of each place that a reader may still see after it has synchronised with the store. The reader's code then runs once
// for each sequence of choices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace {

class Model {
 public:
  /// What a wrong protocol leaves out.
  enum class Fault { none, no_release_fence, no_acquire_fence, relaxed_written };

  explicit Model(Fault fault) : fault_(fault) {}

  // The writer's operations.
  void store(const std::uint64_t* at, std::uint64_t value, bool releases) {
    std::vector<Store>& stores = stores_of(at);
    written_[at] = stores.size();
    View view = releases && fault_ != Fault::relaxed_written ? written_ : at_fence_;
    view[at] = stores.size();
    stores.push_back({value, std::move(view)});
  }
  void release_fence() {
    if (fault_ != Fault::no_release_fence) at_fence_ = written_;
  }

  // The reader's operations.
  std::uint64_t load(const std::uint64_t* at, bool acquires) {
    std::vector<Store>& stores = stores_of(at);
    if (!is_reading_) return stores.back().value;  // the writer reads its own stores
    std::size_t& earliest = seen_[at];
    earliest += choose(stores.size() - earliest);
    const Store& chosen = stores[earliest];
    merge(chosen.view, loaded_);
    if (acquires) merge(chosen.view, seen_);
    return chosen.value;
  }
  void acquire_fence() {
    if (fault_ != Fault::no_acquire_fence) merge(loaded_, seen_);
  }

  /// Calls `read` for each sequence of choices. Returns their number.
  template <class Read>
  std::size_t explore(Read read) {
    is_reading_ = true;
    std::size_t runs = 0;
    do {
      seen_.clear();
      loaded_.clear();
      depth_ = 0;
      read();
      ++runs;
    } while (next());
    is_reading_ = false;
    return runs;
  }

 private:
  using View = std::map<const std::uint64_t*, std::size_t>;
  struct Store {
    std::uint64_t value;
    View view;
  };
  struct Choice {
    std::size_t taken, count;
  };

  std::vector<Store>& stores_of(const std::uint64_t* at) {
    std::vector<Store>& stores = stores_[at];
    if (stores.empty()) stores.push_back({*at, {}});
    return stores;
  }
  static void merge(const View& from, View& into) {
    for (const auto& [at, index] : from) into[at] = std::max(into[at], index);
  }
  std::size_t choose(std::size_t count) {
    if (depth_ == choices_.size()) choices_.push_back({0, count});
    return choices_[depth_++].taken;
  }
  bool next() {
    while (!choices_.empty() && choices_.back().taken + 1 == choices_.back().count) choices_.pop_back();
    if (choices_.empty()) return false;
    ++choices_.back().taken;
    return true;
  }

  Fault fault_;
  bool is_reading_ = false;
  std::map<const std::uint64_t*, std::vector<Store>> stores_;
  View written_, at_fence_;  // of the writer
  View seen_, loaded_;       // of the reader
  std::vector<Choice> choices_;
  std::size_t depth_ = 0;
};

Model* model = nullptr;

}  // namespace

#define TAP_LOAD(place) model->load(place, false)
#define TAP_LOAD_ACQUIRE(place) model->load(place, true)
#define TAP_STORE(place, value) model->store(place, value, false)
#define TAP_STORE_RELEASE(place, value) model->store(place, value, true)
#define TAP_FENCE_ACQUIRE() model->acquire_fence()
#define TAP_FENCE_RELEASE() model->release_fence()
#include <rehearse/tap_ring.h>

namespace {

constexpr std::size_t ring_words = 8;

/// A record of that size; all its words but the first are of this record alone.
std::vector<std::uint64_t> record_of(std::uint64_t tick, std::uint64_t size) {
  std::vector<std::uint64_t> record{size};
  while (record.size() < size) record.push_back(100 * (tick + 1) + record.size());
  return record;
}

struct Explored {
  std::size_t runs = 0, records = 0, overtaken = 0, nothing = 0, damaged = 0, mixed = 0;
};

/// The writer appends records of these sizes, the reader takes `takes` times, whenever that is.
Explored explore(Model::Fault fault, const std::vector<std::uint64_t>& sizes, int takes) {
  Model here(fault);
  model = &here;
  tap_ring_head head{};
  std::uint64_t words[ring_words] = {};
  tap_ring_writer writer{};
  writer.head = &head;
  writer.words = words;
  writer.size = ring_words;
  std::map<std::uint64_t, std::vector<std::uint64_t>> by_place;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::vector<std::uint64_t> record = record_of(i, sizes[i]);
    by_place[writer.written] = record;
    tap_ring_publish(&writer, record.data(), record.size());
  }
  Explored found;
  found.runs = here.explore([&] {
    std::uint64_t place = 0;
    for (int i = 0; i < takes; ++i) {
      std::uint64_t record[ring_words], count = 0;
      const std::uint64_t begin = place;
      switch (tap_ring_take(&head, words, ring_words, &place, record, ring_words, &count)) {
        case tap_nothing: ++found.nothing; break;
        case tap_overtaken:
          ++found.overtaken;
          EXPECT_GT(place, begin);
          break;
        case tap_damaged: ++found.damaged; break;
        case tap_record: {
          ++found.records;
          const bool is_whole = by_place[begin] == std::vector<std::uint64_t>(record, record + count);
          found.mixed += is_whole ? 0 : 1;
        }
      }
    }
  });
  return found;
}

TEST(TapRing, NeverMixesRecordsWhateverItsLoadsReturn) {
  for (const std::vector<std::uint64_t>& sizes :
       {std::vector<std::uint64_t>{4, 4, 4}, {4, 5, 4, 4}, {5, 4, 5}, {8, 4, 8}, {4, 4, 8, 4}}) {
    const Explored found = explore(Model::Fault::none, sizes, 4);
    EXPECT_EQ(found.mixed, 0u);
    EXPECT_EQ(found.damaged, 0u);
    EXPECT_GT(found.records, 30u);
    EXPECT_GT(found.overtaken, 10u);
    EXPECT_GT(found.nothing, 0u);
  }
}

TEST(TapRing, WouldMixRecordsWithoutEachOfItsFences) {
  for (const Model::Fault fault :
       {Model::Fault::no_release_fence, Model::Fault::no_acquire_fence, Model::Fault::relaxed_written}) {
    const Explored found = explore(fault, {4, 4, 4}, 1);
    EXPECT_GT(found.mixed + found.damaged, 0u) << static_cast<int>(fault);
  }
}

}  // namespace
