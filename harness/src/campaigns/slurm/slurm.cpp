#include "slurm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/pin.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/hashing.h"
#include "base/text.h"
#include "core/golden/golden_files.h"
#include "core/guard/child_process.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Numbers = std::vector<std::int64_t>;

constexpr double task_seconds = 30.0;      // of work, so that Slurm's time between tasks doesn't matter
constexpr std::int64_t most_tasks = 1000;  // unless more are asked for
constexpr double patience = 60.0;          // [s]; sbatch sleeps while Slurm has too many jobs

constexpr const char* task_script =
    "#!/bin/sh\n"
    "# A task of a campaign: PROGRAM FOLDER SLICES, and the number of slices before the first of this array.\n"
    "exec \"$1\" sweep work \"$2\" --slice \"$((SLURM_ARRAY_TASK_ID + 1 + $4))/$3\"\n";

/// The data about a submission, stored in the campaign's folder.
struct Submission {
  std::string name;  // of all the campaign's jobs
  std::int64_t tasks = 0;
};

fs::path slurm_folder(const Campaign& campaign) { return campaign.folder() / "slurm"; }
fs::path submission_file(const Campaign& campaign) { return slurm_folder(campaign) / "submission.json"; }

Result<Submission> submission_of(const Campaign& campaign) {
  const fs::path file = submission_file(campaign);
  const auto text = REHEARSE_TRY(read_text(file));
  const Json object = Json::parse(text, nullptr, false);
  Submission submission;
  if (object.is_object()) submission = {object.value("name", ""), object.value("tasks", std::int64_t{0})};
  if (submission.name.empty() || submission.tasks < 1) return error_in(file.string(), "the file is damaged");
  return submission;
}

std::int64_t tasks_for(const Campaign& campaign, const SlurmOptions& options) {
  const std::int64_t cases = campaign.options().cases;
  if (options.tasks > 0) return std::min(options.tasks, cases);
  const double seconds = static_cast<double>(cases) * campaign.nominal().seconds;
  const double wanted = std::clamp(std::ceil(seconds / task_seconds), 1.0, static_cast<double>(most_tasks));
  return std::min(static_cast<std::int64_t>(wanted), cases);
}

Result<Submission> make_submission(const Campaign& campaign, const SlurmOptions& options) {
  std::error_code failed;
  const fs::path folder = fs::absolute(campaign.folder(), failed).lexically_normal();
  fs::create_directories(slurm_folder(campaign), failed);
  const Submission made{"rehearse-" + hash_text(hash_bytes(folder.c_str(), folder.native().size())),
                        tasks_for(campaign, options)};
  REHEARSE_TRY(replace_text(slurm_folder(campaign) / "task.sh", task_script));
  const Json object{{"name", made.name}, {"tasks", made.tasks}};
  REHEARSE_TRY(replace_text(submission_file(campaign), object.dump() + '\n'));
  return made;
}

/// The output of a program of Slurm, with its errors. Fails if the program is missing or takes too long, or, with its
/// output as the message, if its status isn't 0.
Result<std::string> answer_of(std::vector<std::string> words) {
  const fs::path program = find_program(words[0]);
  if (program.empty())
    return error(fmt::format("there is no {} on the PATH", words[0]),
                 "run this where Slurm's commands are; without Slurm remove DIR/slurm, and resume");
  const std::string name = std::exchange(words[0], program.string());
  auto output = REHEARSE_TRY(output_of({std::move(words), environment_with({})}, patience));
  std::string text = std::move(output.text);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (!output.status) return error(fmt::format("{} doesn't answer{}{}", name, text.empty() ? "" : ": ", text));
  if (*output.status != 0)
    return error(text.empty() ? fmt::format("{} fails with status {}", name, *output.status) : text,
                 "the plan is kept: rehearse sweep resume DIR, with --slurm or without");
  return text;
}

std::optional<std::int64_t> integer_in(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  return status == std::errc() ? std::optional(number) : std::nullopt;
}

/// An array has indices from 0 to this number - 1.
Result<std::int64_t> largest_array() {
  const auto settings = REHEARSE_TRY(answer_of({"scontrol", "show", "config"}));
  std::istringstream lines(settings);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("MaxArraySize")) continue;
    const auto number = integer_in(std::string_view(line).substr(std::min(line.size(), line.find('=') + 2)));
    if (number && *number > 0) return *number;
  }
  return error("Slurm's configuration states no MaxArraySize");
}

/// "0-3,7" for 0, 1, 2, 3 and 7.
std::string array_text(const Numbers& indices) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0; i < indices.size();) {
    std::size_t last = i;
    while (last + 1 < indices.size() && indices[last + 1] == indices[last] + 1) ++last;
    ranges.push_back(last == i ? fmt::format("{}", indices[i]) : fmt::format("{}-{}", indices[i], indices[last]));
    i = last + 1;
  }
  return fmt::format("{}", fmt::join(ranges, ","));
}

