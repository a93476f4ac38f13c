#include "watching.h"

#include <dlfcn.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <unwind.h>

#include "random_stream.h"

#include "call_table.h"
#include "descriptors.h"
#include "system_calls.h"

namespace rehearse::interposer {

__thread ThreadState thread_state;

namespace {

constexpr int most_frames = 200;
constexpr int most_known = 512;

Settings settings;
CurrentCall current;
char current_controller[256];
char current_library[4096];
char current_phase[64];
// The libraries before the first controller: the host's and the system's.
const link_map* known[most_known];
int known_count = 0;
const link_map* own_map = nullptr;  // the interposer

const link_map* map_of(const void* address) {
  dl_find_object object{};
  return _dl_find_object(const_cast<void*>(address), &object) == 0 ? object.dlfo_link_map : nullptr;
}

void remember_loaded_libraries() {
  own_map = map_of(reinterpret_cast<const void*>(&remember_loaded_libraries));
  const link_map* map = own_map;
  while (map && map->l_prev) map = map->l_prev;
  for (; map && known_count < most_known; map = map->l_next) known[known_count++] = map;
}

bool is_known(const link_map* map) {
  for (int i = 0; i < known_count; ++i)
    if (known[i] == map) return true;
  return false;
}

bool is_controllers_own(const link_map* map) { return strcmp(map->l_name, current_library) == 0; }

uint64_t offset_in(const link_map* map, const char* address) {
  return reinterpret_cast<uint64_t>(address) - map->l_addr;
}

void set_place(Caller& caller, const link_map* map, const char* address) {
  caller.is_controller = true;
  caller.module = map->l_name;
  caller.offset = offset_in(map, address);
}

/// A walk up the stack. The place is the innermost frame in the controller's library; without one, the innermost frame
/// in a library that was loaded with it.
struct Walk {
  Caller caller;
  int frames = 0;
  uint32_t chain_to_brought = 0;  // length of the chain at the first library that was loaded with the controller
};

_Unwind_Reason_Code visit(_Unwind_Context* context, void* argument) {
  Walk& walk = *static_cast<Walk*>(argument);
  if (++walk.frames > most_frames) return _URC_END_OF_STACK;
  const char* address = reinterpret_cast<const char*>(_Unwind_GetIP(context)) - 1;  // in the call, not after it
  const link_map* map = map_of(address);
  if (!map || map == own_map) return _URC_NO_REASON;
  if (is_controllers_own(map)) {
    set_place(walk.caller, map, address);
    walk.chain_to_brought = walk.caller.chain_length;
    return _URC_END_OF_STACK;
  }
  if (!walk.caller.is_controller && !is_known(map)) {
    set_place(walk.caller, map, address);
    walk.chain_to_brought = walk.caller.chain_length;
  }
  if (walk.caller.chain_length < max_chain)
    walk.caller.chain[walk.caller.chain_length++] = {map->l_name, offset_in(map, address)};
  return _URC_NO_REASON;
}

/// The frames of the same library around a place. A function of the C++ library's headers is compiled into the library,
/// and its caller is more informative.
struct OuterWalk {
  LogEntry* entry;
  const char* module;
  int frames = 0;
  bool past_place = false;
};

_Unwind_Reason_Code visit_outer(_Unwind_Context* context, void* argument) {
  OuterWalk& walk = *static_cast<OuterWalk*>(argument);
  LogEntry& entry = *walk.entry;
  if (++walk.frames > most_frames || entry.outer_length == max_outer) return _URC_END_OF_STACK;
  const char* address = reinterpret_cast<const char*>(_Unwind_GetIP(context)) - 1;
  const link_map* map = map_of(address);
  if (!map || strcmp(map->l_name, walk.module) != 0) return _URC_NO_REASON;
  const uint64_t offset = offset_in(map, address);
  if (walk.past_place) entry.outer[entry.outer_length++] = offset;
  walk.past_place = walk.past_place || offset == entry.place.offset;
  return _URC_NO_REASON;
}

/// Programs that a controller starts must not be watched, and a controller must not see that it is watched.
void leave_environment() {
  unsetenv("REHEARSE_INTERPOSER");
  const char* preloaded = getenv("LD_PRELOAD");
  if (!preloaded) return;
  const char* others = strpbrk(preloaded, ": ");
  if (others) {
    char* rest = strdup(others + 1);
    setenv("LD_PRELOAD", rest, 1);
    free(rest);
  } else {
    unsetenv("LD_PRELOAD");
  }
}

/// Records the host's libraries and descriptors, once, before the first controller.
void look_around() {
  static bool done = false;
  if (done) return;
  done = true;
  const Busy busy;
  remember_loaded_libraries();
  remember_open_descriptors();
}

bool is_known_at(uint64_t base) {
  for (int i = 0; i < known_count; ++i)
    if (known[i]->l_addr == base) return true;
  return false;
}

int watch_code_of(dl_phdr_info* info, size_t, void*) {
  static uint64_t watched[most_known];
  static int watched_count = 0;
  if (is_known_at(info->dlpi_addr)) return 0;
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = info->dlpi_phdr[i];
    const uint64_t begin = info->dlpi_addr + segment.p_vaddr;
    bool done = segment.p_type != PT_LOAD || !(segment.p_flags & PF_X) || watched_count == most_known;
    for (int k = 0; k < watched_count; ++k) done = done || watched[k] == begin;
    if (done) continue;
    watched[watched_count++] = begin;
    if (!watch_system_calls(begin, begin + segment.p_memsz)) say_that_calls_are_hidden();
  }
  return 0;
}

void copy(char* to, size_t size, const char* text) {
  if (strcmp(to, text) != 0) snprintf(to, size, "%s", text);
}

}  // namespace

