#include "step_session.h"

#include <fmt/format.h>
#include <rehearse/compare.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

#include "base/replaceable.h"
#include "base/text.h"
#include "base/write_hint.h"
#include "core/kinds/channel_name.h"
#include "output.h"
#include "tick_print.h"

namespace rehearse::tool {
namespace {

constexpr std::int64_t most_samples = 200'000;  // of a plot

/// The first word, which is removed from the text.
std::string_view take_word(std::string_view& text) {
  const auto blanks = [&] { return std::min(text.find_first_not_of(" \t"), text.size()); };
  text.remove_prefix(blanks());
  const std::string_view word = text.substr(0, text.find_first_of(" \t"));
  text.remove_prefix(word.size());
  text.remove_prefix(blanks());
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return word;
}

/// "1200", "3.2s", "start", "end", "+5", "-5".
std::optional<std::int64_t> place(std::string_view text, std::int64_t here, const SteppedTrace& trace) {
  if (text == "start") return trace.first_tick();
  if (text == "end") return trace.last_tick();
  constexpr double longest = 1e9;  // [s]
  if (text.ends_with('s')) {
    const auto time = number_in<double>(text.substr(0, text.size() - 1));
    if (!time || !(*time >= 0.0) || *time > longest) return std::nullopt;
    return trace.tick_at(*time);
  }
  constexpr std::int64_t farthest = std::int64_t{1} << 60;
  const bool goes_on = text.starts_with('+');
  const auto tick = number_in<std::int64_t>(goes_on ? text.substr(1) : text);
  if (!tick || *tick > farthest || *tick < -farthest) return std::nullopt;
  return goes_on || text.starts_with('-') ? here + *tick : *tick;
}

std::string text_of_number(double value) { return std::isnan(value) ? "NaN" : fmt::format("{}", value); }

}  // namespace

const std::vector<StepSession::Command>& StepSession::commands() {
  using S = StepSession;
  static const std::vector<Command> all{
      {"next", "n", "[N]", "a tick on, or N", &S::next},
      {"back", "b", "[N | until EXPR | continue]", "a tick back, or N; or until and continue backwards", &S::back},
      {"goto", "g", "TICK | 3.2s | +N | -N | start | end", "to a tick, or to the one at a time", &S::go_to_place},
      {"until", "u", "EXPR", "on to the tick at which the expression becomes true", &S::until, true},
      {"continue", "c", "", "on to the next begin of a difference, message, or change of a contact", &S::go_on},
      {"watch", "w", "[GLOB]", "show these series after each move; without a name: list them", &S::watch, true},
      {"unwatch", "", "[GLOB]", "show these series no longer; without a name: none", &S::unwatch, true},
      {"print", "p", "EXPR", "the value of an expression here", &S::print_value, true},
      {"info", "i", "[full]", "all of this tick; full: also unchanged values", &S::info},
      {"inputs", "", "", "the inputs of the controllers in this tick", &S::inputs},
      {"commands", "", "", "the commands of the controllers in this tick", &S::commanded},
      {"messages", "m", "", "the messages in this tick", &S::messages},
      {"contacts", "", "", "the contacts in this tick", &S::contacts},
      {"threads", "", "", "the threads of controllers after this tick, and what each waits for", &S::threads},
      {"diff", "d", "", "the differences of the commands from the recording in this tick", &S::differences},
      {"plot", "", "SERIES [FROM UNTIL]", "a picture of a series around this tick, or between two places", &S::plot,
       true},
      {"frame", "f", "[CAMERA] FILE.png", "writes the latest picture at or before this tick", &S::frame},
      {"gdb-hint", "", "", "the command that stops gdb in this tick", &S::gdb_hint},
      {"help", "h", "[COMMAND]", "this, or a command", &S::help},
      {"quit", "q", "", "", &S::quit},
  };
  return all;
}

StepSession::StepSession(SteppedTrace& trace, std::string command_line, std::function<bool()> interrupted)
    : trace_(trace),
      command_line_(std::move(command_line)),
      interrupted_(std::move(interrupted)),
      tick_(trace.first_tick()) {}

/// The command by its letter, its name, or a unique beginning of its name. Null: the error was printed.
const StepSession::Command* StepSession::find(std::string_view word) const {
  std::vector<const Command*> found;
  for (const Command& command : commands()) {
    if (word == command.name || word == command.letter) return &command;
    if (command.name.starts_with(word)) found.push_back(&command);
  }
  if (found.size() == 1) return found.front();
  std::string names;
  for (const Command* command : found) names += (names.empty() ? "" : ", ") + std::string(command->name);
  refuse(found.empty() ? error(fmt::format("there is no command '{}'", plain_text(word)), "help lists them")
                       : error(fmt::format("'{}' may be {}", plain_text(word), names)));
  return nullptr;
}

StepSession::Answer StepSession::answer(std::string_view line) {
  std::string_view rest = line;
  std::string_view word = take_word(rest);
  const std::string again = last_line_;
  if (word.empty()) {
    rest = again;
    word = take_word(rest);
    if (word.empty()) return Answer::done;
  } else {
    last_line_ = line;
  }
  if (word.starts_with('#')) return Answer::done;
  const Command* command = find(word);
  if (!command) return Answer::not_understood;
  return (this->*command->function)(rest);
}

StepSession::Answer StepSession::refuse(const Diagnostic& diagnostic) const {
  std::fflush(stdout);
  fmt::print(stderr, "{}\n", to_string(diagnostic));
  return Answer::not_understood;
}

std::vector<std::string> StepSession::candidates(std::string_view before, std::string_view word) const {
  std::string_view rest = before;
  const std::string_view first = take_word(rest);
  std::vector<std::string> all;
  if (first.empty() || first == "help" || first == "h") {
    for (const Command& command : commands()) all.emplace_back(command.name);
    return all;
  }
  const auto means = [first](std::string_view name, std::string_view letter) {
    return name.starts_with(first) || first == letter;
  };
  bool takes_series = false;
  for (const Command& command : commands()) takes_series |= means(command.name, command.letter) && command.takes_series;
  const bool goes_back = means("back", "b");
  if (goes_back) all = {"until", "continue"};
  if (!takes_series && !goes_back) return all;
  std::set<std::string> endings;
  bool begins_a_name = false;
  for (const std::string& name : trace_.series_names()) {
    begins_a_name |= name.starts_with(word);
    all.push_back(name);
    for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1))
      endings.insert(name.substr(slash + 1));
  }
  if (!begins_a_name) all.insert(all.end(), endings.begin(), endings.end());
  return all;
}

