#include "tap_ring.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <rehearse/tap_ring.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t fewest_words = 1 << 6;

struct flock lock_of(int byte) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = byte;
  lock.l_len = 1;
  return lock;
}

/// The process that has locked that byte; 0: none.
int owner_of(int file, int byte) {
  struct flock lock = lock_of(byte);
  return ::fcntl(file, F_GETLK, &lock) != 0 || lock.l_type == F_UNLCK ? 0 : static_cast<int>(lock.l_pid);
}

std::uint64_t hash_of_head(const tap_ring_head& head) {
  std::uint64_t words[offsetof(tap_ring_head, hash) / 8 - 1];
  std::memcpy(words, reinterpret_cast<const std::byte*>(&head) + 8, sizeof words);
  return tap_hash(words, std::size(words));
}

std::uint64_t hash_of_definitions(std::span<const std::byte> text) {
  std::uint64_t hash = text.size();
  for (std::size_t i = 0; i < text.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, text.data() + i, std::min<std::size_t>(8, text.size() - i));
    hash = tap_mix(hash, word);
  }
  return hash;
}

bool ends(const char* text, std::size_t size) { return std::memchr(text, 0, size) != nullptr; }

}  // namespace

fs::path TapRing::file_of(const std::string& name) {
  return fmt::format("/dev/shm/rehearse-tap-{}-{}", ::geteuid(), name);
}

Result<std::unique_ptr<TapRing>> TapRing::open(const fs::path& file, Use use) {
  const std::string name = file.string();
  FileDescriptor descriptor(::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (descriptor < 0 && errno == ENOENT) return std::unique_ptr<TapRing>();
  if (descriptor < 0)
    return error_in(name, errno == ELOOP ? "it is a link, and none is followed"
                                         : fmt::format("it can't be opened: {}", std::strerror(errno)));
  struct stat found {};
  if (::fstat(descriptor, &found) != 0 || !S_ISREG(found.st_mode))
    return error_in(name, "it is no file, and so no ring of a tap");
  if (found.st_uid != ::geteuid() || (found.st_mode & 077) != 0)
    return error_in(name, "it belongs to another user, or others may open it: a tap makes no such ring");
  std::uint64_t magic = 0;  // the loop writes it last
  if (::pread(descriptor, &magic, sizeof magic, 0) < 0)
    return error_in(name, fmt::format("it can't be read: {}", std::strerror(errno)));
  if (magic == 0) return std::unique_ptr<TapRing>();
  const auto size = static_cast<std::size_t>(found.st_size);
  if (magic != TAP_MAGIC || size < tap_words_place) return error_in(name, "it is no ring of a tap");
  struct flock lock = lock_of(tap_lock_of_reader);
  if (use == Use::takes && ::fcntl(descriptor, F_SETLK, &lock) != 0)
    return error_in(name, fmt::format("process {} records this tap already", owner_of(descriptor, tap_lock_of_reader)),
                    "a tap has one recorder; wait for its end, or open another tap");
  void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) return error_in(name, fmt::format("it can't be mapped: {}", std::strerror(errno)));
  auto ring = of_memory({static_cast<std::byte*>(memory), size}, name);
  if (!ring) {
    ::munmap(memory, size);
    return ring;
  }
  (*ring)->is_mapped_ = true;
  (*ring)->takes_ = use == Use::takes;
  (*ring)->descriptor_ = std::move(descriptor);
  (*ring)->begin_with_oldest();  // it is known now whether there is a loop
  if (use == Use::takes) (*ring)->count_dropped();
  return ring;
}

Result<std::unique_ptr<TapRing>> TapRing::of_memory(std::span<std::byte> memory, const std::string& file) {
  auto* const head = reinterpret_cast<tap_ring_head*>(memory.data());
  if (memory.size() < tap_words_place || TAP_LOAD_ACQUIRE(&head->magic) != TAP_MAGIC)
    return error_in(file, "it is no ring of a tap");
  tap_ring_head copy{};
  std::memcpy(&copy, head, offsetof(tap_ring_head, oldest));
  if (copy.version != TAP_VERSION)
    return error_in(
        file, fmt::format("the ring is of version {}, and this program reads version {}", copy.version, TAP_VERSION),
        "use the library of the tap and the command of one version of Rehearse");
  const bool fits = copy.head_size == sizeof copy && std::has_single_bit(copy.words) && copy.words >= fewest_words &&
                    copy.words <= (memory.size() - tap_words_place) / 8 && copy.hash == hash_of_head(copy) &&
                    ends(copy.controller, sizeof copy.controller) && ends(copy.model, sizeof copy.model);
  const bool has_times = copy.time_step >= 1e-6 && copy.time_step <= 10 && copy.seconds > 0 && copy.seconds <= 1e6;
  if (!fits || !has_times) return error_in(file, "the head of the ring is damaged");
  Facts facts{copy.controller,     copy.model,        copy.time_step,   copy.seconds, copy.pid,
              copy.is_locked == 1, copy.monotonic_ns, copy.realtime_ns, copy.words};
  return std::unique_ptr<TapRing>(new TapRing(std::move(facts), memory, file));
}