/// In a name of an output file % has a meaning.
std::string escaped(std::string text) {
  for (std::size_t at = 0; (at = text.find('%', at)) != std::string::npos; at += 2) text.insert(at, "%");
  return text;
}

/// Submits an array, and returns the job's number.
Result<std::int64_t> submit_array(const Campaign& campaign, const Submission& submission, const Numbers& indices,
                                  std::int64_t offset, const SlurmOptions& options) {
  std::error_code failed;
  const fs::path folder = fs::absolute(campaign.folder(), failed).lexically_normal();
  std::vector<std::string> words{"sbatch",
                                 "--parsable",
                                 "--job-name=" + submission.name,
                                 "--array=" + array_text(indices),
                                 "--cpus-per-task=1",
                                 "--requeue",
                                 "--open-mode=append",
                                 fmt::format("--output={}/slurm/%A_%a.out", escaped(folder.string()))};
  words.insert(words.end(), options.sbatch.begin(), options.sbatch.end());
  for (const std::string& word : {(folder / "slurm/task.sh").string(), own_program().string(), folder.string(),
                                  fmt::format("{}", submission.tasks), fmt::format("{}", offset)})
    words.push_back(word);
  const auto answer = REHEARSE_TRY(answer_of(std::move(words)));
  std::istringstream lines(answer);  // a warning may precede the number
  for (std::string line; std::getline(lines, line);)
    if (const auto number = integer_in(line)) return *number;
  return error(fmt::format("sbatch states no number of a job: {}", answer));
}

}  // namespace

bool is_in_slurm(const Campaign& campaign) {
  std::error_code ignored;
  return fs::exists(submission_file(campaign), ignored);
}

Result<SlurmQueue> slurm_queue(const Campaign& campaign) {
  const auto submission = REHEARSE_TRY(submission_of(campaign));
  const auto states =
      REHEARSE_TRY(answer_of({"squeue", "--noheader", "--array", "--format=%T", "--name=" + submission.name}));
  SlurmQueue queue;
  std::istringstream lines(states);
  for (std::string line; std::getline(lines, line);)
    ++(line == "RUNNING" || line == "COMPLETING" ? queue.running : queue.waiting);
  return queue;
}

std::string to_string(const SlurmQueue& queue) {
  if (queue.running + queue.waiting == 0) return "no task of it is in Slurm's queue";
  return fmt::format("{} {} in Slurm, {} {}", count_text(queue.running, "task"), queue.running == 1 ? "runs" : "run",
                     queue.waiting, queue.waiting == 1 ? "waits" : "wait");
}

Result<void> check_slurm_queue(const Campaign& campaign) {
  if (!is_in_slurm(campaign)) return {};
  const auto queue = REHEARSE_TRY(slurm_queue(campaign));
  if (queue.running + queue.waiting == 0) return {};
  return error_in(campaign.folder().string(), to_string(queue),
                  fmt::format("wait for their end, or stop them: scancel --name={}", submission_of(campaign)->name));
}

Result<std::string> submit_to_slurm(const Campaign& campaign, const SlurmOptions& options) {
  REHEARSE_TRY(check_slurm_queue(campaign));
  const auto largest = REHEARSE_TRY(largest_array());
  const auto submission =
      REHEARSE_TRY(is_in_slurm(campaign) ? submission_of(campaign) : make_submission(campaign, options));
  if (options.tasks > 0 && options.tasks != submission.tasks)
    return error_in(campaign.folder().string(), fmt::format("the campaign was submitted in {} tasks", submission.tasks),
                    "leave --tasks out");
  const auto slices = REHEARSE_TRY(campaign.unfinished_slices(submission.tasks));
  std::vector<std::string> jobs;
  for (std::size_t i = 0; i < slices.size();) {
    const std::int64_t offset = (slices[i] - 1) / largest * largest;
    Numbers indices;
    for (; i < slices.size() && slices[i] - 1 < offset + largest; ++i) indices.push_back(slices[i] - 1 - offset);
    const auto job = submit_array(campaign, submission, indices, offset, options);
    if (!job && jobs.empty()) return job.errors();
    if (!job)
      return error(fmt::format("only {} of {} tasks were submitted: {}", i - indices.size(), slices.size(),
                               job.errors().front().message),
                   "submit the others after the end of these: rehearse sweep resume DIR --slurm");
    jobs.push_back(fmt::format("{}", *job));
  }
  if (jobs.empty()) return std::string("all cases have results");
  return fmt::format("{} in {}: Slurm's job{} {}", count_text(campaign.options().cases, "case"),
                     count_text(slices.size(), "task"), jobs.size() == 1 ? "" : "s", fmt::join(jobs, ", "));
}

}  // namespace rehearse