void StepSession::go_to(std::int64_t tick) { tick_ = std::clamp(tick, trace_.first_tick(), trace_.last_tick()); }

bool StepSession::arrive(std::int64_t tick) {
  go_to(tick);
  fmt::print("{}\n", where());
  return tick_ == tick;
}

std::string StepSession::where() {
  std::string text = tick_text(tick_, trace_.time_at(tick_));
  const std::vector<Divergence> differences = trace_.differences(tick_);
  if (!differences.empty()) {
    text += "  differs: " + difference_text(differences.front());
    if (differences.size() > 1) text += fmt::format(" and {} more", differences.size() - 1);
  }
  for (const ViewContact& contact : trace_.contacts(tick_))
    if (contact.began || !contact.touches) text += "  " + contact_text(contact);
  for (const ViewMessage& message : trace_.messages(tick_)) text += "  " + message_text(message);
  const std::int64_t failed = trace_.last_replayed().value_or(trace_.first_tick() - 1) + 1;
  if (trace_.failure() && tick_ >= failed)
    text += tick_ == failed ? "  (the replay failed here)" : "  (as recorded: the replay failed before)";
  for (const std::size_t series : watched_) {
    const double value = trace_.value(series, tick_, CommandSide::recorded);
    const std::string unit = trace_.series_unit(series);
    text +=
        fmt::format("\n  {} = {}{}", trace_.series_name(series), text_of_number(value), unit.empty() ? "" : " " + unit);
    if (!trace_.is_replayed(series)) continue;
    const double replayed = trace_.value(series, tick_, CommandSide::replayed);
    if (!identical(value, replayed)) text += fmt::format(" (replayed {})", text_of_number(replayed));
  }
  return text;
}

StepSession::Answer StepSession::move(std::int64_t by) {
  const std::int64_t end = by > 0 ? trace_.last_tick() : trace_.first_tick();
  if (tick_ == end && by != 0)
    return refuse(
        error(by > 0 ? fmt::format("this is the last tick, {}", end) : fmt::format("this is the first tick, {}", end)));
  arrive(tick_ + by);
  return Answer::done;
}

