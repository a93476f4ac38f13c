#include <rehearse/body.h>

#include <fmt/format.h>

#include <algorithm>

#include "body_document.h"
#include "body_draft.h"
#include "mesh/mesh_input.h"
#include "urdf/urdf_draft.h"

namespace rehearse {
namespace {

bool is_body(const std::filesystem::path& file) { return file.extension() == ".body"; }

/// The masses and inertias that ODE needs, as for a URDF.
void complete(Model& model, const UrdfOptions& options, urdf::Findings& findings) {
  urdf::complete_masses(model, options, findings);
  urdf::repair_inertias(model, options, findings);
  urdf::check_dynamics(model, options, findings);
}

}  // namespace

Result<Model> load_body(const std::filesystem::path& file, const UrdfOptions& options) {
  Result<std::string> text = read_mesh_file(file);
  if (!text) return text.errors();
  if (text->size() > max_body_bytes)
    return error_in(file.string(),
                    fmt::format("the file has {} bytes, more than {} MiB", text->size(), max_body_bytes >> 20));
  return parse_body(*text, file.string(), options);
}

Result<Model> parse_body(const std::string& text, const std::string& name, const UrdfOptions& options) {
  REHEARSE_ASSERT(options.default_mass.value_or(1.0) > 0.0, "a default mass is above 0");
  body::Files files(text, name, options);
  if (files.has_error()) return files.errors();
  body::BodyDraft draft = body::read_body(files, files.main());
  if (files.has_error()) return files.errors();
  std::optional<Model> model = body::join(std::move(draft), files);
  if (model) complete(*model, options, files.main().findings());
  if (files.has_error()) return files.errors();
  REHEARSE_ASSERT(model.has_value(), "a body that can't be read has an error");
  model->source_file = name;
  model->source_text = files.bundle();
  model->report = files.report();
  return std::move(*model);
}

bool is_model_file(const std::filesystem::path& file) { return is_body(file) || file.extension() == ".urdf"; }

Result<Model> load_model(const std::filesystem::path& file, const UrdfOptions& options) {
  return is_body(file) ? load_body(file, options) : load_urdf(file, options);
}

Result<Model> parse_model(const std::string& text, const std::string& name, const UrdfOptions& options) {
  return is_body(name) ? parse_body(text, name, options) : parse_urdf(text, name, options);
}

}  // namespace rehearse
