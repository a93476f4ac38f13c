// For any bytes, the doctor finds at least the errors that the Reader finds. recover() makes a complete file of them,
// or reports that nothing can be saved, unless the file is compressed as a whole and its container can't be opened.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "core/mcap/file_view.h"
#include "core/mcap/recover.h"
#include "core/trace/trace_doctor.h"
#include "scratch.h"

using namespace rehearse;

namespace {

constexpr std::uint64_t max_chunk_size = 1 << 20;  // [bytes]

bool reader_complains(mcap::Bytes bytes) {
  mcap::ReaderOptions options;
  options.max_chunk_size = max_chunk_size;
  const auto reader = mcap::Reader::open_bytes(bytes, "fuzz.mcap", options);
  if (!reader || !(*reader)->damage().empty()) return true;
  return !(*reader)->for_each_message([](const mcap::Message&) { return true; });
}

void examine(mcap::Bytes bytes) {
  TraceCheck content;
  mcap::ExamineOptions options;
  options.max_chunk_size = max_chunk_size;
  options.content = &content;
  const mcap::Examination examination = mcap::examine_view(mcap::FileView(), bytes, options);
  if (!examination.findings.has_error() && reader_complains(bytes)) std::abort();
}

void recover(const std::uint8_t* data, std::size_t size) {
  const Scratch source(".mcap"), target("_saved.mcap"), again("_again.mcap");
  std::ofstream(source.path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  if (!mcap::FileView::open(source.path)) return;
  mcap::RecoverOptions options;
  options.max_chunk_size = max_chunk_size;
  for (const bool trust : {false, true}) {
    options.trust_damaged = trust;
    const auto saved = mcap::recover(source.path, target.path, options);
    if (!saved) {
      const std::string reason = to_string(saved.errors());
      if (reason.find("nothing can be saved") != std::string::npos) continue;
      std::fprintf(stderr, "%s\n", reason.c_str());
      std::abort();
    }
    const auto twice = mcap::recover(target.path, again.path, options);
    if (!twice || !twice->is_whole() || twice->messages != saved->messages) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  examine({reinterpret_cast<const std::byte*>(data), size});
  recover(data, size);
  return 0;
}
