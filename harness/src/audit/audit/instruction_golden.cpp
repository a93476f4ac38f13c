#include "instruction_golden.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gnu/libc-version.h>
#include <rehearse/golden.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/hashing.h"
#include "base/text.h"
#include "base/write_hint.h"
#include "instruction_profile.h"
#include "symbols.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using KeptJson = nlohmann::ordered_json;

constexpr double allowed_growth = 0.02;  // of the kept instructions
constexpr const char* version_key = "rehearse_instructions";

/// The counts of one controller.
struct KeptCounts {
  std::string compilers;
  std::map<std::int64_t, std::uint64_t> calls;  // by tick
};

struct KeptInstructions {
  std::string recording;  // content_hash_of() the golden
  std::string c_library;
  std::map<std::string, KeptCounts> controllers;
};

std::string c_library() { return fmt::format("glibc {}", gnu_get_libc_version()); }

KeptInstructions counts_of(const AuditReport& report, const fs::path& golden) {
  KeptInstructions counts{content_hash_of(golden), c_library(), {}};
  for (const ControllerAudit& controller : report.controllers) {
    if (!controller.instructions) continue;
    KeptCounts& of = counts.controllers[controller.controller];
    of.compilers = Symbols(controller.library).compilers();
    for (const InstructionCounts::Call& call : controller.instructions->calls) of.calls[call.tick] = call.instructions;
  }
  return counts;
}

/// Eight calls in a line, so that a version control system shows which ticks changed.
std::string text_of(const KeptInstructions& counts) {
  std::string text = fmt::format("{{\n  \"{}\": 1,\n  \"recording\": {},\n  \"c_library\": {},\n  \"controllers\": {{",
                                 version_key, KeptJson(counts.recording).dump(), KeptJson(counts.c_library).dump());
  const char* separator = "";
  for (const auto& [controller, of] : counts.controllers) {
    text += fmt::format("{}\n    {}: {{\n      \"compilers\": {},\n      \"calls\": [", separator,
                        KeptJson(controller).dump(), KeptJson(of.compilers).dump());
    std::size_t index = 0;
    for (const auto& [tick, instructions] : of.calls) {
      text +=
          fmt::format("{}{}[{}, {}]", index == 0 ? "" : ",", index % 8 == 0 ? "\n        " : " ", tick, instructions);
      ++index;
    }
    text += "\n      ]\n    }";
    separator = ",";
  }
  return text + "\n  }\n}\n";
}

Result<KeptInstructions> read_instructions(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return error_in(file.string(), fmt::format("it can't be read: {}", std::strerror(errno)));
  const auto wrong = [&](const std::string& problem) {
    return error_in(file.string(), problem, "REHEARSE_GOLDEN=accept rehearse check --instructions writes it anew");
  };
  KeptInstructions kept;
  try {
    const KeptJson read = KeptJson::parse(stream);
    if (read.at(version_key) != 1) return wrong("it has another version of the form than 1");
    kept.recording = read.at("recording");
    kept.c_library = read.at("c_library");
    for (const auto& [controller, of] : read.at("controllers").items()) {
      KeptCounts& counts = kept.controllers[controller];
      counts.compilers = of.at("compilers");
      for (const KeptJson& call : of.at("calls"))
        counts.calls.emplace(call.at(0).get<std::int64_t>(), call.at(1).get<std::uint64_t>());
    }
  } catch (const KeptJson::exception& problem) {
    return wrong(fmt::format("these are no counts of instructions: {}", problem.what()));
  }
  return kept;
}

