// The facts of a campaign (campaign.json) and its table of cases (plan.csv).
#include "campaign_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/hashing.h"
#include "base/text.h"
#include "case_values.h"
#include "core/golden/golden_files.h"
#include "csv_text.h"
#include "result_lines.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kind_of_file = "a campaign of Rehearse";

/// Calls `take` with each line of the plan.
void for_each_line(const Campaign& campaign, const std::function<void(const std::string&)>& take) {
  std::string line = "case";
  for (const Variation& variation : campaign.scenario().variations) line += ',' + variation.name;
  take(line + ",again\n");
  for (std::int64_t number = 0; number < campaign.options().cases; ++number) {
    line = fmt::format("{}", number);
    for (const std::string& value : campaign.values_of(number)) line += ',' + csv_cell(value);
    take(line + (campaign.runs_twice(number) ? ",1\n" : ",0\n"));
  }
}

std::string digest_of_plan(const Campaign& campaign) {
  RunningHash hash;
  for_each_line(campaign, [&](const std::string& line) { hash.add(line.data(), line.size()); });
  return hash_text(hash.value());
}

std::string hash_of(const std::string& text) { return hash_text(hash_bytes(text.data(), text.size())); }

/// The scenario and its models, by hash.
Json sources_of_campaign(const Scenario& scenario) {
  Json sources{{"scenario", hash_of(scenario.text)}};
  for (const ScenarioBody& body : scenario.bodies)
    if (!body.model_file.empty()) sources[body.model_file] = hash_of(body.model->source_text);
  return sources;
}

Json json_of_options(const CampaignOptions& options) {
  Json steered = Json::object();
  for (const SteeredParameter& parameter : options.steered)
    steered[parameter.name] = {{"mean", parameter.mean}, {"stddev", parameter.stddev}};
  return {{"cases", options.cases},
          {"seed", options.seed},
          {"golden", options.golden.string()},
          {"keep", options.keep},
          {"case_limit", options.case_limit},
          {"call_limit", options.host.call_limit},
          {"memory_limit", options.host.memory_limit},
          {"controllers", options.host.libraries},
          {"steered", steered},
          {"own_share", options.own_share}};
}

CampaignOptions options_of(const Json& facts) {
  CampaignOptions options;
  options.cases = facts.at("cases").get<std::int64_t>();
  options.seed = facts.at("seed").get<std::uint64_t>();
  options.golden = facts.at("golden").get<std::string>();
  options.keep = facts.at("keep").get<int>();
  options.case_limit = facts.at("case_limit").get<double>();
  options.host.call_limit = facts.at("call_limit").get<double>();
  options.host.memory_limit = facts.value("memory_limit", 0.0);
  options.host.libraries = facts.at("controllers").get<std::map<std::string, std::string>>();
  options.own_share = facts.value("own_share", 0.0);
  for (const auto& [name, normal] : facts.at("steered").items())
    options.steered.push_back({name, normal.at("mean").get<double>(), normal.at("stddev").get<double>()});
  return options;
}

}  // namespace

bool are_same(const CampaignOptions& a, const CampaignOptions& b) { return json_of_options(a) == json_of_options(b); }

fs::path plan_file(const fs::path& folder) { return folder / "plan.csv"; }
fs::path facts_file(const fs::path& folder) { return folder / "campaign.json"; }

fs::path result_file(const fs::path& folder, const std::optional<Slice>& slice) {
  return folder / (slice ? fmt::format("results-{}-of-{}.jsonl", slice->index, slice->count) : "results.jsonl");
}

fs::path trace_folder(const fs::path& folder) { return folder / "traces"; }

fs::path kept_trace_file(const fs::path& folder, const CaseResult& result) {
  return trace_folder(folder) / fmt::format("{}-{}.mcap", to_string(result.verdict), result.number);
}

std::optional<std::int64_t> case_of_kept_trace(const fs::path& file, CaseVerdict verdict) {
  const std::string name = file.stem().string(), prefix = fmt::format("{}-", to_string(verdict));
  if (!name.starts_with(prefix) || file.extension() != ".mcap") return std::nullopt;
  return number_in<std::int64_t>(std::string_view(name).substr(prefix.size()));
}

namespace {

fs::path ending_file(const fs::path& folder) { return folder / "ending.json"; }

}  // namespace

std::int64_t ending_failures(const fs::path& folder) {
  const auto text = read_text(ending_file(folder));
  const Json ending = text ? Json::parse(*text, nullptr, false) : Json();
  return ending.is_object() && ending.contains("failures") && ending["failures"].is_number_integer()
             ? ending["failures"].get<std::int64_t>()
             : 0;
}

Result<void> set_ending_failures(const fs::path& folder, std::int64_t failures) {
  if (failures > 0) return replace_text(ending_file(folder), Json{{"failures", failures}}.dump() + '\n');
  std::error_code failed;
  fs::remove(ending_file(folder), failed);
  if (failed) return error_in(ending_file(folder).string(), fmt::format("it can't be removed: {}", failed.message()));
  return {};
}