CurrentCall current_call() { return current; }

bool takes_turns() {
  static const auto ask = reinterpret_cast<bool (*)()>(dlsym(RTLD_DEFAULT, "rehearse_takes_turns"));
  return ask && ask();
}

bool will_take_turns(const void* function) {
  static const auto ask = reinterpret_cast<bool (*)(const void*)>(dlsym(RTLD_DEFAULT, "rehearse_will_take_turns"));
  return ask && ask(function);
}

const Substitution& substitution_for(const Caller& caller) {
  static constexpr Substitution nothing;
  if (!caller.is_controller) return nothing;
  return caller.is_only ? settings.there : settings.everywhere;
}

const Substitution& substitution_of_layer(int layer) { return layer == 0 ? settings.everywhere : settings.there; }

Caller find_caller(void* return_address) {
  const Busy busy;
  const char* address = static_cast<const char*>(return_address) - 1;
  const link_map* map = map_of(address);
  Walk walk;
  if (map && is_controllers_own(map)) {
    set_place(walk.caller, map, address);
  } else {
    _Unwind_Backtrace(visit, &walk);
    walk.caller.chain_length = walk.chain_to_brought;
    if (!walk.caller.is_controller && thread_state.own_thread && map) set_place(walk.caller, map, address);
  }
  Caller& caller = walk.caller;
  caller.is_only = settings.has_only && caller.is_controller && caller.offset == settings.only_offset &&
                   strcmp(caller.module, settings.only_module) == 0;
  return caller;
}

void note(const Caller& caller, Source source, const char* function, const char* argument, const char* digest) {
  if (!caller.is_controller) return;
  const Busy busy;
  LogEntry* const added = log_call(source, function, argument ? argument : "", digest ? digest : "", current_controller,
                                   thread_state.own_thread ? "its own thread" : current_phase, current.tick, caller);
  if (!added) return;
  OuterWalk walk{added, caller.module};
  _Unwind_Backtrace(visit_outer, &walk);
}

Caller note(Source source, const char* function, const char* argument, void* return_address, const char* digest) {
  const Caller caller = find_caller(return_address);
  note(caller, source, function, argument, digest);
  return caller;
}

const char* folder_of_copies() { return settings.files; }

Digits::Digits(long long number) { snprintf(text, sizeof text, "%lld", number); }

extern "C" __attribute__((visibility("default"))) void rehearse_interposer_begin() {
  static bool begun = false;
  if (begun) return;
  begun = true;
  const Busy busy;
  if (const char* text = getenv("REHEARSE_INTERPOSER")) read_settings(text, settings);
  leave_environment();
  if (*settings.log) open_log(settings.log);
  prepare_for_system_calls();
}

extern "C" __attribute__((visibility("default"))) void rehearse_interposer_enter(const char* controller,
                                                                                 const char* library,
                                                                                 const char* function, long long tick,
                                                                                 double time) {
  look_around();
  copy(current_controller, sizeof current_controller, controller);
  copy(current_library, sizeof current_library, library);
  copy(current_phase, sizeof current_phase, function);
  if (strcmp(function, "load") == 0) {  // a run begins: all runs get the same state
    restart_streams();
    for (ClockLead& lead : thread_state.lead) lead = {};
  }
  ++current.number;
  current.tick = tick;
  current.time = time;
  if (settings.everywhere.slow > 0 && strcmp(function, "control") == 0) {
    const timespec nap{0, settings.everywhere.slow * 1000L};
    nanosleep(&nap, nullptr);
  }
  thread_state.busy = false;  // an earlier call may have been interrupted at any instruction
  thread_state.in_call = true;
}

extern "C" __attribute__((visibility("default"))) void rehearse_interposer_note_cost(const char* cost,
                                                                                     const char* function) {
  if (watching()) note(Source::cost, function, cost, __builtin_return_address(0));
}

extern "C" __attribute__((visibility("default"))) void rehearse_interposer_leave() {
  thread_state.in_call = false;
  if (strcmp(current_phase, "control") == 0) return;  // libraries are mostly loaded before control()
  const Busy busy;
  dl_iterate_phdr(watch_code_of, nullptr);
}

}  // namespace rehearse::interposer
