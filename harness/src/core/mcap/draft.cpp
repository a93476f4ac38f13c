#include "draft.h"

#include <fmt/format.h>

#include <limits>
#include <system_error>
#include <utility>

#include "base/write_hint.h"

namespace rehearse::mcap {

namespace fs = std::filesystem;

Result<Draft> Draft::begin(const fs::path& target, std::span<const fs::path> sources) {
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::is_directory(status)) return error_in(target.string(), "can't be written: it is a directory");
  if (fs::exists(status) && !fs::is_regular_file(status))
    return error_in(target.string(), "can't be written: it is no regular file",
                    "name a file; it is written whole or not at all");
  fs::path file = fs::is_symlink(fs::symlink_status(target, ignored)) ? fs::weakly_canonical(target, ignored) : target;
  if (file.empty()) return error_in(target.string(), "can't be written: the target of the link doesn't exist");
  fs::path draft = file.string() + ".part";
  for (const fs::path& source : sources)
    if (fs::equivalent(source, file, ignored) || fs::equivalent(source, draft, ignored))
      return error_in(target.string(), "can't be replaced: it is also an input", "name another file");
  return Draft(std::move(file), std::move(draft));
}

Result<std::unique_ptr<Writer>> Draft::open_writer(WriterOptions form) const {
  form.chunk_span = std::numeric_limits<std::uint64_t>::max();
  return Writer::create(file_, std::move(form));
}

std::uint64_t Draft::size() const {
  std::error_code ignored;
  return fs::file_size(file_, ignored);
}

Draft::~Draft() {
  std::error_code ignored;
  if (!file_.empty()) fs::remove(file_, ignored);
}

Draft::Draft(Draft&& other) noexcept
    : target_(std::move(other.target_)), file_(std::exchange(other.file_, fs::path())) {}

Result<void> Draft::finish() {
  std::error_code failed;
  fs::rename(file_, target_, failed);
  if (failed)
    return error_in(target_.string(), fmt::format("can't be written: {}", failed.message()),
                    write_hint(target_, "name another file with -o"));
  file_.clear();
  return {};
}

std::uint16_t copy(const Schema* schema, Writer& to) {
  return schema == nullptr ? std::uint16_t{0} : to.add_schema(schema->name, schema->encoding, schema->data);
}

Result<void> copy(const Attachment& attachment, Writer& to) {
  return to.add_attachment(attachment.name, attachment.media_type, attachment.data, attachment.log_time,
                           attachment.create_time);
}

}  // namespace rehearse::mcap