Result<CampaignLock> CampaignLock::take(const fs::path& folder, bool shared) {
  const fs::path file = folder / "lock";
  CampaignLock lock(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (lock.descriptor_ < 0) return error_in(file.string(), fmt::format("it can't be opened: {}", std::strerror(errno)));
  if (::flock(lock.descriptor_, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0)
    return error_in(folder.string(), "another process works on this campaign", "wait for its end, or stop it");
  return lock;
}

Result<void> CampaignFolder::check_unused(const fs::path& folder) {
  std::error_code failed;
  if (fs::exists(facts_file(folder), failed))
    return error_in(folder.string(), "there is a campaign in this folder",
                    "continue it: rehearse sweep resume DIR, or name a new folder");
  const bool is_used = std::any_of(fs::directory_iterator(folder, failed), fs::directory_iterator(),
                                   [](const fs::directory_entry& entry) { return entry.path().filename() != "lock"; });
  if (is_used) return error_in(folder.string(), "the folder contains other files", "name a new or an empty one");
  fs::create_directories(folder, failed);
  if (failed) return error_in(folder.string(), fmt::format("it can't be made: {}", failed.message()));
  return {};
}

Result<Campaign> CampaignFolder::begin(Scenario scenario, const fs::path& folder, const CampaignOptions& options) {
  Campaign campaign;
  campaign.folder_ = folder;
  campaign.scenario_ = std::move(scenario);
  campaign.options_ = options;
  if (campaign.scenario_.variations.empty())
    return error_in(campaign.scenario_.file, "the scenario varies nothing", "expected vary: with some parameters");
  campaign.values_ = REHEARSE_TRY(
      CaseValues::make(campaign.scenario_, options.seed, options.cases, {options.steered, options.own_share}));
  const auto round = REHEARSE_TRY(campaign.values_->round());
  if (options.cases == 0 && round == 1)
    return error_in(campaign.scenario_.file, "the number of cases isn't stated", "expected --cases N");
  if (options.cases == 0) campaign.options_.cases = round;
  return campaign;
}

Result<void> CampaignFolder::write(Campaign& campaign) {
  const fs::path& folder = campaign.folder_;
  std::ofstream stream(plan_file(folder), std::ios::binary);
  for_each_line(campaign, [&](const std::string& line) { stream << line; });
  stream.close();
  if (!stream) return error_in(plan_file(folder).string(), "the plan can't be written", "is the disk full?");
  campaign.digest_ = digest_of_plan(campaign);
  std::error_code ignored;
  Json facts{{"file", kind_of_file},
             {"version", campaign_version},
             {"scenario", fs::absolute(campaign.scenario_.file, ignored).lexically_normal().string()},
             {"options", json_of_options(campaign.options_)},
             {"plan", campaign.digest_},
             {"sources", sources_of_campaign(campaign.scenario_)},
             {"libraries", campaign.libraries_},
             {"expectations", campaign.expectations_},
             {"nominal", json_of_result(campaign.nominal_)}};
  return replace_text(facts_file(folder), facts.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
}

void CampaignFolder::set_nominal(Campaign& campaign, CaseResult result, std::map<std::string, std::string> libraries,
                                 std::vector<std::string> expectations) {
  campaign.nominal_ = std::move(result);
  campaign.libraries_ = std::move(libraries);
  campaign.expectations_ = std::move(expectations);
}

Result<Campaign> CampaignFolder::read(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(facts_file(folder), ignored))
    return error_in(folder.string(), "it is no campaign: there is no campaign.json",
                    "make one: rehearse sweep SCENARIO --cases N -o DIR");
  const auto text = REHEARSE_TRY(read_text(facts_file(folder)));
  const Json facts = Json::parse(text, nullptr, false);
  const std::string file = facts_file(folder).string();
  if (!facts.is_object() || facts.value("file", "") != kind_of_file)
    return error_in(file, "it isn't the file of a campaign");
  if (facts.value("version", 0) != campaign_version)
    return error_in(file,
                    fmt::format("the campaign is of version {}, and this program reads version {}",
                                facts.value("version", 0), campaign_version),
                    "resume it with the program that began it");
  try {
    return read_facts(folder, facts);
  } catch (const Json::exception& problem) {
    return error_in(file, fmt::format("the file is damaged: {}", problem.what()));
  }
}

Result<Campaign> CampaignFolder::read_facts(const fs::path& folder, const Json& facts) {
  auto scenario = REHEARSE_TRY(Scenario::load(facts.at("scenario").get<std::string>()));
  for (const auto& [name, hash] : facts.at("sources").items()) {
    const Json now = sources_of_campaign(scenario);
    if (now.contains(name) && now[name] == hash) continue;
    return error_in(folder.string(),
                    fmt::format("{} has changed since the campaign began",
                                name == "scenario" ? scenario.file : fmt::format("the model {}", name)),
                    "restore it, or begin another campaign in a new folder");
  }
  auto campaign = begin(std::move(scenario), folder, options_of(facts.at("options")));
  if (!campaign) return campaign;
  campaign->digest_ = facts.at("plan").get<std::string>();
  const auto on_disk = REHEARSE_TRY(hash_of_file(plan_file(folder)));
  if (hash_text(on_disk) != campaign->digest_ || digest_of_plan(*campaign) != campaign->digest_)
    return error_in(plan_file(folder).string(), "the plan was changed since the campaign began",
                    "restore it, or begin another campaign in a new folder");
  auto nominal = result_of_json(facts.at("nominal"));
  if (!nominal) return error_in(facts_file(folder).string(), "the file is damaged: it has no nominal run");
  set_nominal(*campaign, *std::move(nominal), facts.at("libraries").get<std::map<std::string, std::string>>(),
              facts.at("expectations").get<std::vector<std::string>>());
  return campaign;
}

Result<void> CampaignFolder::check_bounds(const Campaign& campaign) { return campaign.values_->check_bounds(); }

Result<void> CampaignFolder::write_new(Campaign& campaign, CaseResult nominal,
                                       std::map<std::string, std::string> libraries,
                                       std::vector<std::string> expectations) {
  campaign.is_new_ = true;
  set_nominal(campaign, std::move(nominal), std::move(libraries), std::move(expectations));
  return write(campaign);
}

bool CampaignFolder::take_new(Campaign& campaign) { return std::exchange(campaign.is_new_, false); }

}  // namespace rehearse