std::vector<std::string> options_in(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The words of `text` that `other` doesn't have.
std::string own_words(const std::string& text, const std::string& other) {
  std::vector<std::string> words = options_in(text);
  const std::vector<std::string> others = options_in(other);
  std::erase_if(words, [&](const std::string& word) { return std::ranges::count(others, word) > 0; });
  return fmt::format("{}", fmt::join(words, " "));
}

/// The difference between the compilers of the kept counts and of the present library.
std::string difference_of(const std::string& before, const std::string& now) {
  if (before.empty() || now.empty())
    return fmt::format("{} has no debug information, which names the compiler and its options",
                       now.empty() ? "the present library" : "their library");
  const std::string only_before = own_words(before, now), only_now = own_words(now, before);
  if (only_before.empty() && only_now.empty()) return "their library was compiled with the options in another order";
  const auto with = [](const std::string& own, const std::string& other) {
    return own.empty() ? fmt::format("without '{}'", other) : fmt::format("with '{}'", own);
  };
  return fmt::format("their library was compiled {}, the present one {}", with(only_before, only_now),
                     with(only_now, only_before));
}

std::string reason_not_to_compare(const KeptInstructions& kept, const KeptInstructions& present,
                                  const std::string& controller) {
  const auto before = kept.controllers.find(controller);
  if (before == kept.controllers.end()) return "none are kept";
  if (kept.recording != present.recording) return "they are kept of another recording: the golden was accepted anew";
  if (kept.c_library != present.c_library)
    return fmt::format("they are kept of {}, and this is {}", kept.c_library, present.c_library);
  const std::string& now = present.controllers.at(controller).compilers;
  return before->second.compilers == now ? "" : difference_of(before->second.compilers, now);
}

ComparedInstructions compare(const KeptInstructions& kept, const KeptInstructions& present,
                             const std::string& controller) {
  ComparedInstructions compared{controller, reason_not_to_compare(kept, present, controller), 0, 0, {}, {}, 1.0};
  if (!compared.not_compared.empty()) return compared;
  double expected_sum = 0.0, sum = 0.0;
  const auto& expected = kept.controllers.at(controller).calls;
  for (const auto& [tick, instructions] : present.controllers.at(controller).calls) {
    const auto before = expected.find(tick);
    if (tick == 0 || before == expected.end()) continue;
    const ComparedCall call{tick, instructions, before->second};
    ++compared.ticks;
    sum += static_cast<double>(call.instructions);
    expected_sum += static_cast<double>(call.expected);
    if (static_cast<double>(call.instructions) <= (1.0 + allowed_growth) * static_cast<double>(call.expected)) continue;
    ++compared.grown;
    if (!compared.first) compared.first = call;
    if (!compared.worst || call.instructions - call.expected > compared.worst->instructions - compared.worst->expected)
      compared.worst = call;
  }
  if (compared.ticks == 0) compared.not_compared = "no tick after tick 0 has both";
  if (expected_sum > 0.0) compared.share = sum / expected_sum;
  return compared;
}

/// "; 96 % of them in hold.cpp:88, Hold::search()", if the lines of that call are known.
std::string line_text(const InstructionCounts& counts, std::int64_t tick) {
  if (counts.most.tick != tick || counts.lines.empty() || counts.most.instructions == 0) return {};
  const InstructionCounts::Line& line = counts.lines.front();
  return fmt::format("; {:.0f} % of them in {}{}{}",
                     100.0 * static_cast<double>(line.instructions) / static_cast<double>(counts.most.instructions),
                     line.line, line.line.empty() ? "" : ", ", line.function);
}

std::string sentence(const ComparedInstructions& compared, const InstructionCounts& counts) {
  const std::string of = fmt::format("control() of {}", compared.controller);
  if (!compared.not_compared.empty())
    return fmt::format("the instructions of {} aren't compared: {}", of, compared.not_compared);
  if (compared.grown > 0)
    return fmt::format("{} takes {} instructions at tick {}, {} expected{}; over 2 % more in {} of {}, from tick {} on",
                       of, grouped(compared.worst->instructions), compared.worst->tick,
                       grouped(compared.worst->expected), line_text(counts, compared.worst->tick), compared.grown,
                       count_text(compared.ticks, "tick"), compared.first->tick);
  if (compared.share < 1.0 - allowed_growth)
    return fmt::format("{} takes {:.1f} % fewer instructions than expected in {}", of, 100.0 * (1.0 - compared.share),
                       count_text(compared.ticks, "tick"));
  return fmt::format("{} takes the expected instructions in {}", of, count_text(compared.ticks, "tick"));
}

}  // namespace

Result<void> keep_instructions(const AuditReport& report, const fs::path& golden) {
  const fs::path file = instructions_file_of(golden);
  std::ofstream stream(file, std::ios::binary);
  stream << text_of(counts_of(report, golden));
  stream.close();
  if (!stream)
    return error(fmt::format("{} can't be written: {}", file.string(), std::strerror(errno)),
                 write_hint(file, "make its folder writable"));
  return {};
}

Result<InstructionJudgement> judge_instructions(const AuditReport& report, const fs::path& golden) {
  const auto kept = REHEARSE_TRY(read_instructions(instructions_file_of(golden)));
  const KeptInstructions present = counts_of(report, golden);
  InstructionJudgement judgement;
  for (const ControllerAudit& controller : report.controllers) {
    if (!controller.instructions) continue;
    ComparedInstructions compared = compare(kept, present, controller.controller);
    judgement.has_grown = judgement.has_grown || compared.grown > 0;
    judgement.was_compared = judgement.was_compared || compared.not_compared.empty();
    judgement.verdict += (judgement.verdict.empty() ? "" : "; ") + sentence(compared, *controller.instructions);
    judgement.controllers.push_back(std::move(compared));
  }
  return judgement;
}

}  // namespace rehearse
