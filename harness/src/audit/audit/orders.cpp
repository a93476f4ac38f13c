#include "orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include "base/chance.h"
#include "base/names.h"
#include "experiments.h"
#include "judgement.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

using Exchanges = std::vector<NamedExchange>;

constexpr int at_once = 8;              // orders between two looks at the results
constexpr int most_changes = 2;         // of priorities
constexpr std::size_t most_runs = 400;  // to reduce an order

Result<void> write_order(const fs::path& file, const nlohmann::ordered_json& json) {
  std::ofstream stream(file);
  stream << json.dump(1) << "\n";
  stream.close();
  if (!stream) return error(fmt::format("can't write {}", file.string()));
  return {};
}

class Orders {
 public:
  Orders(ReplayProcesses& processes, const AuditOptions& options, AuditReport& report)
      : processes_(processes), options_(options), report_(report) {}

  Result<void> run(const std::function<void(const ReplayPass&)>& take_first);

 private:
  /// Replays in these orders. The names of their processes begin with their number.
  Result<std::vector<ReplayPass>> replay(const std::vector<nlohmann::ordered_json>& orders);
  Result<std::vector<ReplayPass>> replay_exchanges(const std::vector<Exchanges>& all);
  nlohmann::ordered_json drawn(int number);
  std::optional<Divergence> difference_of(const ReplayPass& pass) const {
    return difference(usual_, pass, report_.time_step, "");
  }
  Result<std::optional<std::pair<int, ReplayPass>>> find();
  Result<Exchanges> reduced(Exchanges exchanges);
  void conclude(const ReplayPass& pass);
  void conclude_same();
  std::string names() const;
  TriedOrders& tried() { return *report_.orders; }

  ReplayProcesses& processes_;
  const AuditOptions& options_;
  AuditReport& report_;
  ReplayPass usual_;
  int runs_ = 0;
};

Result<std::vector<ReplayPass>> Orders::replay(const std::vector<nlohmann::ordered_json>& orders) {
  std::vector<ReplaySettings> all;
  for (const auto& order : orders) {
    ReplaySettings& settings = all.emplace_back(plain_replay(options_));
    settings.name = fmt::format("order_{}", ++runs_);
    settings.order = options_.scratch / (settings.name + ".json");
    REHEARSE_TRY(write_order(settings.order, order));
  }
  auto outcomes = REHEARSE_TRY(processes_.run(all));
  report_.replays += static_cast<int>(outcomes.size());
  std::vector<ReplayPass> passes;
  for (ReplayOutcome& outcome : outcomes) passes.push_back(std::move(outcome.passes[0]));
  return passes;
}

Result<std::vector<ReplayPass>> Orders::replay_exchanges(const std::vector<Exchanges>& all) {
  std::vector<nlohmann::ordered_json> orders;
  for (const Exchanges& exchanges : all) orders.push_back(json_of_order(exchanges));
  return replay(orders);
}

/// One after the other has no change of priorities, one, and two.
nlohmann::ordered_json Orders::drawn(int number) {
  const Chance chance(options_.seed, number);
  std::vector<std::int64_t> changes;
  for (int i = 0; i < number % (most_changes + 1); ++i)
    changes.push_back(static_cast<std::int64_t>(chance.uniform(i) * static_cast<double>(tried().places)));
  const auto seed = static_cast<std::uint64_t>(chance.uniform(most_changes) * 0x1p53);
  return json_of_drawn_order(seed, changes);
}

/// The first order with a difference, and its replay.
Result<std::optional<std::pair<int, ReplayPass>>> Orders::find() {
  while (tried().tried < options_.orders) {
    std::vector<nlohmann::ordered_json> orders;
    for (int i = tried().tried; i < std::min(options_.orders, tried().tried + at_once); ++i) orders.push_back(drawn(i));
    auto passes = REHEARSE_TRY(replay(orders));
    for (ReplayPass& pass : passes) {
      ++tried().tried;
      if (difference_of(pass)) return std::optional(std::pair(tried().tried - 1, std::move(pass)));
    }
  }
  return std::optional<std::pair<int, ReplayPass>>();
}

/// Leaves out what isn't needed for a difference: first all exchanges after some place, then parts of the others (A.
/// Zeller, R. Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE Transactions on Software Engineering
/// 28, 2002).
Result<Exchanges> Orders::reduced(Exchanges exchanges) {
  const int begin = runs_;
  std::size_t least = 0;
  while (least + 1 < exchanges.size()) {  // the first `least` exchanges aren't enough
    const std::size_t middle = (least + exchanges.size()) / 2;
    const Exchanges part(exchanges.begin(), exchanges.begin() + static_cast<std::ptrdiff_t>(middle));
    const auto passes = REHEARSE_TRY(replay_exchanges({part}));
    if (difference_of(passes[0]))
      exchanges = part;
    else
      least = middle;
  }
  for (std::size_t parts = 2; exchanges.size() > 1 && static_cast<std::size_t>(runs_ - begin) < most_runs;) {
    parts = std::min(parts, exchanges.size());
    std::vector<Exchanges> fewer;
    for (std::size_t i = 0; i < parts; ++i) {
      const std::size_t from = i * exchanges.size() / parts, to = (i + 1) * exchanges.size() / parts;
      Exchanges& rest = fewer.emplace_back(exchanges);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(from), rest.begin() + static_cast<std::ptrdiff_t>(to));
    }
    const auto passes = REHEARSE_TRY(replay_exchanges(fewer));
    const auto differs =
        std::ranges::find_if(passes, [&](const ReplayPass& pass) { return difference_of(pass).has_value(); });
    if (differs != passes.end()) {
      exchanges = fewer[static_cast<std::size_t>(differs - passes.begin())];
      parts = std::max<std::size_t>(2, parts - 1);
    } else if (parts == exchanges.size()) {
      break;
    } else {
      parts *= 2;
    }
  }
  return exchanges;
}

