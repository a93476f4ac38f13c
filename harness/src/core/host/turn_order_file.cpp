#include "turn_order_file.h"

#include <fmt/format.h>

#include <fstream>
#include <utility>

#include "core/guard/source_line.h"
#include "core/turns/scheduler.h"

namespace rehearse {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* title = "an order of threads of Rehearse";
constexpr int version = 1;

std::string named(const std::string& thread, const CodePlaces& places) {
  const auto line = source_line_of(places);
  return line ? fmt::format("{} ({}:{})", thread, line->file.filename().string(), line->line) : thread;
}

}  // namespace

Json json_of_order(const std::vector<NamedExchange>& exchanges) {
  Json list = Json::array();
  for (const NamedExchange& one : exchanges) {
    Json& json = list.emplace_back(
        Json{{"call", one.exchange.place.call}, {"place", one.exchange.place.number}, {"behind", one.exchange.behind}});
    if (one.runs.empty()) continue;
    json["runs"] = one.runs;
    json["before"] = one.before;
  }
  return {{"file", title}, {"version", version}, {"exchanges", list}};
}

Json json_of_drawn_order(std::uint64_t seed, const std::vector<std::int64_t>& changes) {
  return {{"file", title}, {"version", version}, {"seed", seed}, {"changes", changes}};
}

std::vector<NamedExchange> exchanges_of_json(const Json& json) {
  std::vector<NamedExchange> exchanges;
  for (const Json& one : json.at("exchanges"))
    exchanges.push_back(
        {{{one.at("call"), one.at("place")}, one.at("behind")}, one.value("runs", ""), one.value("before", "")});
  return exchanges;
}

static Result<TurnOrder> read_turn_order(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return error(fmt::format("can't read {}", file.string()));
  try {
    const Json json = Json::parse(stream);
    if (json.at("file") == title && json.at("version") == version) {
      if (json.contains("seed")) return TurnOrder(json.at("seed"), json.at("changes"));
      std::vector<Exchange> exchanges;
      for (const NamedExchange& one : exchanges_of_json(json)) exchanges.push_back(one.exchange);
      return TurnOrder(exchanges);
    }
  } catch (const Json::exception&) {
    // as if it were another file
  }
  return error(fmt::format("{} isn't the file of an order of threads", file.string()),
               "rehearse audit RECORDING --orders 200 writes one where an order matters");
}

Result<void> take_turn_order(const std::filesystem::path& file) {
  TurnScheduler::instance().try_order(REHEARSE_TRY(read_turn_order(file)));
  return {};
}

void find_lines_of_exchanges() {
  std::vector<TurnScheduler::MadeExchange>& all = TurnScheduler::instance().made();
  for (auto made = all.rbegin(); made != all.rend() && !std::exchange(made->has_lines, true); ++made) {
    made->runs = named(made->runs, made->runs_at);
    made->before = named(made->before, made->before_at);
  }
}

std::vector<NamedExchange> made_exchanges() {
  std::vector<NamedExchange> all;
  for (const TurnScheduler::MadeExchange& made : TurnScheduler::instance().made())
    all.push_back({made.exchange, made.runs, made.before});
  return all;
}

}  // namespace rehearse
