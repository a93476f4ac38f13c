#include "call_log.h"

#include <cstring>
#include <fstream>
#include <memory>

#include "audit/interposer/log_format.h"
#include "symbols.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using interposer::Log;
using interposer::LogEntry;

constexpr std::string_view source_names[] = {"clock",       "random", "thread",  "file", "network",
                                             "environment", "locale", "process", "cost"};

/// A text of the heap; none if the offset is outside of it.
std::optional<std::string> text_at(const Log& log, interposer::TextOffset offset) {
  if (offset >= log.heap_used) return offset == 0 ? std::optional<std::string>("") : std::nullopt;
  const char* text = log.heap + offset;
  const std::size_t length = strnlen(text, log.heap_used - offset);
  if (length == log.heap_used - offset) return std::nullopt;
  return std::string(text, length);
}

/// Reads texts of the heap, and records whether all of them are valid.
class Texts {
 public:
  explicit Texts(const Log& log) : log_(log) {}
  std::string at(interposer::TextOffset offset) {
    auto text = text_at(log_, offset);
    all_found_ = all_found_ && text;
    return text.value_or("");
  }
  CodePlace at(const interposer::LoggedPlace& place) { return {at(place.module), place.offset}; }
  bool all_found() const { return all_found_; }

 private:
  const Log& log_;
  bool all_found_ = true;
};

/// The name in the source code: a compiler or the C library's headers change open to __open64_2, and fopen to fopen64.
std::string plain_name(std::string_view name) {
  if (name.starts_with("__")) {
    name.remove_prefix(2);
    if (name.ends_with("_2")) name.remove_suffix(2);
  }
  if (name.ends_with("64")) name.remove_suffix(2);
  return std::string(name);
}

std::optional<ObservedCall> call_of(const Log& log, const LogEntry& entry) {
  if (entry.source >= std::size(source_names) || entry.chain_length > interposer::max_chain ||
      entry.outer_length > interposer::max_outer)
    return std::nullopt;
  Texts texts(log);
  ObservedCall call;
  call.source = static_cast<ObservedCall::Source>(entry.source);
  call.function = plain_name(texts.at(entry.function));
  call.argument = texts.at(entry.argument);
  call.controller = texts.at(entry.controller);
  call.phase = texts.at(entry.phase);
  call.digest = texts.at(entry.digest);
  call.first_tick = entry.first_tick;
  call.last_tick = entry.last_tick;
  call.count = entry.count;
  call.place = texts.at(entry.place);
  for (std::uint32_t i = 0; i < entry.chain_length; ++i) call.chain.push_back(texts.at(entry.chain[i]));
  call.outer.assign(entry.outer, entry.outer + entry.outer_length);
  if (!texts.all_found()) return std::nullopt;
  return call;
}

}  // namespace

Result<CallLog> read_call_log(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return error("can't read the call log " + file.string());
  const auto log = std::make_unique<Log>();
  stream.read(reinterpret_cast<char*>(log.get()), sizeof(Log));
  const bool is_log = stream.gcount() == sizeof(Log) &&
                      std::equal(std::begin(log->magic), std::end(log->magic), std::begin(interposer::log_magic));
  const std::string broken = file.string() + " is no call log, or a damaged one";
  if (!is_log || log->entries > interposer::max_entries || log->heap_used > interposer::heap_size) return error(broken);
  CallLog result;
  result.complete = log->overflowed == 0;
  result.hidden_calls = log->hidden != 0;
  for (std::uint32_t i = 0; i < log->entries; ++i) {
    auto call = call_of(*log, log->entry[i]);
    if (!call) return error(broken);
    result.calls.push_back(std::move(*call));
  }
  return result;
}

std::string_view to_string(ObservedCall::Source source) { return source_names[static_cast<int>(source)]; }

std::string text_of(const ObservedCall& call) { return call.function + "(" + call.argument + ")"; }

std::string place_of(const ObservedCall& call) {
  const Symbols symbols(call.place.module);
  if (!symbols.find(call.place.offset).is_systems) return symbols.describe(call.place.offset);
  for (const std::uint64_t address : call.outer)
    if (!symbols.find(address).is_systems) return symbols.describe(address);
  return symbols.describe(call.place.offset);
}

}  // namespace rehearse