std::string Orders::names() const {
  std::vector<std::string> all;
  for (const ControllerAudit& controller : report_.controllers) all.push_back(controller.controller);
  return listed(all, all.size());
}

void Orders::conclude(const ReplayPass& pass) {
  tried().first = difference_of(pass);
  std::string exchanges;
  for (const NamedExchange& made : pass.order ? pass.order->made : Exchanges()) {
    tried().exchanges.push_back({made.runs, made.before});
    exchanges += fmt::format("{}{} runs before {}", exchanges.empty() ? "" : ", and ", made.runs, made.before);
  }
  report_.deterministic = false;
  report_.verdict = fmt::format(
      "{} {} on the order of threads: {} if {}", names(), report_.controllers.size() == 1 ? "depends" : "depend",
      pass.failure && !usual_.failure ? *pass.failure
                                      : fmt::format("{} of {} differs from tick {} on", tried().first->element,
                                                    tried().first->channel, tried().first->tick),
      exchanges.empty() ? fmt::format("they run in the order of {}", tried().file.string()) : exchanges);
}

/// "over 99.9 %"
std::string percent(double probability) {
  return probability > 0.999 ? "over 99.9 %" : fmt::format("{:.2g} %", 100.0 * probability);
}

/// States the least probabilities with which a difference would have been found that needs no change of priorities, or
/// one: the orders without a change find the first, those with one the second.
void Orders::conclude_same() {
  const double threads = tried().threads, places = static_cast<double>(tried().places);
  const auto found = [&](double in_one, int changes) {
    const int orders = (tried().tried + most_changes - changes) / (most_changes + 1);
    return percent(1.0 - std::pow(1.0 - in_one, orders));
  };
  report_.verdict = fmt::format(
      "{} gave the same {} commands, bit for bit, in {} other orders of {} threads, at {} places where another one may "
      "come first; a difference is found with a probability of at least {} if it needs other priorities, of {} if it "
      "needs a change of them at one place",
      names(), report_.commands, tried().tried, tried().threads, tried().places, found(1.0 / threads, 0),
      found(1.0 / (threads * places), 1));
}

Result<void> Orders::run(const std::function<void(const ReplayPass&)>& take_first) {
  report_.orders.emplace();
  auto passes = REHEARSE_TRY(replay_exchanges({{}, {}}));
  usual_ = std::move(passes[0]);
  take_first(usual_);
  if (report_.failure) {
    report_.deterministic = false;
    report_.verdict = "failed: " + report_.failure->message;
    return {};
  }
  if (usual_.order) {
    tried().places = usual_.order->places;
    tried().threads = usual_.order->threads;
  }
  if (const auto differs = difference_of(passes[1])) {
    report_.deterministic = false;
    report_.verdict = fmt::format(
        "unknown: in one order of threads {} of {} differs at tick {} from replay to replay; an audit without --orders "
        "looks for the cause",
        differs->element, differs->channel, differs->tick);
    return {};
  }
  if (tried().places == 0) {
    report_.verdict = fmt::format(
        "there is no other order to try: at no place are several threads of {} ready that take turns", names());
    return {};
  }
  auto found = REHEARSE_TRY(find());
  if (!found) {
    conclude_same();
    return {};
  }
  tried().file = options_.order_file;
  nlohmann::ordered_json order = drawn(found->first);
  if (found->second.order) {
    Exchanges exchanges = REHEARSE_TRY(reduced(std::move(found->second.order->made)));
    order = json_of_order(exchanges);
  }
  auto again = REHEARSE_TRY(replay({order, order}));
  if (!difference_of(again[0]) || difference(again[0], again[1], report_.time_step, "")) {
    report_.deterministic = false;
    report_.verdict = fmt::format("unknown: order {} gave other commands once, and doesn't repeat them", tried().tried);
    return {};
  }
  if (again[0].order && !again[0].order->made.empty()) order = json_of_order(again[0].order->made);
  conclude(again[0]);
  return tried().file.empty() ? Result<void>() : write_order(tried().file, order);
}

}  // namespace

Result<void> try_orders(ReplayProcesses& processes, const AuditOptions& options, AuditReport& report,
                        const std::function<void(const ReplayPass&)>& take_first) {
  return Orders(processes, options, report).run(take_first);
}

}  // namespace rehearse
