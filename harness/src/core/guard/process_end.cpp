#include "process_end.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <stdlib.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "c_library.h"
#include "core/turns/scheduler.h"
#include "guarded_call.h"
#include "interruption.h"
#include "supervisor.h"

extern "C" __attribute__((weak)) void __lsan_do_leak_check();

namespace rehearse {
namespace {

/// A library in memory.
struct Library {
  std::uintptr_t base = 0;
  std::string file;
  const ElfW(Dyn) * dynamic = nullptr;
};

std::vector<Library> libraries_in_memory() {
  std::vector<Library> all;
  dl_iterate_phdr(
      [](dl_phdr_info* object, std::size_t, void* found) {
        Library library{object->dlpi_addr, object->dlpi_name ? object->dlpi_name : "", nullptr};
        for (int i = 0; i < object->dlpi_phnum; ++i)
          if (object->dlpi_phdr[i].p_type == PT_DYNAMIC)
            library.dynamic =
                reinterpret_cast<const ElfW(Dyn)*>(object->dlpi_addr + object->dlpi_phdr[i].p_vaddr);  // NOLINT
        static_cast<std::vector<Library>*>(found)->push_back(std::move(library));
        return 0;
      },
      &all);
  return all;
}

/// The facts about controllers for the end. None is on the heap: runs of one process that are compared with each other
/// must find equal heaps.
struct Guests {
  std::array<std::uintptr_t, 1024> own_libraries{};  // of the program: their addresses; 0: unused
  char controllers[512] = "";                        // "A/B' or 'A/C"
  double limit = 0.0;                                // [s]
  bool in_fork = false, are_loaded = false;

  bool is_own(std::uintptr_t base) const { return std::ranges::find(own_libraries, base) != own_libraries.end(); }
  std::vector<Library> left() const {
    std::vector<Library> all = libraries_in_memory();
    std::erase_if(all, [&](const Library& library) { return is_own(library.base); });
    return all;
  }
};

constinit Guests known_guests;
Guests& guests() { return known_guests; }

pid_t ending = 0;  // this process is in the guarded part of exit(); else 0
int end_status = 0;
std::string* subject = nullptr;   // "warning: controller 'Pendulum/Swing'"
std::string* too_long = nullptr;  // "did not return within 10 s"

/// Called in exit(), before the handlers and destructors that were registered earlier.
extern "C" void guard_rest(int status, void*) {
  const Guests& known = guests();
  const bool had_controllers = *known.controllers != '\0';  // a fork that only moves a world has none
  if (ending == getpid() || !had_controllers || (known.left().empty() && !known.in_fork)) return;
  end_status = status;
  const std::string names = known.controllers;
  const double limit = interruption() == 0 ? known.limit : std::min(known.limit, limit_after_signal);
  subject = new std::string(fmt::format("warning: controller '{}' ", names));
  too_long = new std::string(fmt::format("did not return within {} s", limit));
  if (!known.in_fork) announce_end(status);
  note_call_begin(names.c_str(), destroying, 0, 0.0, limit);
  guard_rest_of_process(limit);
  TurnScheduler::instance().begin_end_of_process();
  ending = getpid();
  std::fflush(nullptr);  // code that was interrupted may hold the lock of a stream
}

/// Runs the destructors of a library as exit() does.
void finish(const Library& library) {
  using Function = void (*)();
  std::uintptr_t functions = 0, last = 0;
  std::size_t bytes = 0;
  for (const ElfW(Dyn)* entry = library.dynamic; entry && entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_FINI_ARRAY) functions = entry->d_un.d_ptr;
    if (entry->d_tag == DT_FINI_ARRAYSZ) bytes = entry->d_un.d_val;
    if (entry->d_tag == DT_FINI) last = entry->d_un.d_ptr;
  }
  const auto* const array = reinterpret_cast<const Function*>(library.base + functions);  // NOLINT
  for (std::size_t i = bytes / sizeof(Function); functions != 0 && i > 0; --i) array[i - 1]();
  if (last != 0) reinterpret_cast<Function>(library.base + last)();  // NOLINT
}

/// The first handler of a fork, and so the last that exit() calls: the others belong to the process that forked it.
extern "C" void end_here(int status, void*) {
  guard_rest(status, nullptr);
  std::vector<Library> left = guests().left();
  std::for_each(left.rbegin(), left.rend(), finish);  // those that were loaded last come first
  std::fflush(nullptr);
  if (checks_leaks()) __lsan_do_leak_check();
  leave_process(status);
}

/// Notes the libraries in memory as those of the program.
void note_libraries() {
  guests().own_libraries.fill(0);
  std::uintptr_t* place = guests().own_libraries.data();
  dl_iterate_phdr(
      [](dl_phdr_info* object, std::size_t, void* next) {
        auto& to = *static_cast<std::uintptr_t**>(next);
        if (to != guests().own_libraries.data() + guests().own_libraries.size()) *to++ = object->dlpi_addr;
        return 0;
      },
      &place);
}

}  // namespace

void note_own_libraries() {
  if (!std::exchange(guests().are_loaded, true)) note_libraries();
}

bool has_loaded_guests() { return guests().are_loaded; }

bool is_code_of_guest(const void* place) {
  dl_find_object object;
  if (!has_loaded_guests() || _dl_find_object(const_cast<void*>(place), &object) != 0) return false;
  return !guests().is_own(object.dlfo_link_map->l_addr);
}

void guard_process_end(const std::string& controller, double limit) {
  char(&known)[sizeof(Guests::controllers)] = guests().controllers;
  if (std::string_view(known).find(controller) == std::string_view::npos &&
      std::strlen(known) + controller.size() + 6 < sizeof known) {
    if (*known) std::strcat(known, "' or '");
    std::strcat(known, controller.c_str());
  }
  guests().limit = std::max(guests().limit, limit);
  on_exit(guard_rest, nullptr);
}

void note_forked_run() {
  note_libraries();  // also guests of the process that forked: their threads don't exist here
  guests().are_loaded = guests().in_fork = true;
  on_exit(end_here, nullptr);
}

void end_forked_run() { std::exit(EXIT_SUCCESS); }

bool checks_leaks() { return __lsan_do_leak_check != nullptr; }

bool is_process_ending() { return ending != 0; }

void end_if_ending(const char* deed) {
  if (ending == 0) return;
  if (ending == getpid()) {  // not in a child that a controller forked
    constexpr char rest[] = " while its static objects were destroyed\n";
    const char* const what = deed ? deed : too_long->c_str();
    const iovec parts[] = {{subject->data(), subject->size()},
                           {const_cast<char*>(what), std::strlen(what)},
                           {const_cast<char*>(rest), sizeof rest - 1}};
    static_cast<void>(!writev(STDERR_FILENO, parts, std::size(parts)));
  }
  leave_process(end_status);
}

}  // namespace rehearse
