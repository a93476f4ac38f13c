#include "replay_ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "progress.h"
#include "tick_print.h"

namespace rehearse::tool {
namespace {

struct Watched {
  std::size_t series = 0;
  CommandSide side = CommandSide::recorded;
  std::string title;  // with its unit
};

Result<std::vector<Watched>> watched(const TickSettings& settings, SteppedTrace& trace) {
  std::vector<Watched> all;
  Diagnostics problems;
  for (const std::string& pattern : settings.watch) {
    const auto found = trace.find_all_series(pattern);
    if (!found) {
      problems.push_back(found.errors().front());
      continue;
    }
    for (const std::size_t series : *found) {
      const bool known = std::ranges::any_of(all, [&](const Watched& w) { return w.series == series; });
      if (known) continue;
      const std::string unit = trace.series_unit(series);
      const std::string title = trace.series_name(series) + (unit.empty() ? "" : " [" + unit + "]");
      all.push_back({series, CommandSide::recorded, title});
      if (trace.is_replayed(series) && trace.differs())
        all.push_back({series, CommandSide::replayed, "replayed " + trace.series_name(series)});
    }
  }
  if (!problems.empty()) return problems;
  return all;
}

/// Prints one object per line.
void print_object(const Json& object) { print_line(object.dump(-1, ' ', false, Json::error_handler_t::replace)); }

/// The ticks from --from up to --until.
TickSpanFound ticks_of(const TickSettings& settings, const SteppedTrace& trace) {
  TickSpanFound span{trace.first_tick(), trace.last_tick()};
  const auto first_from = [&](double time) {
    const std::int64_t tick = trace.tick_at(time);
    return trace.time_at(tick) < time - 1e-9 ? tick + 1 : tick;
  };
  span.first = std::max(span.first, first_from(settings.from));
  if (settings.until) span.last = std::min(span.last, first_from(*settings.until) - 1);
  return span;
}

std::string cell(double value) { return std::isnan(value) ? "NaN" : fmt::format("{}", value); }

Exit print_watched(const TickSettings& settings, SteppedTrace& trace) {
  const auto columns = watched(settings, trace);
  if (!columns) return refuse(columns.errors());
  constexpr std::size_t narrowest = 22;  // enough for a double with all digits
  std::vector<std::size_t> widths;
  std::string heading = fmt::format("{:>8}, {:>10}", "tick", "time [s]");
  for (const Watched& column : *columns) {
    widths.push_back(std::max(narrowest, column.title.size()));
    heading += fmt::format(", {:>{}}", column.title, widths.back());
  }
  if (!settings.json) fmt::print("{}\n", heading);
  const TickSpanFound span = ticks_of(settings, trace);
  for (std::int64_t tick = span.first; tick <= span.last; tick += settings.every) {
    std::string line = fmt::format("{:>8}, {:>10.10g}", tick, trace.time_at(tick));
    Json object{{"tick", tick}, {"time", trace.time_at(tick)}};
    for (std::size_t i = 0; i < columns->size(); ++i) {
      const Watched& column = (*columns)[i];
      const double value = trace.value(column.series, tick, column.side);
      if (settings.json) {
        const bool replayed = column.side == CommandSide::replayed;
        object[replayed ? "replayed" : "values"][trace.series_name(column.series)] = number_json(value);
      } else {
        line += fmt::format(", {:>{}}", cell(value), widths[i]);
      }
    }
    if (settings.json) {
      print_object(object);
    } else {
      fmt::print("{}\n", line);
    }
  }
  return Exit::done;
}

std::string operand_text(const Expression& expression, const Expression::Operand& operand, SteppedTrace& trace,
                         std::int64_t tick) {
  const double value = expression.number_of(operand, trace, tick);
  const bool is_a_question = operand.text.starts_with("contact(") || operand.text.starts_with("message(");
  return fmt::format("{} = {}", operand.text, is_a_question ? (value != 0.0 ? "true" : "false") : cell(value));
}

Exit refuse_with_caret(const Diagnostic& finding, const std::string& text) {
  print_errors_as_json({finding});
  fmt::print(stderr, "{}", with_caret(finding, text));
  return Exit::bad_input;
}

Exit print_when(const TickSettings& settings, SteppedTrace& trace) {
  const auto expression = Expression::parse(settings.when, trace);
  if (!expression) return refuse_with_caret(expression.errors().front(), settings.when);
  if (expression->type() != Expression::Type::boolean) {
    Diagnostic finding = error("--when takes a condition, and this is a number", "compare it: > 0");
    finding.column = 1;
    return refuse_with_caret(finding, settings.when);
  }
  std::int64_t spans = 0, ticks = 0;
  std::optional<std::int64_t> first;
  const auto tell = [&](const TickSpanFound& span) {
    const std::int64_t length = span.last - span.first + 1;
    if (!first) first = span.first;
    if (settings.json) {
      Json operands = Json::object();
      for (const Expression::Operand& operand : expression->operands())
        operands[operand.text] = number_json(expression->number_of(operand, trace, span.first));
      print_object({{"tick", span.first},
                    {"time", trace.time_at(span.first)},
                    {"ticks", length},
                    {"last_tick", span.last},
                    {"operands", operands}});
    } else {
      if (spans == 0) fmt::print("{:>8}  {:>10}  {:>8}\n", "tick", "time [s]", "ticks");
      fmt::print("{:>8}  {:>10.10g}  {:>8}\n", span.first, trace.time_at(span.first), length);
    }
    ++spans;
    ticks += length;
    return true;
  };
  const TickSpanFound span = ticks_of(settings, trace);
  find_spans(*expression, trace, span.first, span.last, tell);
  if (!settings.json && first) {
    fmt::print("{}, {} of {}\nat tick {}:", count_text(spans, "span"), ticks,
               count_text(span.last - span.first + 1, "tick"), *first);
    const char* separator = " ";
    for (const Expression::Operand& operand : expression->operands()) {
      fmt::print("{}{}", separator, operand_text(*expression, operand, trace, *first));
      separator = ", ";
    }
    fmt::print("\n");
  } else if (!settings.json) {
    fmt::print("never, in {}\n", count_text(std::max<std::int64_t>(0, span.last - span.first + 1), "tick"));
  }
  return first ? Exit::done : Exit::differs;
}

Exit print_tick(const TickSettings& settings, SteppedTrace& trace) {
  const std::int64_t tick = settings.tick ? *settings.tick : trace.tick_at(*settings.at);
  if (tick > trace.last_tick() || tick < trace.first_tick())
    return refuse(error_in(trace.file(), fmt::format("nothing is recorded at {} s", *settings.at),
                           fmt::format("its ticks are {} to {}, up to {:.10g} s", trace.first_tick(), trace.last_tick(),
                                       trace.time_at(trace.last_tick()))));
  TickParts parts;
  parts.full = settings.full;
  for (const std::string& pattern : settings.watch) {
    const auto found = trace.find_all_series(pattern);
    if (!found) return refuse(found.errors());
    for (const std::size_t series : *found) parts.only.push_back(trace.series_name(series));
  }
  const TickView view = trace.view(tick);
  if (settings.json) {
    Json object = json_of(view, parts);
    object["remarks"] = json_of(trace.remarks());
    print(object);
  } else {
    fmt::print("{}", text_of(view, parts));
  }
  return Exit::done;
}

}  // namespace

Result<void> check_usage(const TickSettings& settings) {
  if (settings.tick && settings.at) return error("--tick and --at have the same meaning", "give one of them");
  if (settings.shows_a_tick() && !settings.when.empty())
    return error("--when looks for ticks, and --tick shows one", "give one of them");
  if (!settings.when.empty() && !settings.watch.empty())
    return error("--when looks for ticks, and --watch shows series", "give one of them");
  const bool has_span = settings.from > 0.0 || settings.until;
  if (settings.shows_a_tick() && has_span)
    return error("--tick shows one tick: --from and --until have no effect on it");
  if (settings.every != 1 && (settings.watch.empty() || settings.shows_a_tick()))
    return error("--every is for --watch", "a row each so many ticks");
  if (settings.full && !settings.shows_a_tick()) return error("--full is for --tick");
  return {};
}

void tell_remarks(const SteppedTrace& trace) {
  std::fflush(stdout);
  tell_remarks(trace.remarks(), trace.failure());
  if (trace.failure())
    fmt::print(stderr, "{}\nthe replay ended at tick {}: from there on commands are those of the recording\n",
               to_string(*trace.failure()), trace.last_replayed().value_or(-1) + 1);
}

Exit show_ticks(const TickSettings& settings) {
  SteppingOptions options;
  static_cast<HostOptions&>(options) = settings.host;
  options.last_tick = settings.tick;
  options.last_time = settings.at ? settings.at : settings.until;
  auto trace = [&] {
    Progress progress("replaying");
    options.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return SteppedTrace::open(settings.trace, options);
  }();
  if (!trace) return refuse(trace.errors());
  const Exit ended = !settings.when.empty()    ? print_when(settings, **trace)
                     : settings.shows_a_tick() ? print_tick(settings, **trace)
                                               : print_watched(settings, **trace);
  tell_remarks(**trace);
  return ended;
}

}  // namespace rehearse::tool