TapRing::TapRing(Facts facts, std::span<std::byte> memory, std::string file)
    : facts_(std::move(facts)),
      head_(reinterpret_cast<tap_ring_head*>(memory.data())),
      memory_(memory),
      file_(std::move(file)),
      words_(reinterpret_cast<std::uint64_t*>(memory.data() + tap_words_place)),
      size_(facts_.words),
      record_(tap_most_record_words) {
  begin_with_oldest();
}

TapRing::~TapRing() {
  if (is_mapped_) ::munmap(memory_.data(), memory_.size());
}

Result<TapDefinitions> TapRing::definitions() const {
  const std::uint64_t size = TAP_LOAD_ACQUIRE(&head_->definitions_size);
  if (size > tap_definitions_capacity) return error_in(file_, "the series of the ring are damaged");
  const auto* begin = reinterpret_cast<const char*>(memory_.data() + tap_definitions_place);
  const std::string text(begin, begin + size);  // a copy: the memory may change at any time
  if (hash_of_definitions(std::as_bytes(std::span(text))) != TAP_LOAD(&head_->definitions_hash))
    return error_in(file_, "the series of the ring are damaged");
  auto definitions = TapDefinitions::parse(text);
  if (definitions) return definitions;
  Diagnostic found = definitions.errors()[0];
  found.file = file_;
  return found;
}

bool TapRing::has_ticks() const { return TAP_LOAD_ACQUIRE(&head_->written) != 0; }

TapRing::Got TapRing::take(const TapDefinitions& definitions, TapTick& tick) {
  Got got = take_next(definitions, tick);
  while (got == Got::tick && place_ <= begin_) got = take_next(definitions, tick);
  return got;
}

TapRing::Got TapRing::take_next(const TapDefinitions& definitions, TapTick& tick) {
  std::uint64_t count = 0;
  const tap_taken taken = tap_ring_take(head_, words_, size_, &place_, record_.data(), record_.size(), &count);
  if (taken == tap_nothing) return Got::nothing;
  if (taken == tap_overtaken) return Got::overtaken;
  const std::span<const std::uint64_t> record = std::span(record_).first(count);
  const bool is_whole = taken == tap_record && record[2] == tap_record_hash(record.data(), count) &&
                        record[0] == count && tick.read(record, definitions);
  if (!is_whole) begin_with_next();
  if (takes_ && place_ > TAP_LOAD(&head_->read)) TAP_STORE(&head_->read, place_);
  return is_whole ? Got::tick : Got::damaged;
}

void TapRing::begin_with_oldest() {
  place_ = TAP_LOAD(&head_->oldest);
  begin_ = place_ > 0 && has_loop() ? place_ + size_ / 16 : 0;
}
void TapRing::begin_with_next() { place_ = TAP_LOAD_ACQUIRE(&head_->written); }
void TapRing::take_all() { TAP_STORE(&head_->read, UINT64_MAX); }
void TapRing::count_dropped() {
  if (TAP_LOAD(&head_->read) == UINT64_MAX) TAP_STORE(&head_->read, place_);
}
std::uint64_t TapRing::end() const { return TAP_LOAD_ACQUIRE(&head_->written); }
void TapRing::state_saved() {
  if (takes_ && place_ > TAP_LOAD(&head_->saved)) TAP_STORE(&head_->saved, place_);
}

bool TapRing::has_loop() const { return !is_closed() && owner_of(descriptor_, tap_lock_of_writer) != 0; }
bool TapRing::is_closed() const { return TAP_LOAD_ACQUIRE(&head_->is_closed) != 0; }
void TapRing::remove_file() const {
  struct stat opened {
  }, named{};
  if (::fstat(descriptor_, &opened) != 0 || ::lstat(file_.c_str(), &named) != 0) return;
  if (opened.st_dev == named.st_dev && opened.st_ino == named.st_ino) ::unlink(file_.c_str());
}

std::uint64_t TapRing::dropped() const { return TAP_LOAD(&head_->dropped); }
std::uint64_t TapRing::refused() const { return TAP_LOAD(&head_->refused); }

}  // namespace rehearse
