#include "run_facts.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <algorithm>

#include "base/text.h"

namespace rehearse {
namespace {

/// The number of a key; nullopt: not stated, or not a number.
template <class Number>
std::optional<Number> number_of(const mcap::StringMap& metadata, const char* key) {
  return number_in<Number>(stated(metadata, key));
}

std::optional<std::string> text_of(const mcap::StringMap& metadata, const char* key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? std::nullopt : std::optional(found->second);
}

// Keys of the outcome and of a branch's origin.
constexpr const char *ticks_key = "ticks", *complete_key = "complete", *failure_key = "failure",
                     *checkpoints_key = "checkpoints";
constexpr const char *source_key = "source", *loop_key = "loop", *tick_key = "tick", *time_key = "time",
                     *checkpoint_key = "checkpoint", *set_key = "set", *push_key = "push",
                     *controller_key = "controller", *acted_until_key = "acted_until";

void put_list(mcap::StringMap& metadata, const char* key, const std::vector<std::string>& texts) {
  for (std::size_t i = 0; i < texts.size(); ++i) metadata[fmt::format("{}.{}", key, i + 1)] = texts[i];
}

std::vector<std::string> numbered_values(const mcap::StringMap& metadata, const char* key) {
  std::vector<std::string> texts;
  while (const auto text = text_of(metadata, fmt::format("{}.{}", key, texts.size() + 1).c_str()))
    texts.push_back(*text);
  return texts;
}

void take_provenance(const mcap::StringMap& provenance, RunFacts& run) {
  run.provenance = provenance;
  run.trace_version = number_of<int>(provenance, facts::trace_version);
  run.trace_revision = number_of<int>(provenance, facts::trace_revision).value_or(1);
  run.seed = number_of<std::uint32_t>(provenance, facts::seed);
  run.time_step = number_of<double>(provenance, facts::time_step);
  run.duration = number_of<double>(provenance, facts::duration);
  const std::string source = stated(provenance, facts::source);
  run.is_of_flight = source == "flight";
  run.is_of_log = source == "log" || run.is_of_flight;
  const std::string_view prefix = facts::controller_prefix;
  for (const auto& [fact, value] : provenance)
    if (fact.starts_with(prefix)) run.controllers.emplace(fact.substr(prefix.size()), value);
}

}  // namespace

std::string stated(const mcap::StringMap& facts, const std::string& key) {
  const auto found = facts.find(key);
  return found == facts.end() ? std::string() : found->second;
}

std::string architecture_of(const mcap::StringMap& provenance) {
  const std::string other = stated(provenance, facts::architecture);
  return other.empty() ? "x86-64" : other;
}

mcap::StringMap RunOutcome::metadata() const {
  mcap::StringMap metadata{{complete_key, complete ? "true" : "false"}};
  if (ticks) metadata[ticks_key] = std::to_string(*ticks);
  if (failure) metadata[failure_key] = *failure;
  if (checkpoints) metadata[checkpoints_key] = *checkpoints;
  return metadata;
}

RunOutcome RunOutcome::of(const mcap::StringMap& metadata) {
  return {number_of<std::int64_t>(metadata, ticks_key), stated(metadata, complete_key) == "true",
          text_of(metadata, failure_key), text_of(metadata, checkpoints_key)};
}

mcap::StringMap BranchOrigin::metadata() const {
  mcap::StringMap metadata{{source_key, source},
                           {loop_key, simulated ? "closed" : "open"},
                           {tick_key, std::to_string(tick)},
                           {time_key, fmt::format("{}", time)}};
  if (!checkpoint.empty()) metadata[checkpoint_key] = checkpoint;
  put_list(metadata, set_key, set);
  put_list(metadata, push_key, push);
  put_list(metadata, controller_key, controllers);
  if (acted_until) metadata[acted_until_key] = std::to_string(*acted_until);
  return metadata;
}

BranchOrigin BranchOrigin::of(const mcap::StringMap& metadata) {
  BranchOrigin origin;
  origin.source = stated(metadata, source_key);
  origin.simulated = stated(metadata, loop_key) != "open";
  origin.tick = number_of<std::int64_t>(metadata, tick_key).value_or(0);
  origin.time = number_of<double>(metadata, time_key).value_or(0.0);
  origin.checkpoint = stated(metadata, checkpoint_key);
  origin.set = numbered_values(metadata, set_key);
  origin.push = numbered_values(metadata, push_key);
  origin.controllers = numbered_values(metadata, controller_key);
  origin.acted_until = number_of<std::int64_t>(metadata, acted_until_key);
  return origin;
}

std::string RunFacts::stated(const std::string& fact) const {
  return provenance ? rehearse::stated(*provenance, fact) : std::string();
}

bool RunFacts::had_library(const std::string& controller_label, const std::string& content_hash) const {
  const auto found = controllers.find(controller_label);
  return found != controllers.end() && found->second.ends_with(" " + content_hash);
}

std::int64_t RunFacts::ticks(std::int64_t messages) const {
  const bool is_one_run = provenances == 1 && outcome && outcome->ticks;
  return is_one_run ? std::min(*outcome->ticks, messages) : messages;
}

RunFacts RunFacts::of(const std::vector<mcap::Metadata>& metadata) {
  RunFacts run;
  for (const mcap::Metadata& record : metadata) {
    const bool is_next_part = run.is_of_flight && record.values == *run.provenance;
    if (record.name == records::provenance && !is_next_part && run.provenances++ == 0)
      take_provenance(record.values, run);
    if (record.name == records::outcome && !run.outcome) run.outcome = RunOutcome::of(record.values);
    if (record.name == records::branch && !run.branch) run.branch = BranchOrigin::of(record.values);
    if (record.name == records::state_rate && !run.state_rate) run.state_rate = StateRate::of(record.values);
    if (record.name == records::devices_read && !run.devices_read) run.devices_read = record.values;
    if (record.name == records::files && !run.files) run.files = record.values;
    if (record.name == records::flight && !run.flight) run.flight = record.values;
  }
  return run;
}

RunFacts RunFacts::of(const mcap::Reader& recording) { return of(recording.metadata()); }
RunFacts RunFacts::of(const Trace& recording) { return of(recording.metadata()); }

Result<void> check_trace_version(const std::vector<mcap::Metadata>& metadata, const std::string& file) {
  const RunFacts run = RunFacts::of(metadata);
  const std::string version = run.stated(facts::trace_version), writer = run.stated(facts::rehearse);
  if (version.empty() || version == std::to_string(trace_version)) return {};
  return error_in(file,
                  fmt::format("it is of trace version {}, and this program reads version {}", version, trace_version),
                  fmt::format("install the version of Rehearse that wrote it{}{}", writer.empty() ? "" : ": ", writer));
}

}  // namespace rehearse
