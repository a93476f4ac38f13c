#include "body_loading.h"

#include <rehearse/body.h>
#include <cnoid/BodyLoader>
#include <cnoid/ExecutablePath>

#include <memory>
#include <ostream>
#include <string>

#include "cnoid_body.h"

namespace rehearse {
namespace {

class ModelLoader : public cnoid::AbstractBodyLoader {
 public:
  void setMessageSink(std::ostream& os) override { os_ = &os; }
  void setVerbose(bool on) override { is_verbose_ = on; }

  bool load(cnoid::Body* body, const std::string& filename) override {
    UrdfOptions options;
    options.allow_missing_meshes = true;
    options.contact = MeshContact::hull;  // nothing collides: the quickest
    options.packages["SHARE"] = cnoid::shareDirPath();
    const Result<Model> model = load_model(filename, options);
    tell(model ? model->report : model.errors());
    if (model) body->copyFrom(make_cnoid_body(*model, model->name, false));
    return model.ok();
  }

 private:
  void tell(const Diagnostics& findings) const {
    if (!os_) return;
    for (const Diagnostic& finding : findings)
      if (is_verbose_ || finding.severity != Severity::note) *os_ << to_string(finding) << '\n';
  }

  std::ostream* os_ = nullptr;
  bool is_verbose_ = false;
};

}  // namespace

void register_body_loader() {
  cnoid::BodyLoader::registerLoader({"body", "urdf", "wrl", "yaml", "yml"},
                                    [] { return std::make_shared<ModelLoader>(); });
}

}  // namespace rehearse
