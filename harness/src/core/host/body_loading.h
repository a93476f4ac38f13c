// cnoid::BodyLoader for controllers, with the loader of models.
#pragma once

namespace rehearse {

/// Registers the formats of model files. To be called before code of a controller; repetitions have no effect.
void register_body_loader();

}  // namespace rehearse
