// rehearse golden list: lists all goldens with their owners and ages.
#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <rehearse/renderer.h>
#include <rehearse/world.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>

#include "base/names.h"
#include "core/trace/run_facts.h"
#include "golden_verbs.h"
#include "options.h"

namespace rehearse::tool {
namespace {

/// The provenance of a recording made by this program; without the renderer's entry if no renderer can be created.
mcap::StringMap present_versions() {
  mcap::StringMap present{{facts::rehearse, REHEARSE_VERSION},
                          {facts::physics, World::engine_description()},
                          {facts::libc, std::string("glibc ") + gnu_get_libc_version()}};
  if (const auto renderer = Renderer::create()) present[facts::renderer] = (*renderer)->description();
  return present;
}

std::string state_of(const GoldenEntry& entry) {
  if (!entry.problem.empty()) return entry.problem;
  std::string state = entry.orphan() ? "no test or scenario names it" : "";
  if (entry.pending) state += std::string(state.empty() ? "" : "; ") + "a run waits to be accepted";
  return state.empty() ? "in use" : state;
}

Json json_of_entry(const GoldenEntry& entry) {
  return {{"name", entry.name},
          {"owners", entry.owners},
          {"bytes", entry.bytes},
          {"recorded_by", entry.recorded_by},
          {"accepted", entry.accepted.empty() ? Json(nullptr) : Json(entry.accepted)},
          {"acceptances", entry.acceptances},
          {"pending", entry.pending},
          {"orphan", entry.orphan()},
          {"problem", entry.problem.empty() ? Json(nullptr) : Json(entry.problem)},
          {"notes", entry.notes}};
}

/// Collects remarks about many goldens and prints each sentence once.
void tell_once(const std::vector<GoldenEntry>& entries,
               const std::function<std::vector<std::string>(const GoldenEntry&)>& sentences_of) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<std::string>> names;  // by sentence
  for (const GoldenEntry& entry : entries)
    for (const std::string& sentence : sentences_of(entry)) {
      std::vector<std::string>& of_sentence = names[sentence];
      if (of_sentence.empty()) order.push_back(sentence);
      of_sentence.push_back(entry.name);
    }
  constexpr std::size_t named = 3;
  for (const std::string& sentence : order) {
    const std::vector<std::string>& of = names[sentence];
    fmt::print("{}: {}\n", of.size() == entries.size() ? "all" : listed(of, named), sentence);
  }
}

void tell(const std::vector<GoldenEntry>& entries) {
  std::vector<TableRow> rows{{"golden", "size", "accepted", "state", "named by"}};
  for (const GoldenEntry& entry : entries) {
    std::string owners;
    for (const std::string& owner : entry.owners) owners += (owners.empty() ? "" : ", ") + owner;
    rows.push_back({entry.name, file_size_text(entry.bytes), entry.accepted.empty() ? "-" : entry.accepted,
                    state_of(entry), owners.empty() ? "-" : owners});
  }
  print_table(rows);
  tell_once(entries, [](const GoldenEntry& entry) {
    return entry.recorded_by.empty() ? std::vector<std::string>() : std::vector{"recorded with " + entry.recorded_by};
  });
  tell_once(entries, [](const GoldenEntry& entry) { return entry.notes; });
}

/// True if its recording or its digest can't be used. Two owners of one golden are another problem.
bool is_broken(const GoldenStore& store, const GoldenEntry& entry) {
  return !entry.problem.empty() && !store.check_digest(entry.name);
}

Exit list(bool json) {
  const auto store = open_store();
  if (!store) return refuse(store.errors());
  const auto entries = list_goldens(*store, {store->folder() / ".."}, present_versions());
  if (!entries) return refuse(entries.errors());
  if (json) {
    Json goldens = Json::array();
    for (const GoldenEntry& entry : *entries) goldens.push_back(json_of_entry(entry));
    print({{"folder", store->folder().string()}, {"goldens", goldens}});
  } else if (entries->empty()) {
    fmt::print("no goldens in {}\n", store->folder().string());
  } else {
    tell(*entries);
  }
  const bool is_any_broken =
      std::ranges::any_of(*entries, [&](const GoldenEntry& entry) { return is_broken(*store, entry); });
  return is_any_broken ? Exit::differs : Exit::done;
}

}  // namespace

std::function<Exit()> declare_golden_list(CLI::App& options) {
  const auto json = std::make_shared<bool>(false);
  add_json_flag(options, *json);
  return [json] { return list(*json); };
}

}  // namespace rehearse::tool
