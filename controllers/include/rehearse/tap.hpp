// rehearse::Tap: a tap (<rehearse/tap.h>) that closes itself. C++17.
#ifndef REHEARSE_TAP_HPP
#define REHEARSE_TAP_HPP

#include <rehearse/tap.h>

#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace rehearse {

/// A Tap without a ring does nothing: a robot without a recorder goes on.
class Tap {
 public:
  Tap() = default;
  /// is_open() is false if it failed; error() states why.
  explicit Tap(const char* name, const rehearse_tap_options& options = {}) : tap_(rehearse_tap_open(name, &options)) {}
  ~Tap() { rehearse_tap_close(tap_); }
  Tap(Tap&& other) noexcept : tap_(std::exchange(other.tap_, nullptr)) {}
  Tap& operator=(Tap&& other) noexcept {
    std::swap(tap_, other.tap_);
    return *this;
  }

  bool is_open() const { return tap_ != nullptr; }
  static const char* error() { return rehearse_tap_error(); }
  rehearse_tap* get() const { return tap_; }

  /// The numbers of a tick are all q, then all dq, then all u, in the order of `names`.
  int joints(const char* body, const std::vector<std::string>& names, int quantities) {
    return rehearse_tap_joints(tap_, body, pointers(names).data(), names.size(), quantities);
  }
  int commands(const char* body, const std::vector<std::string>& names, int quantities) {
    return rehearse_tap_commands(tap_, body, pointers(names).data(), names.size(), quantities);
  }
  int imu(const char* body, const char* device) { return rehearse_tap_imu(tap_, body, device); }
  int device(const char* body, const char* name, std::size_t count) {
    return rehearse_tap_device(tap_, body, name, count);
  }
  bool parameter(const char* key, const std::string& value) {
    return rehearse_tap_parameter(tap_, key, value.c_str()) == 0;
  }

  /// One tick: it ends at the end of its scope.
  class Tick {
   public:
    Tick(Tap& tap, std::int64_t now_ns) : tap_(tap.tap_) { rehearse_tap_begin(tap_, now_ns); }
    ~Tick() { rehearse_tap_end(tap_); }
    Tick(const Tick&) = delete;
    Tick& operator=(const Tick&) = delete;

    /// `numbers`: an array, a vector or a span of doubles.
    template <class Numbers>
    bool write(int series, const Numbers& numbers) {
      static_assert(std::is_same_v<std::decay_t<decltype(*std::data(numbers))>, double>, "the numbers are doubles");
      return rehearse_tap_write(tap_, series, std::data(numbers), std::size(numbers)) == 0;
    }
    bool absent(int series) { return rehearse_tap_absent(tap_, series) == 0; }
    bool variable(const char* name, double value) { return rehearse_tap_variable(tap_, name, value) == 0; }
    bool text(const char* text) { return rehearse_tap_text(tap_, text) == 0; }
    bool image(const char* camera, const char* picture) { return rehearse_tap_image(tap_, camera, picture) == 0; }

   private:
    rehearse_tap* tap_;
  };
  Tick tick(std::int64_t now_ns) { return Tick(*this, now_ns); }

  void mark(const char* reason) { rehearse_tap_mark(tap_, reason); }
  std::uint64_t dropped() const { return rehearse_tap_dropped(tap_); }

 private:
  static std::vector<const char*> pointers(const std::vector<std::string>& names) {
    std::vector<const char*> all;
    for (const std::string& name : names) all.push_back(name.c_str());
    return all;
  }

  rehearse_tap* tap_ = nullptr;
};

}  // namespace rehearse

#endif
