// rehearse-judge IN OUT: the assertions of <rehearse/gtest.h> for tests in Python. It reads a JSON object a line from
// the descriptor IN and answers each by one on the descriptor OUT, until IN ends. Its process is pinned and supervised
// as that of tests with GoogleTest; it keeps the recordings that it made, as a comparison asks for them.
#include <rehearse/gtest.h>
#include <rehearse/logs.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "core/guard/supervise.h"
#include "gtest/testing/test_process.h"

namespace rehearse::python {
namespace {

using Json = nlohmann::json;

std::map<std::string, Trace>& recordings() {
  static std::map<std::string, Trace> by_file;
  return by_file;
}

const Trace& recording(const std::string& file) {
  const auto known = recordings().find(file);
  if (known != recordings().end()) return known->second;
  auto loaded = Trace::load(file);
  if (!loaded) throw std::runtime_error(to_string(loaded.errors()));
  return recordings().emplace(file, *std::move(loaded)).first->second;
}

Json answer_of(const internal::TestVerdict& verdict) {
  return {{"passed", verdict.passed}, {"message", verdict.message}};
}

internal::MatchOptions options_of(const Json& asked) {
  internal::MatchOptions options;
  options.exact = asked.value("exact", false);
  for (const Json& near : asked.value("near", Json::array())) options.near.push_back({near[0], near[1], near[2]});
  if (asked.contains("until") && !asked["until"].is_null()) options.until = asked["until"].get<double>();
  options.source = asked.value("source", "");
  const std::map<std::string, Level> levels{
      {"controller", Level::controller}, {"plant", Level::plant}, {"closed", Level::closed}};
  if (!asked.contains("levels")) return options;
  options.levels.clear();
  for (const Json& level : asked["levels"]) {
    const auto known = levels.find(level.get<std::string>());
    if (known == levels.end())
      throw std::runtime_error("there is no level '" + level.get<std::string>() + "': controller, plant, closed");
    options.levels.push_back(known->second);
  }
  return options;
}

Json answer(const Json& asked) {
  const std::string verb = asked.at("verb");
  const std::string test = asked.value("test", "");
  note_task(("test " + test).c_str(), 0);
  if (verb == "folders") {
    set_test_folders({asked.at("fixtures"), asked.at("golden"), asked.at("output"), asked.at("controllers")});
    return {{"passed", true}};
  }
  if (verb == "record") {
    Trace trace = internal::record_for_test(asked.at("scenario"), test);
    const std::string file = trace.file();
    recordings().insert_or_assign(file, std::move(trace));
    return {{"passed", true}, {"trace", file}};
  }
  if (verb == "golden") return answer_of(internal::match_golden(recording(asked.at("trace")), test, options_of(asked)));
  if (verb == "holds") return answer_of(internal::hold_expectations(recording(asked.at("trace")), test));
  if (verb == "replays") return answer_of(internal::replay_golden(asked.at("name"), test));
  throw std::runtime_error("there is no verb '" + verb + "'");
}

/// A line without its end; false: there is none any more.
bool read_line(int descriptor, std::string& line) {
  line.clear();
  for (char letter; read(descriptor, &letter, 1) == 1;) {
    if (letter == '\n') return true;
    line += letter;
  }
  return false;
}

bool write_line(int descriptor, const Json& object) {
  const std::string text = object.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(descriptor, text.data() + at, text.size() - at);
    if (written <= 0) return false;
    at += static_cast<std::size_t>(written);
  }
  return true;
}

int serve(int in, int out) {
  for (std::string line; read_line(in, line);) {
    Json reply;
    try {
      reply = answer(Json::parse(line));
    } catch (const std::exception& failed) {
      reply = {{"error", failed.what()}};
    }
    std::fflush(stdout);  // what was said belongs to this test
    if (!write_line(out, reply)) return 1;
  }
  return 0;
}

}  // namespace
}  // namespace rehearse::python

int main(int argc, char** argv) {
  rehearse::internal::begin_test_process(argv);
  if (argc != 3) return 2;
  rehearse::read_rosbag2_logs();
  return rehearse::python::serve(std::atoi(argv[1]), std::atoi(argv[2]));
}