StepSession::Answer StepSession::next(Words rest) {
  constexpr std::int64_t most = 1'000'000'000'000;
  if (rest.empty()) return move(1);
  const auto count = number_in<std::int64_t>(rest);
  if (!count || *count < 1 || *count > most)
    return refuse(error(fmt::format("'{}' is no number of ticks", plain_text(rest))));
  return move(*count);
}

StepSession::Answer StepSession::back(Words rest) {
  constexpr std::int64_t most = 1'000'000'000'000;
  if (rest.empty()) return move(-1);
  std::string_view of = rest;
  const std::string_view word = take_word(of);
  if (std::string_view("until").starts_with(word)) return search(of, Direction::backwards);
  if (std::string_view("continue").starts_with(word)) return to_happening(Direction::backwards);
  const auto count = number_in<std::int64_t>(rest);
  if (!count || *count < 1 || *count > most)
    return refuse(error(fmt::format("'{}' is no number of ticks", plain_text(rest)),
                        "back, back N, back until EXPR, back continue"));
  return move(-*count);
}

StepSession::Answer StepSession::go_to_place(Words rest) {
  const auto tick = place(rest, tick_, trace_);
  if (!tick)
    return refuse(error(fmt::format("'{}' is no place", plain_text(rest)), "goto 1200, goto 3.2s, goto +10, goto end"));
  if (*tick < trace_.first_tick() || *tick > trace_.last_tick())
    return refuse(error(fmt::format("there is no tick {}: they are {} to {} ({:.10g} s)", *tick, trace_.first_tick(),
                                    trace_.last_tick(), trace_.time_at(trace_.last_tick()))));
  arrive(*tick);
  return Answer::done;
}

StepSession::Answer StepSession::search(Words text, Direction direction) {
  const auto expression = Expression::parse(text, trace_);
  if (!expression || expression->type() != Expression::Type::boolean) {
    Diagnostic why = error("until takes a condition, and this is a number", "compare it: > 0");
    why.column = 1;
    std::fflush(stdout);
    fmt::print(stderr, "{}", with_caret(expression ? why : expression.errors().front(), text));
    return Answer::not_understood;
  }
  const auto found = find_tick(*expression, trace_, tick_, direction, interrupted_);
  if (found) {
    arrive(*found);
  } else if (interrupted_()) {
    fmt::print("interrupted; still at {}\n", tick_text(tick_, trace_.time_at(tick_)));
  } else {
    fmt::print("it doesn't become true {} here; still at {}\n", direction == Direction::forwards ? "after" : "before",
               tick_text(tick_, trace_.time_at(tick_)));
  }
  return Answer::done;
}

StepSession::Answer StepSession::until(Words rest) { return search(rest, Direction::forwards); }

StepSession::Answer StepSession::to_happening(Direction direction) {
  const auto found = trace_.happening(tick_, direction);
  if (found) {
    arrive(*found);
  } else {
    fmt::print("nothing more happens {} here; still at {}\n", direction == Direction::forwards ? "after" : "before",
               tick_text(tick_, trace_.time_at(tick_)));
  }
  return Answer::done;
}

StepSession::Answer StepSession::go_on(Words) { return to_happening(Direction::forwards); }

StepSession::Answer StepSession::watch(Words rest) {
  if (!rest.empty()) {
    const auto found = trace_.find_all_series(rest);
    if (!found) return refuse(found.errors().front());
    for (const std::size_t series : *found)
      if (std::ranges::find(watched_, series) == watched_.end()) watched_.push_back(series);
  }
  if (watched_.empty()) fmt::print("nothing is watched\n");
  for (const std::size_t series : watched_)
    fmt::print("  {} = {}\n", trace_.series_name(series),
               text_of_number(trace_.value(series, tick_, CommandSide::recorded)));
  return Answer::done;
}

StepSession::Answer StepSession::unwatch(Words rest) {
  if (rest.empty()) return watched_.clear(), Answer::done;
  const auto found = trace_.find_all_series(rest);
  if (!found) return refuse(found.errors().front());
  std::erase_if(watched_, [&](std::size_t series) { return std::ranges::find(*found, series) != found->end(); });
  return Answer::done;
}

