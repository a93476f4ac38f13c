#include "progress.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <new>

#include "core/guard/interruption.h"
#include "core/guard/supervise.h"

namespace rehearse::tool {
namespace {

constexpr int bar_width = 30;  // [characters]
constexpr std::chrono::seconds patience{1};
constexpr std::chrono::milliseconds interval{100};

}  // namespace

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)) == 1; }

Progress::Progress(std::string what, int parts) : what_(std::move(what)), parts_(parts) {
  if (isatty(STDERR_FILENO) != 1 || is_traced()) return;
  void* shared = mmap(nullptr, sizeof(Shown), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared != MAP_FAILED) shown_ = new (shared) Shown;
}

Progress::~Progress() {
  hide();
  if (shown_) munmap(shown_, sizeof(Shown));
}

void Progress::hide() {
  if (shown_ && std::exchange(shown_->drawn, false)) fmt::print(stderr, "\r\x1b[K");
}

StoppableProgress::StoppableProgress(std::string what) : Progress(std::move(what)) { end_runs_on_signals(); }

void StoppableProgress::show(std::int64_t done, std::int64_t all) {
  if (interruption() != 0) throw Interrupted();
  Progress::show(done, all);
}

void Progress::show(std::int64_t done, std::int64_t all) {
  if (!shown_ || all <= 0) return;
  if (done < shown_->done) ++shown_->part;
  shown_->done = done;
  const Clock::time_point now = Clock::now();
  if (now - begin_ < patience || (shown_->drawn && now - shown_->last < interval)) return;
  shown_->last = now;
  shown_->drawn = true;
  const double of_part = std::clamp(static_cast<double>(done) / static_cast<double>(all), 0.0, 1.0);
  const double share = std::min((shown_->part + of_part) / parts_, 1.0);
  const double elapsed = std::chrono::duration<double>(now - begin_).count();
  const double left = share > 0.0 ? elapsed / share - elapsed : 0.0;
  const int filled = static_cast<int>(share * bar_width);
  fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {:3.0f} %, {:.0f} s left\x1b[K", what_, "", filled, "", bar_width - filled,
             share * 100.0, left);
  std::fflush(stderr);
}

}  // namespace rehearse::tool