StepSession::Answer StepSession::print_value(Words rest) {
  const auto expression = Expression::parse(rest, trace_);
  if (!expression) {
    std::fflush(stdout);
    fmt::print(stderr, "{}", with_caret(expression.errors().front(), rest));
    return Answer::not_understood;
  }
  const double value = expression->number(trace_, tick_);
  const bool is_boolean = expression->type() == Expression::Type::boolean;
  fmt::print("{} = {}", rest, is_boolean ? (value != 0.0 ? "true" : "false") : text_of_number(value));
  const auto operands = expression->operands();
  const bool is_a_name = operands.size() == 1 && operands[0].text == rest && rest.find_first_of("('\"") == Words::npos;
  if (const auto series = is_a_name ? trace_.find_series(rest) : Result<std::size_t>(error("no name")); series) {
    const std::string unit = trace_.series_unit(*series);
    if (!unit.empty()) fmt::print(" {}", unit);
    const double replayed = trace_.is_replayed(*series) ? trace_.value(*series, tick_, CommandSide::replayed) : value;
    if (!identical(replayed, value)) fmt::print(" (replayed {})", text_of_number(replayed));
  }
  fmt::print("\n");
  return Answer::done;
}

StepSession::Answer StepSession::info(Words rest) {
  TickParts parts;
  parts.full = rest == "full";
  if (!rest.empty() && !parts.full)
    return refuse(error(fmt::format("info takes 'full' or nothing, not '{}'", plain_text(rest))));
  fmt::print("{}", text_of(trace_.view(tick_), parts));
  return Answer::done;
}

StepSession::Answer StepSession::inputs(Words) {
  TickParts parts;
  parts.outputs = parts.rest = parts.messages = parts.contacts = parts.threads = parts.differences = false;
  fmt::print("{}", text_of(trace_.view(tick_), parts));
  return Answer::done;
}

StepSession::Answer StepSession::commanded(Words) {
  TickParts parts;
  parts.inputs = parts.rest = parts.messages = parts.contacts = parts.threads = false;
  fmt::print("{}", text_of(trace_.view(tick_), parts));
  return Answer::done;
}

StepSession::Answer StepSession::messages(Words) {
  const auto all = trace_.messages(tick_);
  if (all.empty()) fmt::print("there is no message in tick {}\n", tick_);
  for (const ViewMessage& message : all) fmt::print("  {}\n", message_text(message));
  return Answer::done;
}

StepSession::Answer StepSession::contacts(Words) {
  const auto all = trace_.contacts(tick_);
  if (all.empty()) fmt::print("there is no contact\n");
  for (const ViewContact& contact : all) fmt::print("  {}\n", contact_text(contact));
  return Answer::done;
}

StepSession::Answer StepSession::threads(Words) {
  const auto all = trace_.threads(tick_);
  if (all.empty()) fmt::print("no thread of a controller takes turns in tick {}\n", tick_);
  for (const std::string& thread : all) fmt::print("  {}\n", plain_text(thread));
  return Answer::done;
}

StepSession::Answer StepSession::differences(Words) {
  const auto all = trace_.differences(tick_);
  const bool replayed = trace_.last_replayed() && tick_ <= *trace_.last_replayed();
  if (all.empty())
    fmt::print("{}\n", replayed ? "the replay gives the same bits as the recording" : "this tick wasn't replayed");
  for (const Divergence& difference : all) fmt::print("  {}\n", difference_text(difference));
  return Answer::done;
}

StepSession::Answer StepSession::plot(Words rest) {
  const std::string_view name = take_word(rest);
  if (name.empty()) return refuse(error("plot takes a series", "plot SERIES [FROM UNTIL]"));
  const auto series = trace_.find_series(name);
  if (!series) return refuse(series.errors().front());
  std::int64_t first = std::max(trace_.first_tick(), trace_.tick_at(std::max(0.0, trace_.time_at(tick_) - 0.5)));
  std::int64_t last = std::min(trace_.last_tick(), trace_.tick_at(trace_.time_at(tick_) + 0.5));
  if (!rest.empty()) {
    const auto from = place(take_word(rest), tick_, trace_), until = place(rest, tick_, trace_);
    if (!from || !until || *from >= *until)
      return refuse(error("plot takes two places, the earlier one first", "plot SERIES 3s 3.5s"));
    first = std::max(trace_.first_tick(), *from);
    last = std::min(trace_.last_tick(), *until);
  }
  const std::int64_t step = std::max<std::int64_t>(1, (last - first) / most_samples);
  Curve recorded, replayed;
  double low = std::nan(""), high = std::nan("");
  for (std::int64_t tick = first; tick <= last && !interrupted_(); tick += step) {
    const double value = trace_.value(*series, tick, CommandSide::recorded);
    recorded.times.push_back(trace_.time_at(tick));
    recorded.values.push_back(value);
    low = std::fmin(low, value);
    high = std::fmax(high, value);
    if (!trace_.is_replayed(*series) || !trace_.differs()) continue;
    replayed.times.push_back(trace_.time_at(tick));
    replayed.values.push_back(trace_.value(*series, tick, CommandSide::replayed));
  }
  const std::string unit = trace_.series_unit(*series);
  fmt::print("{}{}, {:.7g} to {:.7g}, {} here{}{}\n", trace_.series_name(*series),
             unit.empty() ? "" : " [" + unit + "]", low, high,
             text_of_number(trace_.value(*series, tick_, CommandSide::recorded)),
             step > 1 ? fmt::format(", each {}th tick", step) : "",
             replayed.times.empty() ? "" : "; ░ recorded, █ replayed, ▒ both");
  std::optional<double> here;
  if (tick_ >= first && tick_ <= last) here = trace_.time_at(tick_);
  const bool has_replay = !replayed.times.empty();
  fmt::print("{}", rehearse::plot(has_replay ? recorded : Curve(), has_replay ? replayed : recorded, here));
  return Answer::done;
}

void StepSession::plot_difference() {
  const std::vector<Divergence> differences = trace_.differences(tick_);
  const auto shown = std::ranges::find_if(differences, [this](const Divergence& difference) {
    return !difference.element.empty() && trace_.find_series(series_name(difference.channel, difference.element)).ok();
  });
  if (shown != differences.end()) plot(series_name(shown->channel, shown->element));
}

std::string StepSession::keys_text() {
  return "keys: n next tick, b back, c on to where something happens, u EXPR to where it becomes true, g TICK\n"
         "      p EXPR a value, plot SERIES, i all of this tick, d its differences, m its messages, gdb-hint\n"
         "      Enter does the last command again, Tab completes, h lists all commands, q quits\n";
}

StepSession::Answer StepSession::frame(Words rest) {
  std::string_view words = rest;
  std::string_view camera = take_word(words), file = words;
  if (file.empty()) std::swap(camera, file);
  if (file.empty()) return refuse(error("frame takes a file", "frame [CAMERA] FILE.png"));
  const auto picture = trace_.picture(camera, tick_);
  if (!picture) return refuse(picture.errors().front());
  if (picture->bytes.empty()) return refuse(error(fmt::format("{} was off in tick {}", picture->topic, picture->tick)));
  const std::filesystem::path path(file);
  if (path.extension() != "." + picture->extension)
    return refuse(error(fmt::format("'{}' doesn't end in .{}", plain_text(file), picture->extension)));
  if (const auto replaceable = check_replaceable(path, picture->extension == "png" ? png_magic : "\xff\xd8", "picture");
      !replaceable)
    return refuse(replaceable.errors().front());
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(picture->bytes.data()), static_cast<std::streamsize>(picture->bytes.size()));
  out.close();
  if (!out)
    return refuse(error(fmt::format("can't write {}", plain_text(file)), write_hint(path, "name another file")));
  fmt::print("{}: {}, of {}\n", plain_text(file), picture->topic,
             tick_text(picture->tick, trace_.time_at(picture->tick)));
  return Answer::done;
}

StepSession::Answer StepSession::gdb_hint(Words) {
  fmt::print("rehearse replay {} --gdb --tick {}\n", command_line_, tick_);
  return Answer::done;
}

StepSession::Answer StepSession::help(Words rest) {
  if (!rest.empty()) {
    const Command* command = find(rest);
    if (!command) return Answer::not_understood;
    fmt::print("{} {}: {}\n", command->name, command->arguments, command->help);
    return Answer::done;
  }
  std::vector<TableRow> rows;
  for (const Command& command : commands())
    rows.push_back({std::string(command.letter), fmt::format("{} {}", command.name, command.arguments),
                    std::string(command.help)});
  for (const TableRow& row : rows) fmt::print("  {:2} {:44} {}\n", row[0], row[1], row[2]);
  fmt::print(
      "An empty line does the last command again. EXPR: SR1/KNEE/u > 100 && contact(FOOT); rehearse doc expressions "
      "has all of it.\n");
  return Answer::done;
}

StepSession::Answer StepSession::quit(Words) { return Answer::quit; }

}  // namespace rehearse::tool
